use super::*;
use crate::OutgoingRadiance;
use glam::{DVec2, DVec3, Vec3};
use lens::{ApertureMask, ApertureShape, Picture};
use progress::Unwatched;
use scene::SurfacePoint;
use std::sync::Arc;
use test_scenes::{Mesh, scene_of, white};

mod agreement;
mod character;
mod convergence;

/// Every surface sends its material's base colour; the background is black.
struct BaseColor(Arc<scene::Scene>);

impl Radiance for BaseColor {
    fn outgoing(&self, point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
        OutgoingRadiance::from_own(self.0.base_color(point).truncate())
    }
    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}

/// One focus everywhere.
struct Uniform(FocusOffset);

impl SurfaceField<FocusOffset> for Uniform {
    fn at(&self, _point: SurfacePoint) -> FocusOffset {
        self.0
    }
    fn at_infinity(&self) -> FocusOffset {
        self.0
    }
    fn bounds(&self, _triangle: u32) -> Option<[FocusOffset; 2]> {
        Some([self.0; 2])
    }
}

fn camera() -> Camera {
    Camera {
        width: 128,
        height: 128,
        yfov: 0.6,
        focus_distance: 3.0,
        aperture_radius: 0.15,
        sensor_height: 0.08,
        ..Camera::default()
    }
}

const SPOT_PX: f64 = 8.0;

