//! How the time of a bake grows: with samples, with triangles, and with how many surfaces lie before one another.
//!
//! Leaves, two triangles each, hang in layers before a wall, scattered by a fixed sequence; a layer covers a third of the picture. They send
//! their colour and nothing else, so that what is timed is the light field and not the light.

use super::EngineRecord;
use super::measurements::EngineMeasurements;
use crate::findings::log_slope;
use glam::{DVec3, Vec3};
use lens::Camera;
use light::Steps;
use salf::BakeOptions;
use scene::{LoadOptions, Scene, SurfaceMesh, SurfacePoint};
use session::SessionError;
use std::sync::Arc;
use std::time::Instant;
use trace::{OutgoingRadiance, Radiance, Tracer};

/// What is varied: the name of the record, and the axis of its plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// What the record says was measured.
    pub what: &'static str,
    /// What the time grows with.
    pub with: &'static str,
}

/// All that is varied.
pub const GROWTHS: [Growth; 3] = [
    Growth { what: "bake against samples", with: "samples" },
    Growth { what: "bake against triangles", with: "triangles" },
    Growth { what: "bake against layers", with: "layers of leaves" },
];

/// Shares of the picture's pixels.
const PIXEL_SHARES: [f64; 4] = [1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0, 1.0];

/// Triangles, all in eight layers.
const TRIANGLES: [u32; 4] = [10_000, 100_000, 1_000_000, 10_000_000];

/// Layers of leaves.
const LAYERS: [u32; 5] = [1, 2, 4, 8, 16];

/// The layers and triangles of what is not varied.
const USUAL_LAYERS: u32 = 8;
const USUAL_TRIANGLES: u32 = 100_000;

/// Triangles of a layer where their number is varied.
const TRIANGLES_OF_LAYER: u32 = 12_500;

/// The share of the picture that a layer covers.
const COVER: f64 = 1.0 / 3.0;

/// Leaves before a wall.
struct Foliage {
    triangles: u32,
    layers: u32,
}

impl Foliage {
    /// The scene, seen by [`camera`].
    fn scene(&self) -> Result<Scene, SessionError> {
        let leaves = self.triangles / 2;
        let mut mesh =
            SurfaceMesh { name: "foliage".into(), path: "foliage".into(), ..SurfaceMesh::default() };
        let half_wall = DVec3::new(8.0, 6.0, 0.0);
        add_square(&mut mesh, DVec3::NEG_Z * 6.0, DVec3::X * half_wall.x, DVec3::Y * half_wall.y);
        // A third of a window of 4 × 2.25 at a depth of about 4, by squares that are turned anyhow.
        let area = 4.0 * 2.25 * COVER * f64::from(self.layers) / f64::from(leaves.max(1));
        let half = (2.0 * area).sqrt() / 2.0;
        let mut numbers = Numbers(1);
        for leaf in 0..leaves {
            let depth = 3.0 + 2.0 * (f64::from(leaf % self.layers) + 0.5) / f64::from(self.layers);
            let [x, y] = [numbers.unit() - 0.5, numbers.unit() - 0.5];
            let middle = DVec3::new(x * depth, y * depth * 0.5625, -depth);
            let side = DVec3::new(numbers.unit() - 0.5, numbers.unit() - 0.5, numbers.unit() - 0.5);
            let right = side.try_normalize().unwrap_or(DVec3::X);
            let up = right.any_orthonormal_vector();
            add_square(&mut mesh, middle, right * half, up * half);
        }
        let options = LoadOptions { max_triangles: u64::from(u32::MAX), ..LoadOptions::default() };
        Scene::from_mesh(mesh, &options).map_err(|error| SessionError::Internal(error.to_string()))
    }
}

/// Adds a square by its middle and the halves of its sides.
fn add_square(mesh: &mut SurfaceMesh, middle: DVec3, right: DVec3, up: DVec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([
        middle - right - up,
        middle + right - up,
        middle + right + up,
        middle - right + up,
    ]);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// Pseudo-random numbers (Knuth's MMIX).
struct Numbers(u64);

impl Numbers {
    /// The next one, in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 31)
    }
}

/// A wide aperture, focused before the wall: circles of some 20 px of 1080 on the nearest leaves.
fn camera([width, height]: [u32; 2]) -> Camera {
    Camera { width, height, yfov: 0.5, focus_distance: 5.5, aperture_radius: 0.025, ..Camera::default() }
}

/// A colour for each triangle, and black beyond.
struct TriangleColors;

impl Radiance for TriangleColors {
    fn outgoing(&self, point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
        let hash = |k: u32| (point.triangle / 2).wrapping_add(k).wrapping_mul(0x9E37_79B1) >> 24;
        OutgoingRadiance::from_own(Vec3::new(hash(1) as f32, hash(2) as f32, hash(3) as f32) / 256.0)
    }

    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }

    fn varies_within_pixel(&self, _point: SurfacePoint) -> bool {
        false
    }
}

