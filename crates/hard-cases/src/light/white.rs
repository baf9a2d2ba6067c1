//! White surfaces close together: what is passed on from patch to patch must stay what arrives.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::worst;
use crate::support::shot::picture_of;
use focus::Focus;
use glam::{DMat3, DMat4, DVec3, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{BakeOptions, bake};
use scene::{Material, Scalar, Scene, Volume, Workflow, World};
use slf::{Irradiance, IrradianceOptions, Transport, TransportOptions};
use std::sync::Arc;
use test_scenes::{Mesh, Random, scene_of};
use trace::Tracer;
use trace::truth::{self, TruthOptions};

pub const CASES: &[Case] = &[
    Case {
        name: "white matte shapes",
        reason: "Shapes that touch, intersect, lie within each other or are doubled pass light on many times: \
                 no patch sends more than its albedo's share of what arrives, so that the sum stays finite.",
        control: "one bounce",
        check: matte,
    },
    Case {
        name: "white metal shapes",
        reason: "As for matte shapes. The weights of sampled directions have a mean of 1 on rough metal but no \
                 bound, and their product along a path between near surfaces has none either.",
        control: "one bounce",
        check: metal,
    },
    Case {
        name: "white glass shapes",
        reason: "Glass that absorbs nothing passes light on until it gets out.",
        control: "one bounce",
        check: glass,
    },
];

/// The geometries.
const SHAPES: [fn() -> Vec<Mesh>; 6] = [touching, intersecting, nested, doubled, slivers, needles];

/// The albedos that the geometries take turns with.
const ALBEDOS: [f32; 3] = [1.0, 0.99, 0.9];

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Mesh {
    Mesh::sphere(DVec3::new(x, y, z), radius, 16)
}

fn floor() -> Mesh {
    Mesh::cuboid(DVec3::new(-2.0, -1.2, -2.0), DVec3::new(2.0, -1.0, 2.0))
}

fn touching() -> Vec<Mesh> {
    let cube = Mesh::cuboid(DVec3::new(-0.5, -1.0, -0.5), DVec3::new(0.5, 0.0, 0.5));
    vec![floor(), cube, ball(1.0, -0.5, 0.0, 0.5), ball(-1.0, -0.5, 0.0, 0.5), ball(0.0, 0.5, 0.0, 0.5)]
}

fn intersecting() -> Vec<Mesh> {
    let plank = Mesh::cuboid(DVec3::new(-1.5, -0.4, -0.2), DVec3::new(1.5, -0.1, 0.2));
    vec![floor(), plank, ball(0.0, -0.4, 0.0, 0.8), ball(0.6, -0.6, 0.4, 0.6), ball(-0.7, -0.9, 0.3, 0.5)]
}

fn nested() -> Vec<Mesh> {
    // A bowl with a ball in it, and a box within a box whose lid is missing.
    let mut bowl = ball(-0.8, -0.3, 0.0, 0.7);
    bowl.triangles.retain(|corners| corners.iter().all(|&v| bowl.positions[v as usize].y < 0.0));
    let mut open = Mesh::cuboid(DVec3::new(0.1, -1.0, -0.6), DVec3::new(1.3, -0.1, 0.6)).turned();
    open.triangles.drain(8..10);
    let inner = Mesh::cuboid(DVec3::new(0.4, -1.0, -0.3), DVec3::new(1.0, -0.5, 0.3));
    vec![floor(), bowl.clone(), bowl.turned(), ball(-0.8, -0.6, 0.0, 0.3), open, inner]
}

fn doubled() -> Vec<Mesh> {
    let cube = Mesh::cuboid(DVec3::new(-1.2, -1.0, -0.5), DVec3::new(-0.2, 0.0, 0.5));
    let sphere = ball(0.7, -0.4, 0.0, 0.6);
    vec![floor(), floor(), cube.clone(), cube, sphere.clone(), sphere]
}

fn slivers() -> Vec<Mesh> {
    // A fan of long triangles that meet at a point, above a floor.
    let mut fan = Mesh { positions: vec![DVec3::new(0.0, -0.99, 0.0)], triangles: Vec::new() };
    for k in 0..180u32 {
        let angle = f64::from(k) * std::f64::consts::TAU / 180.0;
        fan.positions.push(DVec3::new(
            1.5 * angle.cos(),
            -0.5 + 0.3 * (5.0 * angle).sin(),
            1.5 * angle.sin(),
        ));
    }
    fan.triangles = (0..180).map(|k| [0, 1 + (k + 1) % 180, 1 + k]).collect();
    vec![floor(), fan, ball(0.0, 0.0, 0.0, 0.4)]
}

fn needles() -> Vec<Mesh> {
    let mut random = Random(3);
    let mut all = vec![floor()];
    for _ in 0..60 {
        let foot = random.in_cube() * DVec3::new(1.4, 0.0, 1.4) - DVec3::Y;
        all.push(Mesh::cuboid(foot, foot + DVec3::new(0.04, 0.6 + 0.4 * random.unit(), 0.04)));
    }
    all
}

fn with_lobes(albedo: f32, metallic: f32, roughness: f32) -> Material {
    Material {
        base_color: Vec3::splat(albedo).extend(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(metallic),
            roughness: Scalar::constant(roughness),
        },
        ..Material::default()
    }
}

fn matte(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let white = |albedo: f32| Material {
        base_color: Vec3::splat(albedo).extend(1.0),
        double_sided: false,
        ..Material::lambertian_white()
    };
    compare(white, (0, 35.0), effort, progress)
}

fn metal(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    compare(|albedo| with_lobes(albedo, 1.0, 1.0), (1, 31.0), effort, progress)
}

fn glass(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let white = |albedo: f32| Material {
        transmission: Scalar::constant(1.0),
        volume: Some(Volume { attenuation_color: Vec3::ONE, attenuation_distance: 1.0 }),
        ior: 1.5,
        ..with_lobes(albedo, 0.0, 0.5)
    };
    compare(white, (2, 27.0), effort, progress)
}

/// Compares pictures from cached light with the ground truth, for all geometries with one kind of material: `turn` is
/// the first one's albedo, `floor_db` the least agreement.
fn compare(
    material: impl Fn(f32) -> Material,
    (turn, floor_db): (usize, f64),
    effort: Effort,
    progress: &dyn Progress,
) -> Result<Verdict, Cancelled> {
    let shapes = effort.choose(&SHAPES[..], &SHAPES[turn..=turn]);
    let [mut shortfalls, mut ratios] = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
    for (index, geometry) in shapes.iter().enumerate() {
        let albedo = ALBEDOS[(index + turn) % ALBEDOS.len()];
        let meshes = geometry();
        let last = meshes.len() - 1;
        // Glass stands on a matte floor: by itself it would be nearly invisible.
        let is_glass = material(albedo).transmission.factor > 0.0;
        let of_mesh = |at: usize| match is_glass && at != last {
            true => Material { base_color: Vec3::splat(albedo).extend(1.0), ..Material::lambertian_white() },
            false => material(albedo),
        };
        let scene = scene_of(meshes.into_iter().enumerate().map(|(at, mesh)| (mesh, of_mesh(at))));
        let shot = WhiteShot::new(scene, effort);
        let truths = [shot.truth(1, progress)?, shot.truth(2, progress)?];
        let brightest_truth = brightest(&truths[0]).max(brightest(&truths[1]));
        let (right, wrong) = (shot.cached(None, progress)?, shot.cached(Some(1), progress)?);
        for (which, picture) in [&right, &wrong].into_iter().enumerate() {
            shortfalls[which].push(floor_db - psnr(picture, &truths));
            ratios[which].push(brightest(picture) / brightest_truth);
        }
    }
    let values = |which: usize| [largest(&shortfalls[which]), largest(&ratios[which])];
    let limits = [("below the floor by (dB)", effort.choose(0.0, REDUCED_DB)), ("brightest pixel", 2.0)];
    let expected = format!("finite, at least {floor_db} dB from the ground truth");
    Ok(Verdict::new(expected, limits, values(0), values(1)))
}

/// What the few rays of tests take from it.
const REDUCED_DB: f64 = 3.0;

/// White shapes in the studio.
struct WhiteShot {
    tracer: Arc<Tracer>,
    camera: Camera,
    effort: Effort,
}

impl WhiteShot {
    fn new(scene: Arc<Scene>, effort: Effort) -> Self {
        let (eye, target) = (DVec3::new(0.6, 0.9, 4.0), DVec3::new(0.0, -0.4, 0.0));
        let back = (eye - target).normalize();
        let right = DVec3::Y.cross(back).normalize();
        let axes = DMat3::from_cols(right, back.cross(right), back);
        let camera = Camera {
            width: 64,
            height: 48,
            yfov: 0.65,
            aperture_radius: 0.02,
            focus_distance: 4.0,
            camera_to_world: DMat4::from_translation(eye) * DMat4::from_mat3(axes),
            ..Camera::default()
        };
        Self { tracer: Arc::new(Tracer::new(scene)), camera, effort }
    }

    fn transport(&self, bounces: Option<u32>, paths: u32) -> Transport {
        let world = World { bounces, ..World::studio() };
        Transport::new(self.tracer.clone(), world, TransportOptions { paths, ..TransportOptions::default() })
    }

    fn focus(&self) -> Focus {
        Focus::constant(self.tracer.scene().clone(), FocusOffset::STANDARD)
    }

    fn truth(&self, seed: u32, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        let samples_per_pixel = self.effort.choose(128, 64);
        let options = TruthOptions { samples_per_pixel, seed, ..TruthOptions::default() };
        let light = self.transport(None, 1);
        let rendered = truth::render(&self.tracer, &light, &self.focus(), &self.camera, &options, progress)?;
        Ok(rendered.picture)
    }

    fn cached(&self, bounces: Option<u32>, progress: &dyn Progress) -> Result<Picture, Cancelled> {
        let options = IrradianceOptions {
            patches: self.effort.choose(24_000, 6_000),
            rays: self.effort.choose(96, 48),
        };
        let irradiance = Irradiance::solve(&self.transport(bounces, 1), options, progress)?;
        let light = self.transport(bounces, 2).with_irradiance(Arc::new(irradiance));
        let focus = self.focus();
        let options = BakeOptions::for_focus(&self.tracer, &self.camera, &focus);
        picture_of(bake(&self.tracer, &light, &self.camera, &options, progress)?, &focus, progress)
    }
}

/// The largest value; NaN if any is NaN.
fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .copied()
        .reduce(|most, value| if most < value || value.is_nan() { value } else { most })
        .unwrap_or(f64::NAN)
}

