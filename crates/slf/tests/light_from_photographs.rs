//! Light from photographs of a made-up place: a patterned floor, a box that hovers over it, twenty cameras around.

use atlas::{Atlas, Density, UnwrapOptions};
use glam::{DMat3, DMat4, DVec2, DVec3, Vec3};
use lens::CalibratedLens;
use progress::{Progress, Unwatched};
use scene::{LoadOptions, Scene, SurfaceMesh, SurfacePoint, View};
use slf::{PhotographError, PhotographLight, PhotographOptions};
use std::path::PathBuf;
use std::sync::Arc;
use trace::{Radiance, Ray, Tracer};

const WIDTH: u32 = 120;
const HEIGHT: u32 = 90;
const SKY: Vec3 = Vec3::new(0.3, 0.3, 0.35);

/// Floor (triangles 0 and 1), and a box of six sides.
fn tracer() -> Tracer {
    let mut mesh = SurfaceMesh { name: "place".into(), ..SurfaceMesh::default() };
    let mut rectangle = |corner: [f64; 3], side: [f64; 3], other: [f64; 3]| {
        let [corner, side, other] = [corner, side, other].map(DVec3::from_array);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([corner, corner + side, corner + side + other, corner + other]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    rectangle([-2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0]);
    let (low, high) = (0.1, 1.1);
    rectangle([-0.5, high, 0.5], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]);
    rectangle([-0.5, low, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let sides =
        [[-0.5, 0.5, 1.0, 0.0], [0.5, 0.5, 0.0, -1.0], [0.5, -0.5, -1.0, 0.0], [-0.5, -0.5, 0.0, 1.0]];
    for [x, z, dx, dz] in sides {
        rectangle([x, low, z], [dx, 0.0, dz], [0.0, high - low, 0.0]);
    }
    Tracer::new(Arc::new(Scene::of_mesh(mesh, &LoadOptions::default()).unwrap()))
}

/// The triangles of the box's underside.
const UNDERSIDE: [u32; 2] = [4, 5];

fn floor_color(x: f64, z: f64) -> Vec3 {
    Vec3::new(0.1, 0.3 + 0.1 * ((3.0 * x).sin() * (3.0 * z).sin()) as f32, 0.15)
}

type Sends = fn(&Scene, SurfacePoint, DVec3) -> Vec3;

/// What a point of the place sends.
fn matte(scene: &Scene, point: SurfacePoint, _eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    if point.triangle < 2 { floor_color(position.x, position.z) } else { Vec3::new(0.6, 0.08, 0.08) }
}

/// The same, the eastern strip of the floor under a wide gloss of a lamp in the south.
///
/// Were all of the floor glossy in the same way, nobody could tell that from exposures.
fn glossy(scene: &Scene, point: SurfacePoint, eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    let is_glossy = point.triangle < 2 && position.x > 0.8;
    let lamp = DVec3::new(0.0, 0.7, 0.7).normalize();
    let gloss = (eye - position).normalize().dot(lamp).max(0.0).powi(3) as f32;
    matte(scene, point, eye) + if is_glossy { Vec3::splat(0.3 * gloss) } else { Vec3::ZERO }
}

/// A folder of photographs, removed in the end.
struct Photographs {
    folder: PathBuf,
    views: Vec<View>,
}

impl Drop for Photographs {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn gain_stops(view: usize) -> f64 {
    0.6 * (2.3 * view as f64).sin()
}

/// 2 to the mean gain of all: solved gains are 0 in the mean, so light is this much brighter than it was.
fn gauge() -> f32 {
    ((0..20).map(gain_stops).sum::<f64>() / 20.0).exp2() as f32
}

/// Where camera `number` of twenty stands.
fn eye(number: usize) -> DVec3 {
    let (elevation, turn) = match number {
        0..12 => (0.6f64, number as f64 / 12.0),
        _ => (1.05, (number - 12) as f64 / 8.0),
    };
    let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
    5.0 * DVec3::new(elevation.cos() * sin, elevation.sin(), elevation.cos() * cos)
}

impl Photographs {
    fn take(name: &str, tracer: &Tracer, sends: Sends, with_card: bool) -> Self {
        let folder = std::env::temp_dir().join(format!("slf_photographs_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let take = |number: usize| {
            let back = eye(number).normalize();
            let right = DVec3::Y.cross(back).normalize();
            let axes = DMat3::from_cols(right, back.cross(right), back);
            let view = View {
                name: format!("{number}.png"),
                picture: folder.join(format!("{number}.png")),
                orientation: 1,
                exif_orientation: 1,
                lens: CalibratedLens::pinhole([WIDTH, HEIGHT], 105.0).unwrap(),
                camera_to_world: DMat4::from_mat3_translation(axes, eye(number)),
                mask: None,
                exposure_hint: None,
            };
            let has_card = with_card && number % 5 == 2;
            let picture = image::ImageBuffer::from_fn(WIDTH, HEIGHT, |x, y| {
                let is_card = has_card && (40..75).contains(&x) && (45..70).contains(&y);
                let gain = gain_stops(number).exp2() as f32;
                let light = if is_card {
                    Vec3::new(0.9, 0.1, 0.9)
                } else {
                    shown(tracer, sends, &view, [x, y]) * gain
                };
                image::Rgb(light.to_array().map(encoded))
            });
            picture.save(&view.picture).unwrap();
            view
        };
        let views = (0..20).map(take).collect();
        Self { folder, views }
    }
}

fn shown(tracer: &Tracer, sends: Sends, view: &View, [x, y]: [u32; 2]) -> Vec3 {
    let direction = view.direction(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)).unwrap();
    let ray = Ray { origin: view.position(), direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
    tracer.first_hit(&ray).map_or(SKY, |hit| sends(tracer.scene(), hit.point, view.position()))
}

/// Light as 16 bits of sRGB.
fn encoded(light: f32) -> u16 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (value * 65535.0 + 0.5) as u16
}

fn solve(tracer: &Tracer, views: &[View]) -> PhotographLight {
    let options = UnwrapOptions { density: Density::Side(192), ..UnwrapOptions::default() };
    let atlas = Atlas::unwrap(tracer.scene(), &options, &Unwatched).unwrap();
    PhotographLight::solve(tracer, &atlas, views, &PhotographOptions::default(), &Unwatched).unwrap()
}

/// The floor at a place. Its corners are (−2, 2), (2, 2), (2, −2) and (−2, −2).
fn floor(x: f64, z: f64) -> SurfacePoint {
    let (along, across) = ((x + 2.0) / 4.0, (2.0 - z) / 4.0);
    if along >= across {
        SurfacePoint { triangle: 0, barycentric: DVec2::new(along - across, across) }
    } else {
        SurfacePoint { triangle: 1, barycentric: DVec2::new(along, across - along) }
    }
}

/// Places of the floor around the box.
fn floor_places() -> impl Iterator<Item = [f64; 2]> {
    let steps = || (0..33).map(|k| -1.6 + 0.1 * f64::from(k));
    steps().flat_map(move |x| steps().map(move |z| [x, z])).filter(|[x, z]| x.abs().max(z.abs()) > 0.7)
}

#[test]
fn gains_are_found_and_what_stands_before_a_texel_leaves_no_colour_on_it() {
    let tracer = tracer();
    let photographs = Photographs::take("gains", &tracer, matte, false);
    let light = solve(&tracer, &photographs.views);
    let mean = f64::from(gauge().log2());
    for (number, exposure) in light.exposures().iter().enumerate() {
        for gain in exposure.gain_stops {
            assert!((gain - (gain_stops(number) - mean)).abs() < 0.05, "{number}: {gain}");
        }
    }
    // From many sides the red box stands before the floor; where that is not told, red rises from 0.1 to 0.2 and more.
    for [x, z] in floor_places() {
        let found = light.constant(floor(x, z)) / gauge();
        assert!(found.distance(floor_color(x, z)) < 0.04, "{x} {z}: {found}");
    }
}

#[test]
fn a_card_in_a_fifth_of_the_pictures_is_left_out() {
    let tracer = tracer();
    let [without, with] = [("no_card", false), ("card", true)].map(|(name, has_card)| {
        let photographs = Photographs::take(name, &tracer, matte, has_card);
        solve(&tracer, &photographs.views)
    });
    let (mut sum, mut count) = (0.0, 0.0);
    for [x, z] in floor_places() {
        let [without, with] =
            [&without, &with].map(|light| light.toward(floor(x, z), DVec3::new(0.5, 4.0, 3.0)));
        sum += without.distance_squared(with);
        count += 1.0;
    }
    // A fifth of the card's difference (1.05 in length), where the card is seen, is what a mean would show.
    let off = (sum / count as f32).sqrt();
    assert!(off > 0.0 && off < 0.04, "{off}");
}

#[test]
fn what_no_photograph_shows_is_filled_and_known_as_such() {
    let tracer = tracer();
    let photographs = Photographs::take("filled", &tracer, matte, false);
    let light = solve(&tracer, &photographs.views);
    for triangle in UNDERSIDE {
        let point = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
        assert_eq!(light.seen(point), 0.0);
        let filled = light.toward(point, DVec3::new(0.0, -5.0, 1.0));
        assert!(filled.is_finite() && filled.max_element() > 0.05, "{filled}");
    }
    assert_eq!(light.seen(floor(1.5, 0.3)), 1.0);
    // Past the floor's edge, as camera 0 sees it.
    let sky = light.from_infinity(DVec3::new(0.25, -0.25, -1.0)) / gauge();
    assert!(sky.distance(SKY) < 0.03, "{sky}");
}

#[test]
fn gloss_is_kept_where_photographs_show_it_and_changes_smoothly() {
    let tracer = tracer();
    let photographs = Photographs::take("gloss", &tracer, glossy, false);
    let light = solve(&tracer, &photographs.views);
    let point = floor(1.2, 1.0);
    let position = point.position(tracer.scene());
    let [to_lamp, away] = [DVec3::new(0.0, 3.5, 3.5), DVec3::new(0.0, 3.5, -3.5)].map(|step| position + step);
    let truth = glossy(tracer.scene(), point, to_lamp);
    let [found, flat] = [light.toward(point, to_lamp), light.constant(point)].map(|light| light / gauge());
    assert!(found.distance(truth) < 0.8 * flat.distance(truth), "{found} {flat} for {truth}");
    let [found, truth] = [light.toward(point, away) / gauge(), glossy(tracer.scene(), point, away)];
    assert!(found.distance(truth) < 0.1, "{found} for {truth}");
    // Over an aperture between photographs nothing pops.
    let along = |k: u32| light.toward(point, to_lamp.lerp(away, f64::from(k) / 400.0));
    let steepest = (0..400).map(|k| along(k).distance(along(k + 1))).fold(0.0, f32::max);
    assert!(steepest < 0.02 && steepest > 0.0, "{steepest}");
}

#[test]
fn light_does_not_depend_on_the_number_of_threads() {
    let tracer = tracer();
    let photographs = Photographs::take("threads", &tracer, glossy, false);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&tracer, &photographs.views))
    });
    assert_eq!(one.exposures(), three.exposures());
    for [x, z] in floor_places() {
        let [one, three] = [&one, &three].map(|light| light.leaving(floor(x, z), DVec3::new(1.0, 3.0, 2.0)));
        assert_eq!(one, three, "{x} {z}");
    }
}

