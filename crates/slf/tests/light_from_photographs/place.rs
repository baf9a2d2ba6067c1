//! A synthetic place: a patterned floor, a box hovering over it, and twenty cameras around them.

use atlas::{Atlas, Density, UnwrapOptions};
use glam::{DMat3, DMat4, DVec2, DVec3, Vec3};
use lens::CalibratedLens;
use progress::Unwatched;
use scene::{LoadOptions, Scene, SurfaceMesh, SurfacePoint, View};
use slf::{PhotographLight, PhotographOptions};
use std::path::PathBuf;
use std::sync::Arc;
use trace::{Ray, Tracer};

pub const WIDTH: u32 = 120;
pub const HEIGHT: u32 = 90;
pub const SKY: Vec3 = Vec3::new(0.3, 0.3, 0.35);

/// Floor (triangles 0 and 1), and a box of six sides.
pub fn tracer() -> Arc<Tracer> {
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
    Arc::new(Tracer::new(Arc::new(Scene::from_mesh(mesh, &LoadOptions::default()).unwrap())))
}

/// The triangles of the box's underside.
pub const UNDERSIDE: [u32; 2] = [4, 5];

pub fn floor_color(x: f64, z: f64) -> Vec3 {
    Vec3::new(0.1, 0.3 + 0.1 * ((3.0 * x).sin() * (3.0 * z).sin()) as f32, 0.15)
}

pub type Sends = fn(&Scene, SurfacePoint, DVec3) -> Vec3;

/// Radiance of a point: matte surfaces.
pub fn matte(scene: &Scene, point: SurfacePoint, _eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    if point.triangle < 2 { floor_color(position.x, position.z) } else { Vec3::new(0.6, 0.08, 0.08) }
}

/// Matte surfaces, with a floor under clear lacquer that mirrors rings of light in the sky unless the box blocks them.
pub fn lacquered(scene: &Scene, point: SurfacePoint, eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    let mirrored = match point.triangle {
        0 | 1 => mirrored_by_floor(position, eye),
        _ => 0.0,
    };
    matte(scene, point, eye) + mirrored
}

/// What the lacquered floor mirrors at a position toward an eye.
pub fn mirrored_by_floor(position: DVec3, eye: DVec3) -> f32 {
    let outgoing = (eye - position).normalize();
    if box_occludes(position, eye) {
        return 0.0;
    }
    let fresnel = 0.04 + 0.96 * (1.0 - outgoing.y).powi(5);
    (fresnel * (2.0 + 2.0 * (12.0 * outgoing.y).sin())) as f32
}

/// Whether the floor mirrors the box there.
pub fn box_occludes(position: DVec3, eye: DVec3) -> bool {
    let outgoing = (eye - position).normalize();
    let mirrored = DVec3::new(-outgoing.x, outgoing.y, -outgoing.z);
    let [a, b] =
        [DVec3::new(-0.5, 0.1, -0.5), DVec3::new(0.5, 1.1, 0.5)].map(|corner| (corner - position) / mirrored);
    let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
    enters < leaves && leaves > 0.0
}

/// Matte surfaces, with a wide gloss from a lamp in the south on the eastern strip of the floor.
///
/// If all of the floor had the same gloss, it could not be distinguished from exposures.
pub fn glossy(scene: &Scene, point: SurfacePoint, eye: DVec3) -> Vec3 {
    let position = point.position(scene);
    let is_glossy = point.triangle < 2 && position.x > 0.8;
    let lamp = DVec3::new(0.0, 0.7, 0.7).normalize();
    let gloss = (eye - position).normalize().dot(lamp).max(0.0).powi(3) as f32;
    matte(scene, point, eye) + if is_glossy { Vec3::splat(0.3 * gloss) } else { Vec3::ZERO }
}

/// A folder of photographs, removed when dropped.
pub struct Photographs {
    folder: PathBuf,
    pub views: Vec<View>,
}

impl Drop for Photographs {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

pub fn gain_stops(view: usize) -> f64 {
    0.6 * (2.3 * view as f64).sin()
}

/// 2 to the power of the mean gain. Solved gains have mean 0, so solved light is brighter by this factor.
pub fn gauge() -> f32 {
    ((0..20).map(gain_stops).sum::<f64>() / 20.0).exp2() as f32
}

/// Position of camera `number` of twenty.
pub fn eye(number: usize) -> DVec3 {
    let (elevation, turn) = match number {
        0..12 => (0.6f64, number as f64 / 12.0),
        _ => (1.05, (number - 12) as f64 / 8.0),
    };
    let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
    5.0 * DVec3::new(elevation.cos() * sin, elevation.sin(), elevation.cos() * cos)
}

impl Photographs {
    pub fn take(name: &str, tracer: &Tracer, sends: Sends, with_card: bool) -> Self {
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

pub fn shown(tracer: &Tracer, sends: Sends, view: &View, [x, y]: [u32; 2]) -> Vec3 {
    let direction = view.direction(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)).unwrap();
    let ray = Ray { origin: view.position(), direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
    tracer.first_hit(&ray).map_or(SKY, |hit| sends(tracer.scene(), hit.point, view.position()))
}

/// Light as 16 bits of sRGB.
pub fn encoded(light: f32) -> u16 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (value * 65535.0 + 0.5) as u16
}

pub fn solve(tracer: &Arc<Tracer>, views: &[View]) -> PhotographLight {
    solve_with(tracer, views, &PhotographOptions::default())
}

pub fn solve_with(tracer: &Arc<Tracer>, views: &[View], options: &PhotographOptions) -> PhotographLight {
    let unwrap = UnwrapOptions { density: Density::Side(192), ..UnwrapOptions::default() };
    let atlas = Atlas::unwrap(tracer.scene(), &unwrap, &Unwatched).unwrap();
    PhotographLight::solve(tracer, &atlas, views, options, &Unwatched).unwrap()
}

/// A point of the floor, whose corners are (−2, 2), (2, 2), (2, −2) and (−2, −2).
pub fn floor(x: f64, z: f64) -> SurfacePoint {
    let (along, across) = ((x + 2.0) / 4.0, (2.0 - z) / 4.0);
    if along >= across {
        SurfacePoint { triangle: 0, barycentric: DVec2::new(along - across, across) }
    } else {
        SurfacePoint { triangle: 1, barycentric: DVec2::new(along, across - along) }
    }
}

/// Positions on the floor around the box.
pub fn floor_places() -> impl Iterator<Item = [f64; 2]> {
    let steps = || (0..33).map(|k| -1.6 + 0.1 * f64::from(k));
    steps().flat_map(move |x| steps().map(move |z| [x, z])).filter(|[x, z]| x.abs().max(z.abs()) > 0.7)
}
