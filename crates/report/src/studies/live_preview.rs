//! What the live preview shows over time after a change of camera or lens.

use crate::measurement::reference::conserved_picture;
use crate::options::SceneRequest;
use crate::subject::Subject;
use document::{CameraEdit, VariantChoice};
use glam::DMat4;
use lens::Camera;
use progress::Progress;
use project::{LinearPicture, compare};
use serde::{Deserialize, Serialize};
use session::{Command, Event, Preview, PreviewKind, Quality, Session, SessionError, SessionOptions};
use std::time::{Duration, Instant};

/// A picture shown by the preview.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShownPicture {
    /// The change after which it was shown.
    pub after: String,
    /// Its kind: `pinhole`, `coarse`, `viewing` or `exact`.
    pub what: String,
    /// Its size, px, before the window enlarges it.
    pub size: [u32; 2],
    /// Seconds after the change.
    pub seconds: f64,
    /// PSNR, enlarged as in the window, against the last picture of the same view, dB; 200 for that picture
    /// itself.
    pub psnr: f64,
}

/// Rotation of the camera, rad, and factor of the focus distance.
const TURN_RADIANS: f64 = 0.03;
const REFOCUS_FACTOR: f64 = 1.1;

/// Polling interval.
const POLL_INTERVAL: Duration = Duration::from_millis(4);

/// Opens a scene like the window and records the preview after each of several changes. The scene's light is
/// computed before the first.
///
/// # Errors
/// The scene cannot be opened or rendered, or the work is cancelled.
pub fn watch_preview(
    request: &SceneRequest,
    subject: &Subject,
    unwrap: &atlas::UnwrapOptions,
    progress: &dyn Progress,
) -> Result<Vec<ShownPicture>, SessionError> {
    let camera = &subject.camera;
    let day = Duration::from_secs(86_400);
    let mut session = Session::new(SessionOptions {
        unwrap: unwrap.clone(),
        preview_size: camera.width.max(camera.height),
        recovery_delay: day,
        exact_delay: Some(Duration::from_millis(300)),
        ..SessionOptions::default()
    })?;
    session.apply(Command::Open(request.file.clone()))?;
    poll_until(&mut session, progress, |session| session.document().is_some())?;
    match &request.variant {
        VariantChoice::AsSaved => {}
        VariantChoice::Own => session.apply(Command::SetVariant(None))?,
        VariantChoice::Named(name) => session.apply(Command::SetVariant(Some(name.clone())))?,
    }
    poll_until(&mut session, progress, Session::is_idle)?;
    if let Some(back_faces) = request.back_faces {
        session.apply(Command::SetBackFaces(back_faces))?;
    }
    if let Some(world) = &request.world {
        // What is wrong with its file was told when the subject was opened.
        let (world, _) = world.load(&subject.scene)?;
        session.apply(Command::SetWorld(Some(world)))?;
    }
    poll_until(&mut session, progress, Session::is_idle)?;

    // Starts from another view, so that nothing is cached for the measured one.
    let turned = |by: f64| camera.camera_to_world * DMat4::from_rotation_y(by);
    session.apply(Command::EditCamera(CameraEdit::Whole(Box::new(Camera {
        camera_to_world: turned(-TURN_RADIANS),
        ..camera.clone()
    }))))?;
    poll_until(&mut session, progress, is_exact)?;
    let changes = [
        ("camera moved", CameraEdit::Whole(Box::new(camera.clone()))),
        ("camera moved again", CameraEdit::Pose(turned(TURN_RADIANS))),
        ("lens turned", CameraEdit::FocusDistance(camera.focus_distance * REFOCUS_FACTOR)),
    ];
    let mut watched = Vec::new();
    for (after, change) in changes {
        watched.extend(watch_change(&mut session, after, change, progress)?);
    }
    Ok(watched)
}