#[test]
fn nothing_comes_of_no_photographs_and_of_what_is_stopped() {
    struct Stopped;
    impl Progress for Stopped {
        fn report(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let tracer = tracer();
    let photographs = Photographs::take("stopped", &tracer, matte, false);
    let options = UnwrapOptions { density: Density::Side(64), ..UnwrapOptions::default() };
    let atlas = Atlas::unwrap(tracer.scene(), &options, &Unwatched).unwrap();
    let solve = |views: &[View], progress: &dyn Progress| {
        PhotographLight::solve(&tracer, &atlas, views, &PhotographOptions::default(), progress)
    };
    assert!(matches!(solve(&[], &Unwatched), Err(PhotographError::None)));
    assert!(matches!(solve(&photographs.views, &Stopped), Err(PhotographError::Cancelled)));
}

#[test]
fn light_comes_back_from_its_bytes_and_from_no_others() {
    let tracer = tracer();
    let photographs = Photographs::take("stored", &tracer, matte, false);
    let scene = Arc::new(Scene { views: photographs.views.clone(), ..Scene::clone(tracer.scene()) });
    let tracer = Tracer::new(scene.clone());
    let light = solve(&tracer, &photographs.views);
    let bytes = light.to_bytes();
    let again = PhotographLight::from_bytes(&bytes, &scene).unwrap();
    assert_eq!(again.to_bytes(), bytes);
    assert_eq!(again.exposures(), light.exposures());
    let eye = DVec3::new(0.3, 2.0, 1.5);
    for (x, z) in [(0.1, 0.2), (-1.7, 1.1), (1.9, -1.9)] {
        let [a, b] = [&light, &again].map(|light| light.leaving(floor(x, z), eye));
        assert_eq!((a.own, a.carried), (b.own, b.carried));
    }
    for length in (0..bytes.len()).step_by(bytes.len() / 97) {
        assert!(PhotographLight::from_bytes(&bytes[..length], &scene).is_none(), "{length}");
    }
    let other = Arc::new(Scene { triangles: scene.triangles[1..].to_vec(), ..Scene::clone(&scene) });
    assert!(PhotographLight::from_bytes(&bytes, &other).is_none());
}