/// The largest radiance of a picture; NaN if any is NaN.
fn brightest(picture: &Picture) -> f64 {
    worst(picture.radiance.iter().flatten().map(|&value| f64::from(value)))
}

/// Peak signal-to-noise ratio of linear radiances clipped to [0, 1] from the ground truth, dB; infinite if the error is below
/// the noise. The product of the distances from two independent estimates of the truth is free of their noise.
fn psnr(picture: &Picture, truths: &[Picture; 2]) -> f64 {
    let numbers = |picture: &Picture| {
        picture
            .radiance
            .iter()
            .flatten()
            .map(|&v| if v > 1.0 { 1.0 } else { f64::from(v) })
            .collect::<Vec<_>>()
    };
    let [picture, one, other] = [picture, &truths[0], &truths[1]].map(numbers);
    let products: f64 = picture.iter().zip(one.iter().zip(&other)).map(|(p, (a, b))| (p - a) * (p - b)).sum();
    let mean_square = products / picture.len() as f64;
    if mean_square < 0.0 { f64::INFINITY } else { -10.0 * mean_square.log10() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_picture_is_not_near_the_truth() {
        let [truth, mut refused] = [Picture::black(2, 1), Picture::black(2, 1)];
        let truths = [truth.clone(), truth.clone()];
        assert_eq!(psnr(&truth, &truths), f64::INFINITY);
        refused.radiance[1] = [f32::NAN; 3];
        assert!(psnr(&refused, &truths).is_nan() && brightest(&refused).is_nan());
        assert!(largest(&[1.0, f64::NAN, 2.0]).is_nan() && largest(&[f64::NAN, 1.0]).is_nan());
        assert_eq!(largest(&[-3.0, -1.0, -2.0]), -1.0);
    }
}
