//! Synthetic light fields with known circles of confusion.

use super::EngineRecord;
use super::field::{LightFieldCase, nudged_lenses};
use super::measurements::EngineMeasurements;
use crate::measurement::band::OutlineBand;
use glam::{Vec2, Vec3};
use lens::{Camera, FocusOffset};
use light::Steps;
use salf::{Cell, Domain, Salf, Sample, Visibility};
use scene::{SurfaceField, SurfacePoint};
use session::SessionError;
use splat::{Splatter, Tolerance};
use std::sync::Arc;

/// A focus without paint.
struct UnpaintedFocus;

impl SurfaceField<FocusOffset> for UnpaintedFocus {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        FocusOffset::STANDARD
    }
    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

/// A camera focused at infinity: the circle of confusion grows with 1/z.
fn camera([width, height]: [u32; 2]) -> Camera {
    Camera { width, height, focus_distance: f64::INFINITY, aperture_radius: 0.1, ..Camera::default() }
}

/// The 1/z at which the circle of confusion has a diameter of `diameter` px.
fn inverse_depth(camera: &Camera, diameter: f64) -> f32 {
    (diameter / 2.0 / camera.optics().splat_radius_px(1.0).abs()) as f32
}

/// A pseudo-random colour that is constant over tiles of 2 × 2 pixels.
fn radiance(x: i32, y: i32) -> Vec3 {
    let hash = |k: u32| {
        let mixed =
            ((x >> 1) as u32).wrapping_mul(0x9E37_79B1) ^ ((y >> 1) as u32).wrapping_mul(0x85EB_CA77) ^ k;
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2C1B_3C6D);
        ((mixed ^ mixed >> 13) & 0xFFFF) as f32 / 65536.0
    };
    Vec3::new(0.1 + 0.8 * hash(1), 0.1 + 0.8 * hash(2), 0.1 + 0.8 * hash(3))
}

fn sample(cell: Cell, inverse_depth: f32, visibility: Visibility) -> Sample {
    let half = cell.side as f32 / 2.0;
    Sample {
        center: cell.corner.as_vec2() + half,
        half_size: Vec2::splat(half),
        inverse_depth,
        weight: (cell.side * cell.side) as f32,
        tilt: Vec2::ZERO,
        radiance: radiance(cell.corner.x, cell.corner.y),
        surface: None,
        is_carried: false,
        visibility,
    }
}

/// A light field with the samples that `add_samples` gives for each pixel of the frame and each cell of its
/// margin.
fn salf(camera: &Camera, margin_px: f64, add_samples: impl Fn(Cell, &mut Vec<Sample>)) -> Arc<Salf> {
    let domain = Domain::new(camera.width, camera.height, margin_px);
    let mut samples = Vec::new();
    domain.block_rows().into_iter().flatten().for_each(|cell| add_samples(cell, &mut samples));
    let margin_px = domain.margin as u32;
    Arc::new(Salf { margin_px, ..Salf::with_samples(camera.clone(), samples.into()) })
}

/// A plane with a circle of confusion of `diameter` px.
fn plane(size: [u32; 2], diameter: f64) -> Arc<Salf> {
    let camera = camera(size);
    let depth = inverse_depth(&camera, diameter);
    salf(&camera, diameter / 2.0, |cell, samples| samples.push(sample(cell, depth, Visibility::Open)))
}

/// Circles of confusion from 0 to 80 px, left to right, behind a near half-plane with a vertical edge.
/// Returns the column of the edge, too.
fn ramp(size: [u32; 2]) -> (Arc<Salf>, i32) {
    const WIDEST: f64 = 80.0;
    const OCCLUDER: f64 = 140.0;
    let camera = camera(size);
    let edge = size[0] as i32 * 2 / 3;
    let occluder = inverse_depth(&camera, OCCLUDER);
    let salf = salf(&camera, OCCLUDER / 2.0, |cell, samples| {
        // Cells above and below the frame are wider than a pixel; the edge continues there with the precision
        // of a cell.
        if cell.corner.x >= edge {
            samples.push(sample(cell, occluder, Visibility::Open));
        }
        let middle = f64::from(cell.corner.x) + f64::from(cell.side) / 2.0;
        let diameter = WIDEST * (f64::from(cell.corner.x) / f64::from(size[0])).clamp(0.0, 1.0);
        // From x, the aperture point u is visible past the edge if x + reach·u < edge.
        let reach = (OCCLUDER - diameter) / 2.0;
        let last = (f64::from(edge) - middle) / reach;
        if last <= -1.0 {
            return;
        }
        let visibility = if last >= 1.0 {
            Visibility::Open
        } else {
            let columns = ((last + 1.0) * 8.0).round() as u32;
            let row = ((1u64 << columns) - 1) & 0xFFFF;
            let words = vec![row | row << 16 | row << 32 | row << 48; 4];
            Visibility::Cells { words: words.into() }
        };
        if visibility != (Visibility::Cells { words: [0; 4].into() }) {
            samples.push(sample(cell, inverse_depth(&camera, diameter), visibility));
        }
    });
    (salf, edge)
}