/// The pictures shown after a change, up to the exact one.
fn watch_change(
    session: &mut Session,
    after: &str,
    change: CameraEdit,
    progress: &dyn Progress,
) -> Result<Vec<ShownPicture>, SessionError> {
    let before = session.preview().map_or(0, |preview| preview.id);
    let start = Instant::now();
    session.apply(Command::EditCamera(change))?;
    let mut shown: Vec<(Preview, f64)> = Vec::new();
    poll_until(session, progress, |session| {
        let last = shown.last().map_or(before, |(preview, _)| preview.id);
        let newer = session.preview().filter(|preview| preview.id > last);
        shown.extend(newer.map(|preview| (preview.clone(), start.elapsed().as_secs_f64())));
        !shown.is_empty() && is_exact(session)
    })?;
    let last = shown.last().and_then(|(preview, _)| preview.picture.fetch());
    let Some(last) = last.map(|picture| conserved_picture(&picture)) else { return Ok(Vec::new()) };
    let mut pictures = Vec::new();
    for (preview, seconds) in &shown {
        let Some(own) = preview.picture.fetch() else { continue };
        let what = match (preview.kind, preview.quality) {
            (PreviewKind::Pinhole, _) => "pinhole",
            (PreviewKind::Defocused, _) => "defocused",
            (_, Quality::Coarse) => "coarse",
            (_, Quality::Viewing) => "viewing",
            (_, Quality::Exact) => "exact",
        };
        let on_screen = match preview.enlarged_to {
            Some(size) => conserved_picture(&session::enlarged(&own, size)),
            None => conserved_picture(&own),
        };
        let shown = enlarged(&on_screen, [last.width, last.height]);
        let psnr = compare(&shown, &last)?.psnr;
        let (after, what) = (after.to_string(), what.to_string());
        pictures.push(ShownPicture { after, what, size: [own.width, own.height], seconds: *seconds, psnr });
    }
    Ok(pictures)
}

/// Whether the exact picture is shown and nothing is pending.
fn is_exact(session: &Session) -> bool {
    session.is_settled() && session.preview().is_some_and(|preview| preview.quality == Quality::Exact)
}

/// Polls the session until `done`.
fn poll_until(
    session: &mut Session,
    progress: &dyn Progress,
    mut done: impl FnMut(&Session) -> bool,
) -> Result<(), SessionError> {
    loop {
        progress.check()?;
        for event in session.poll() {
            if let Event::Failed(why) = event {
                return Err(SessionError::TryAgain(why));
            }
        }
        if done(session) {
            return Ok(());
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// Resizes a picture with bilinear interpolation between pixel centres.
fn enlarged(picture: &LinearPicture, [width, height]: [u32; 2]) -> LinearPicture {
    if [picture.width, picture.height] == [width, height] {
        return picture.clone();
    }
    // The two pixels around a position, and the weight of the second.
    let along = |k: u32, of: u32, own: u32| {
        let last = f64::from(own - 1);
        let at = ((f64::from(k) + 0.5) * f64::from(own) / f64::from(of) - 0.5).clamp(0.0, last);
        (at as usize, (at as usize + 1).min(last as usize), at.fract() as f32)
    };
    let row = |y: usize| &picture.rgb[y * picture.width as usize..][..picture.width as usize];
    let mix = |a: [f32; 3], b: [f32; 3], share: f32| -> [f32; 3] {
        std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
    };
    let mut rgb = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let (above, below, down) = along(y, height, picture.height);
        for x in 0..width {
            let (left, right, across) = along(x, width, picture.width);
            let of = |y: usize| mix(row(y)[left], row(y)[right], across);
            rgb.push(mix(of(above), of(below), down));
        }
    }
    LinearPicture { width, height, rgb, layers: Default::default(), exposure: picture.exposure }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlarging_keeps_a_ramp_and_the_edges() {
        let rgb = (0..8).map(|k| [(k % 4) as f32, (k / 4) as f32, 1.0]).collect();
        let small = LinearPicture { width: 4, height: 2, rgb, layers: Default::default(), exposure: None };
        let large = enlarged(&small, [16, 8]);
        assert_eq!((large.width, large.height, large.rgb.len()), (16, 8, 128));
        for (k, [x, y, one]) in large.rgb.iter().enumerate() {
            let expected = |k: usize, last: f32| ((k as f32 + 0.5) / 4.0 - 0.5).clamp(0.0, last);
            assert!((x - expected(k % 16, 3.0)).abs() < 1e-6 && (y - expected(k / 16, 1.0)).abs() < 1e-6);
            assert_eq!(*one, 1.0);
        }
        assert_eq!(enlarged(&small, [4, 2]).rgb, small.rgb);
    }
}