/// Times bakes for pictures of up to `size` columns and rows.
///
/// # Errors
/// The work was cancelled.
pub fn measure(
    size: [u32; 2],
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    let [of_samples, of_triangles, of_layers] = GROWTHS;
    let scaled = |share: f64| size.map(|side| (f64::from(side) * share.sqrt()).round().max(16.0) as u32);
    let usual = Foliage { triangles: USUAL_TRIANGLES, layers: USUAL_LAYERS };
    let tracer = Tracer::new(Arc::new(usual.scene()?));
    for share in PIXEL_SHARES {
        time_bake(&tracer, scaled(share), of_samples, None, measured, steps, note)?;
    }
    for triangles in TRIANGLES {
        let tracer = Tracer::new(Arc::new(Foliage { triangles, ..usual }.scene()?));
        time_bake(&tracer, scaled(0.25), of_triangles, Some(triangles), measured, steps, note)?;
    }
    for layers in LAYERS {
        let foliage = Foliage { triangles: layers * TRIANGLES_OF_LAYER, layers };
        let tracer = Tracer::new(Arc::new(foliage.scene()?));
        time_bake(&tracer, scaled(0.25), of_layers, Some(layers), measured, steps, note)?;
    }
    for growth in GROWTHS {
        note(&slope_sentence(growth, &measured.records));
    }
    Ok(())
}

fn time_bake(
    tracer: &Tracer,
    size: [u32; 2],
    growth: Growth,
    against: Option<u32>,
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    let camera = camera(size);
    let start = Instant::now();
    let baking = steps.begin("baking");
    let salf = salf::bake(tracer, &TriangleColors, &camera, &BakeOptions::default(), &*baking)?;
    let timing = measured.frame.timing_of(start.elapsed().as_secs_f64());
    let mut record = EngineRecord::new("foliage", growth.what, &salf, timing);
    record.bytes = salf.statistics().bytes as u64;
    record.against = Some(against.map_or(record.samples as f64, f64::from));
    note(&record.summary_line());
    measured.records.push(record);
    Ok(())
}

/// What the time of a bake grows with: pairs of it and of s, of one of [`GROWTHS`].
pub fn points(growth: Growth, records: &[EngineRecord]) -> Vec<(f64, f64)> {
    let own = records.iter().filter(|record| record.what == growth.what);
    own.filter_map(|record| Some((record.against?, record.ms_median / 1e3))).collect()
}

/// How the time of a bake grows, as a sentence.
pub fn slope_sentence(growth: Growth, records: &[EngineRecord]) -> String {
    let slope = log_slope(&points(growth, records));
    format!("The time of a bake grows with the number of {} to the power of {slope:.2}.", growth.with)
}

#[cfg(test)]
mod tests {
    use super::*;
    use trace::Ray;

    #[test]
    fn a_layer_covers_a_third_whatever_its_triangles() {
        for (triangles, layers) in [(2_000, 1), (50_000, 1), (50_000, 8)] {
            let scene = Arc::new(Foliage { triangles, layers }.scene().unwrap());
            assert_eq!(scene.triangles.len() as u32, triangles + 2);
            let (tracer, camera) = (Tracer::new(scene), camera([96, 54]));
            let is_wall = |k: u32| {
                let pixel = glam::DVec2::new(f64::from(k % 96) + 0.5, f64::from(k / 96) + 0.5);
                let hit = tracer.first_hit(&Ray::pinhole(&camera, glam::DVec2::ZERO, pixel)).unwrap();
                hit.point.triangle < 2
            };
            let open = (0..96 * 54).filter(|k| is_wall(*k)).count() as f64 / f64::from(96 * 54);
            let expected = (-COVER * f64::from(layers)).exp();
            assert!((open - expected).abs() < 0.12, "{triangles} {layers}: {open} {expected}");
        }
    }

    #[test]
    fn slopes_are_of_their_own_records() {
        let camera = camera([8, 8]);
        let salf = salf::Salf::with_samples(camera, Vec::new().into());
        let record = |growth: Growth, against: f64, ms: f64| {
            let timing = crate::engine::frame_copy::Timing { seconds: ms / 1e3, frame_copy: 1.0 };
            EngineRecord {
                against: Some(against),
                ..EngineRecord::new("foliage", growth.what, &salf, timing)
            }
        };
        let [samples, triangles, _] = GROWTHS;
        let records = [record(samples, 1.0, 5.0), record(samples, 4.0, 20.0), record(triangles, 1.0, 7.0)];
        assert_eq!(points(samples, &records).len(), 2);
        let sentence = slope_sentence(samples, &records);
        assert!(sentence.contains("samples to the power of 1.00"), "{sentence}");
    }
}