/// The five synthetic light fields, of `size` columns and rows.
pub fn fields(size: [u32; 2]) -> impl Iterator<Item = LightFieldCase> {
    let (width, height) = (size[0] as usize, size[1] as usize);
    let planes =
        [("in focus", 0.0), ("circle 10 px", 10.0), ("circle 40 px", 40.0), ("circle 150 px", 150.0)];
    let planes = planes
        .into_iter()
        .map(move |(name, coc_px)| (name, coc_px, plane(size, coc_px), OutlineBand::default()));
    let ramp = std::iter::once_with(move || {
        let (salf, edge) = ramp(size);
        let is_edge = |x: usize, _| x as i32 + 1 == edge;
        ("ramp behind an edge", 80.0, salf, OutlineBand::from_edges(width, height, is_edge))
    });
    planes.chain(ramp).map(|(name, coc_px, salf, band)| LightFieldCase {
        scene: name.into(),
        what: "",
        with_dense: salf.statistics().partial == 0,
        salf,
        focus: Arc::new(UnpaintedFocus),
        band,
        coc_px,
        with_dab: false,
        truth: None,
    })
}

/// Measures cost against the circle of confusion, 0 to 150 px, at the viewing tolerance, for pictures of `size`
/// columns and rows. `note` gets a line for each measurement.
///
/// # Errors
/// The work was cancelled.
pub fn sweep_circles(
    size: [u32; 2],
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    for diameter in [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 100.0, 150.0] {
        time_planes(&[size], diameter, "against circle", measured, steps, note)?;
    }
    Ok(())
}

/// Measures cost against the number of samples, which equals that of pixels; the sizes are timed in turn,
/// because they are compared.
///
/// # Errors
/// The work was cancelled.
pub fn sweep_sizes(
    [width, height]: [u32; 2],
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    let size_for_share =
        |share: f64| [width, height].map(|side| (f64::from(side) * share.sqrt()).round() as u32);
    time_planes(&[0.25, 0.5, 0.75, 1.0].map(size_for_share), 10.0, "against size", measured, steps, note)
}

/// Times planes with one circle of confusion and several sizes, in turn.
fn time_planes(
    sizes: &[[u32; 2]],
    diameter: f64,
    what: &str,
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    let progress = steps.begin("splatting");
    let mut planes = Vec::new();
    for &size in sizes {
        let mut splatter = Splatter::new(plane(size, diameter));
        splatter.use_gpu(measured.gpu.clone());
        splatter.keep_on_card(true);
        splatter.set_tolerance(Tolerance::VIEWING);
        let camera = splatter.salf().camera.clone();
        splatter.render(&camera, &UnpaintedFocus, &*progress)?;
        planes.push((splatter, camera));
    }
    let progress = &*progress;
    let mut tasks: Vec<_> = planes
        .iter_mut()
        .map(|(splatter, camera)| {
            let mut lenses = nudged_lenses(camera);
            move || Ok(splatter.refocus(&lenses.next().expect("endless"), progress)?)
        })
        .collect();
    let timings = measured.frame.time_interleaved(&mut tasks)?;
    for ((splatter, _), timing) in planes.iter().zip(timings) {
        let scene = format!("plane, circle {diameter} px");
        let mut record = EngineRecord::new(&scene, what, splatter.salf(), timing).summed_by(splatter);
        record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
        record.coc_px = diameter;
        record.tolerance = Some(Tolerance::VIEWING.share_of_circle);
        note(&record.summary_line());
        measured.records.push(record);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_have_the_circles_they_are_named_for() {
        for field in fields([64, 36]) {
            let optics = field.salf.camera.optics();
            let circle =
                |s: Sample| optics.circle_of_confusion_px(optics.standard_kappa(s.inverse_depth.into()));
            let widest =
                field.salf.samples.iter().filter(|s| s.center.x < 42.0).map(circle).fold(0.0, f64::max);
            let expected = if field.scene.starts_with("ramp") { 80.0 * 41.0 / 64.0 } else { field.coc_px };
            assert!((widest - expected).abs() < 1e-3 * expected.max(1.0), "{}: {widest}", field.scene);
            let pixels = 64 * 36;
            assert!(field.salf.samples.len() >= pixels);
        }
    }

    #[test]
    fn the_ramp_covers_the_picture_once() {
        let (salf, edge) = ramp([96, 48]);
        let mut splatter = Splatter::new(salf.clone());
        splatter.render(&salf.camera, &UnpaintedFocus, &progress::Unwatched).unwrap();
        let row = &splatter.picture().coverage[24 * 96..25 * 96];
        // Near the edge the resolution of the aperture's cells limits the accuracy.
        for (x, covered) in row.iter().enumerate() {
            let far = (x as i32 - edge).abs() > 3;
            assert!((covered - 1.0).abs() < if far { 0.02 } else { 0.2 }, "{x}: {covered}");
        }
        assert!(salf.samples.iter().any(|sample| sample.visibility != Visibility::Open));
    }
}