/// A square facing the camera at depth z, SPOT_PX wide when seen sharp.
fn spot(camera: &Camera, z: f64) -> Arc<scene::Scene> {
    let half = SPOT_PX / 2.0 * z * camera.optics().tan_half_yfov / camera.optics().half_height_px;
    let square = Mesh::rectangle(DVec3::new(-half, -half, -z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half);
    scene_of([(square, white())])
}

fn picture(scene: Arc<scene::Scene>, camera: &Camera, focus: FocusOffset, spp: u32) -> Picture {
    let tracer = Tracer::new(scene.clone());
    let options = TruthOptions { samples_per_pixel: spp, seed: 1, ..TruthOptions::default() };
    render(&tracer, &BaseColor(scene), &Uniform(focus), camera, &options, &Unwatched).unwrap().picture
}

/// Energy (px), centroid (px from the middle, y up) and radius (px) of the disc that has the picture's second
/// moment.
fn moments(picture: &Picture) -> (f64, DVec2, f64) {
    let mut energy = 0.0;
    let (mut first, mut second) = (DVec2::ZERO, 0.0);
    let size = DVec2::new(f64::from(picture.width), f64::from(picture.height));
    for (k, rgb) in picture.radiance.iter().enumerate() {
        let (x, y) = (k % picture.width as usize, k / picture.width as usize);
        let position = (DVec2::new(x as f64, y as f64) + 0.5 - size / 2.0) * DVec2::new(1.0, -1.0);
        energy += f64::from(rgb[1]);
        first += f64::from(rgb[1]) * position;
        second += f64::from(rgb[1]) * position.length_squared();
    }
    let mean = first / energy;
    (energy, mean, (2.0 * (second / energy - mean.length_squared())).sqrt())
}

#[test]
fn a_white_furnace_is_exactly_white() {
    let room = scene_of([(Mesh::sphere(DVec3::new(0.1, 0.2, -0.3), 5.0, 16), white())]);
    for focus_distance in [3.0, f64::INFINITY] {
        let camera = Camera { focus_distance, width: 40, height: 30, ..camera() };
        for samples in [1, 5, 64] {
            let picture = picture(room.clone(), &camera, FocusOffset::STANDARD, samples);
            assert!(picture.radiance.iter().all(|rgb| *rgb == [1.0; 3]));
            assert!(picture.coverage.iter().all(|coverage| *coverage == 1.0));
        }
    }
}

#[test]
fn an_evenly_painted_wall_is_white() {
    let wall = Mesh::rectangle(DVec3::new(-9.0, -9.0, -5.0), DVec3::X * 18.0, DVec3::Y * 18.0);
    let wall = scene_of([(wall, white())]);
    for focus in [FocusOffset::new(0.9, 0.0), FocusOffset::new(1.05, 1.0), FocusOffset::new(1.1, 0.5)] {
        let picture = picture(wall.clone(), &Camera { width: 40, height: 30, ..camera() }, focus, 256);
        // Where κ is even, every pixel gives and takes the same number of samples.
        assert!(picture.coverage.iter().all(|coverage| *coverage == 1.0), "{focus:?}");
    }
}

#[test]
fn circles_of_confusion_have_their_radius_and_keep_their_energy() {
    let camera = camera();
    let optics = camera.optics();
    for z in [1.5, 3.0, 40.0] {
        let mut painted = None;
        for focus in [(1.0, 0.0), (0.9, 1.0), (1.05, 0.0), (0.93, 0.4)] {
            let focus = FocusOffset::new(focus.0, focus.1);
            let (energy, mean, radius) = moments(&picture(spot(&camera, z), &camera, focus, 256));
            let disc = optics.splat_radius_px(optics.kappa(1.0 / z, focus));
            // The second moments of the spot, a square, and of a pixel add to the disc's.
            let expected = (disc.powi(2) + (SPOT_PX.powi(2) + 1.0) / 3.0).sqrt();
            assert!((radius - expected).abs() < 0.3, "{focus:?} at {z}: {radius} px, expected {expected}");
            // At random, 256 · 64 samples would hit the spot with a deviation of 1/128.
            let relative = energy / SPOT_PX.powi(2);
            assert!((relative - 1.0).abs() < 3.0 / 128.0, "{focus:?} at {z}: {relative} of the energy");
            // All paint has the same rays; only pixels without any have samples to suit them.
            if !focus.is_standard() {
                assert!((energy / *painted.get_or_insert(energy) - 1.0).abs() < 1e-6, "{focus:?} at {z}");
            }
            assert!(mean.length() < 0.2, "{focus:?} at {z}: centred at {mean}");
        }
    }
}

/// An aperture open in one quarter: u, v > 0 (right and up, seen from behind the camera).
fn upper_right() -> lens::Aperture {
    let mask =
        ApertureMask { width: 2, height: 2, transmission: vec![0.0, 1.0, 0.0, 0.0], file: String::new() };
    ApertureShape::Mask(Arc::new(mask)).into()
}

#[test]
fn near_defocus_turns_the_aperture() {
    let camera = Camera { aperture: upper_right(), ..camera() };
    let optics = camera.optics();
    for (t, anchor, z) in [(0.9, 1.0, 2.0), (1.1, 1.0, 2.0), (1.0, 0.0, 1.5), (1.0, 0.0, 30.0)] {
        let focus = FocusOffset::new(t, anchor);
        let (_, mean, _) = moments(&picture(spot(&camera, z), &camera, focus, 64));
        let expected = DVec2::splat(0.5 * optics.splat_radius_px(optics.kappa(1.0 / z, focus)));
        assert!(mean.distance(expected) < 0.3, "{focus:?} at {z}: {mean}, expected {expected}");
        assert!(expected.length() > 3.0, "the check can tell the signs apart");
    }
}

#[test]
fn a_tiny_bright_lamp_is_a_smooth_disc() {
    let camera = camera();
    let optics = camera.optics();
    let z = 3.0;
    let half = 0.25 * z * optics.tan_half_yfov / optics.half_height_px;
    for (t, anchor) in [(0.8, 1.0), (1.2, 1.0)] {
        let lamp =
            Mesh::rectangle(DVec3::new(-half, -half, -z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half);
        let glow = scene::Material { base_color: glam::vec4(3e3, 3e3, 3e3, 1.0), ..white() };
        let focus = FocusOffset::new(t, anchor);
        let picture = picture(scene_of([(lamp, glow)]), &camera, focus, 64);
        let radius = optics.splat_radius_px(optics.kappa(1.0 / z, focus)).abs();
        let (energy, _, _) = moments(&picture);
        let expected = 3e3 * 0.25;
        assert!((energy / expected - 1.0).abs() < 0.01, "energy {energy}, expected {expected}");
        // A quarter pixel's worth of surface, spread over the disc: 64 rays a pixel meet it 16 times in all.
        let level = expected / (std::f64::consts::PI * radius.powi(2));
        for (k, rgb) in picture.radiance.iter().enumerate() {
            let (x, y) = ((k % 128) as f64 - 63.5, (k / 128) as f64 - 63.5);
            if x.hypot(y) < radius - 2.0 {
                let relative = f64::from(rgb[0]) / level;
                assert!((relative - 1.0).abs() < 0.5, "{relative} of {level} at {x}, {y}");
            }
        }
    }
}

#[test]
fn bright_surfaces_brighten_nothing() {
    // A half hidden bright wall, larger than its circle of confusion, partly outside of the frame: where it
    // is found by both kinds of rays the sum is right, pixel by pixel.
    let camera = Camera { width: 48, height: 32, ..camera() };
    let wall = Mesh::rectangle(DVec3::new(-0.1, -3.0, -4.0), DVec3::X * 5.0, DVec3::Y * 6.0);
    let fence = Mesh::rectangle(DVec3::new(0.1, -3.0, -2.0), DVec3::X * 0.1, DVec3::Y * 6.0);
    let scene_with = |level: f32| {
        let glow = scene::Material { base_color: glam::vec4(level, level, level, 1.0), ..white() };
        scene_of([(wall.clone(), glow.clone()), (fence.clone(), glow)])
    };
    for focus in [FocusOffset::STANDARD, FocusOffset::new(0.95, 1.0), FocusOffset::new(1.03, 0.0)] {
        // Of so few rays that samples are not chosen by light.
        let few = |level| picture(scene_with(level), &camera, focus, 64).coverage;
        assert!(few(5.0) == few(1.0), "coverage counts the camera's rays alone");
        let bright = picture(scene_with(5.0), &camera, focus, 256);
        let white = picture(scene_with(1.0), &camera, focus, 256);
        let difference = |k: usize| f64::from(bright.radiance[k][0] / 5.0 - white.radiance[k][0]);
        let pixels = 48 * 32;
        let mean = (0..pixels).map(difference).sum::<f64>() / pixels as f64;
        assert!(mean.abs() < 3e-3, "{mean} with {focus:?}");
        let deviation = (0..pixels).map(|k| difference(k).powi(2)).sum::<f64>() / pixels as f64;
        assert!(deviation.sqrt() < 0.03, "{} with {focus:?}", deviation.sqrt());
    }
}

#[test]
fn light_outside_of_the_frame_comes_in_by_its_circle_of_confusion() {
    let camera = camera();
    let z = 3.0;
    let focus = FocusOffset::new(0.9, 1.0);
    let radius = camera.optics().splat_radius_px(camera.optics().kappa(1.0 / z, focus)).abs();
    let px = z * (camera.yfov / 2.0).tan() / 64.0;
    for (outside, seen) in [(0.8 * radius, true), (1.2 * radius, false)] {
        let corner = DVec3::new((64.0 + outside - 1.0) * px, -px, -z);
        let scene = scene_of([(Mesh::rectangle(corner, DVec3::X * 2.0 * px, DVec3::Y * 2.0 * px), white())]);
        assert_eq!(moments(&picture(scene, &camera, focus, 64)).0 > 0.0, seen, "{outside} px of {radius}");
    }
}

#[test]
fn threads_do_not_matter() {
    let scene = scene_of([
        (
            Mesh::sphere(DVec3::new(0.0, 0.0, -4.0), 1.0, 12),
            scene::Material { base_color: glam::vec4(0.3, 0.7, 0.1, 1.0), ..white() },
        ),
        (Mesh::rectangle(DVec3::new(-9.0, -9.0, -9.0), DVec3::X * 18.0, DVec3::Y * 18.0), white()),
    ]);
    let render_with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            picture(scene.clone(), &Camera { width: 64, ..camera() }, FocusOffset::new(0.95, 0.3), 16)
        })
    };
    let one = render_with(1);
    assert_eq!(one, render_with(2));
    assert_eq!(one, render_with(3));
    assert_ne!(one, Picture::black(64, 128));
}

