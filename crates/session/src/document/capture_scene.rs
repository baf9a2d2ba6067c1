//! A capture as a scene that its photographs light.

use super::camera_path::camera_between;
use crate::error::SessionError;
use capture::{Capture, CaptureError, CaptureOptions};
use glam::DVec3;
use lens::Camera;
use progress::Progress;
use project::CaptureChoices;
use scene::{Scene, View};
use std::path::Path;
use std::sync::Arc;

/// What cameras of photographs are called: this, and the photograph's name.
pub(crate) const PHOTOGRAPH: &str = "photo:";

impl From<CaptureError> for SessionError {
    fn from(error: CaptureError) -> Self {
        match error {
            CaptureError::Cancelled(_) => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// A capture that was opened.
pub(crate) struct CaptureScene {
    pub scene: Arc<Scene>,
    /// What is good to know, or missing, a sentence each.
    pub remarks: Vec<String>,
    /// Whether something is missing that the capture speaks of.
    pub is_incomplete: bool,
}

/// Reads the capture in a folder.
pub(crate) fn load_capture(
    folder: &Path,
    choices: &CaptureChoices,
    progress: &dyn Progress,
) -> Result<CaptureScene, SessionError> {
    let options = CaptureOptions { mesh: choices.mesh.clone(), ..CaptureOptions::default() };
    let Capture { views, mut scene, remarks, .. } = capture::open(folder, &options, progress)?;
    if let Some(name) = choices.leave_out.iter().find(|name| !views.iter().any(|view| view.name == **name)) {
        return Err(SessionError::bad(
            folder,
            format!("no photograph is called \"{name}\" ({})", names(&views)),
        ));
    }
    let is_left_out = |view: &View| choices.leave_out.contains(&view.name);
    let (left_out, views): (Vec<View>, Vec<View>) = views.into_iter().partition(is_left_out);
    if views.is_empty() {
        return Err(SessionError::bad(folder, "all photographs are left out (leave some in)"));
    }
    scene.path = folder.into();
    (scene.views, scene.left_out) = (views, left_out);
    let is_incomplete = remarks.iter().any(|remark| remark.is_incomplete);
    let remarks = remarks.into_iter().map(|remark| remark.text).collect();
    Ok(CaptureScene { scene: Arc::new(scene), remarks, is_incomplete })
}

/// The camera that a name after [`PHOTOGRAPH`] means, that of a photograph or `A..B@SHARE`, one between two of them; else what is wrong.
pub(crate) fn photograph_camera(scene: &Scene, name: &str, like: &Camera) -> Result<Camera, String> {
    let camera =
        |name: &str| photograph(scene, name).map(|view| camera_of_photograph(scene.bounds(), view, like));
    let between = || {
        let (names, share) = name.rsplit_once('@')?;
        let (from, to) = names.split_once("..")?;
        let share = share.parse().ok().filter(|share| (0.0..=1.0).contains(share))?;
        Some((from, to, share))
    };
    match (camera(name), between()) {
        (Err(_), Some((from, to, share))) => Ok(camera_between(&camera(from)?, &camera(to)?, share)),
        (camera, _) => camera,
    }
}

/// The photograph of a name, left out or not; else what is wrong with it.
pub(crate) fn photograph<'a>(scene: &'a Scene, name: &str) -> Result<&'a View, String> {
    let mut views = scene.views.iter().chain(&scene.left_out);
    let view = views.find(|view| view.name == name);
    view.ok_or_else(|| format!("no photograph is called \"{name}\" ({})", names(&scene.views)))
}

fn names(views: &[View]) -> String {
    const TOLD: usize = 8;
    let told: Vec<&str> = views.iter().take(TOLD).map(|view| view.name.as_str()).collect();
    let more = if views.len() > TOLD { ", …" } else { "" };
    match told.is_empty() {
        true => "it is no capture, or all are left out".into(),
        false => format!("there are {}{more}", told.join(", ")),
    }
}

/// The camera of a photograph without its lens's distortion: a pinhole, what its axis meets in the middle of the picture. Sensor and
/// background are those of `like`. `bounds` are the scene's, lowest and highest corner.
pub fn camera_of_photograph(bounds: (DVec3, DVec3), view: &View, like: &Camera) -> Camera {
    let [width, height] = view.lens.size_px();
    let [_, focal_px] = view.lens.intrinsics().focal_px;
    let along = |point: DVec3| (point - view.position()).dot(view.forward());
    let middle = along(0.5 * (bounds.0 + bounds.1));
    Camera {
        width,
        height,
        yfov: 2.0 * (0.5 * f64::from(height) / focal_px).atan(),
        focus_distance: if middle > 0.0 { middle } else { like.focus_distance },
        aperture_radius: 0.0,
        camera_to_world: view.camera_to_world,
        ..like.clone()
    }
}