#[test]
fn the_brightest_light_does_not_overflow() {
    struct Blinding(f32);
    impl Radiance for Blinding {
        fn outgoing(&self, _point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
            OutgoingRadiance::from_own(Vec3::splat(self.0))
        }
        fn environment(&self, _direction: DVec3) -> Vec3 {
            Vec3::new(self.0, -self.0, f32::NAN)
        }
    }
    let camera = Camera { width: 8, height: 8, ..camera() };
    let tracer = Tracer::new(Arc::new(scene::Scene::default()));
    for radiance in [1e-3, 1.0, 1e9, 1e30, f32::MAX] {
        let options = TruthOptions { samples_per_pixel: 64, ..TruthOptions::default() };
        let focus = Uniform(FocusOffset::STANDARD);
        let picture =
            render(&tracer, &Blinding(radiance), &focus, &camera, &options, &Unwatched).unwrap().picture;
        for rgb in picture.radiance {
            assert!(
                (rgb[0] / radiance - 1.0).abs() < 1e-6 && rgb[1] == 0.0 && rgb[2] == 0.0,
                "{radiance}: {rgb:?}"
            );
        }
    }
}

#[test]
fn it_stops_when_cancelled() {
    struct Impatient;
    impl Progress for Impatient {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let tracer = Tracer::new(Arc::new(scene::Scene::default()));
    let radiance = BaseColor(tracer.scene().clone());
    let options = TruthOptions { samples_per_pixel: 1 << 20, ..TruthOptions::default() };
    let focus = Uniform(FocusOffset::STANDARD);
    assert_eq!(render(&tracer, &radiance, &focus, &camera(), &options, &Impatient), Err(Cancelled));
}
