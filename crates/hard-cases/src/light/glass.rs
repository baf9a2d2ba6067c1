//! Transmission: Beer's law, nested bodies, and total reflection beyond the critical angle.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::measure::worst;
use glam::{DVec2, DVec3, Vec3, Vec4};
use material::{Bsdf, Frame, Interface, Surface};
use progress::{Cancelled, Progress};
use scene::{Material, Scalar, SurfacePoint, Volume, Workflow, World};
use slf::{Transport, TransportOptions};
use std::sync::Arc;
use test_scenes::{Mesh, Random, scene_of};
use trace::{Radiance, Tracer};

pub const CASES: &[Case] = &[
    Case {
        name: "Beer's law through a slab",
        reason: "A slab without an interface transmits color^(thickness/distance) of the light.",
        control: "half the thickness",
        check: beer,
    },
    Case {
        name: "a body within another of its kind",
        reason: "Between equal media nothing is reflected: the inner body only absorbs its own colour.",
        control: "an inner body with another index of refraction",
        check: nested,
    },
    Case {
        name: "total reflection",
        reason: "Beyond the critical angle all light stays inside: every sampled direction is the mirror \
                 direction, with weight 1.",
        control: "an eye just within the critical angle",
        check: total_reflection,
    },
];

fn glass(ior: f32, color: Vec3, distance: f64) -> Material {
    Material {
        transmission: Scalar::constant(1.0),
        workflow: Workflow::MetallicRoughness {
            metallic: Scalar::constant(0.0),
            roughness: Scalar::constant(0.0),
        },
        volume: Some(Volume { attenuation_color: color, attenuation_distance: distance }),
        ior,
        ..Material::default()
    }
}

/// Radiance straight up from a glowing floor through the slabs above it: bottom, top and material of each, the
/// topmost first.
fn through(slabs: &[(f64, f64, Material)], paths: u32) -> Vec3 {
    let flat = |height: f64| DVec3::new(9.0, height, 9.0);
    let bodies = slabs.iter().enumerate().map(|(k, (bottom, top, material))| {
        // No two slabs end at the same place.
        let inset = DVec3::new(1.0, 0.0, 1.0) * k as f64;
        (
            Mesh::cuboid(flat(*bottom) * DVec3::new(-1.0, 1.0, -1.0) + inset, flat(*top) - inset),
            material.clone(),
        )
    });
    let glow = Material { emissive: Vec3::ONE, base_color: Vec4::ZERO, ..Material::lambertian_white() };
    let floor = Mesh::rectangle(DVec3::new(-50.0, 0.0, 50.0), DVec3::X * 100.0, DVec3::Z * -100.0);
    let scene = scene_of(bodies.chain([(floor, glow)]));
    let options = TransportOptions { paths, ..TransportOptions::default() };
    let transport = Transport::new(Arc::new(Tracer::new(scene)), World::uniform(Vec3::ZERO), options);
    // The centre of the upper face of the first body.
    let point = SurfacePoint { triangle: 0, barycentric: DVec2::new(0.0, 0.5) };
    transport.total_outgoing(point, DVec3::new(0.0, 400.0, 0.0))
}

fn beer(_: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let color = Vec3::new(0.5, 0.25, 1.0);
    let off = |thickness: f64, optical_thickness: f64, distance: f64| {
        let transmitted = through(&[(1.0, 1.0 + thickness, glass(1.0, color, distance))], 16);
        f64::from((transmitted - color.powf((optical_thickness / distance) as f32)).abs().max_element())
    };
    let right = worst([off(0.5, 0.5, 1.0), off(2.0, 2.0, 0.5), off(1e-3, 1e-3, 1.0), off(5.0, 5.0, 1e-3)]);
    let limits = [("error", 1e-4)];
    Ok(Verdict::new("to 1e-4, half a distance to 5,000 thick", limits, [right], [off(1.0, 0.5, 1.0)]))
}

fn nested(effort: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let paths = effort.choose(1 << 15, 1 << 13);
    // At normal incidence both outer faces transmit (1 − r)/(1 + r), r = 0.04; red is absorbed over half a
    // unit of the inner body.
    let off = |inner: f32| {
        let outer = glass(1.5, Vec3::ONE, 1.0);
        let transmitted =
            through(&[(1.0, 3.0, outer), (1.5, 2.0, glass(inner, Vec3::new(0.5, 1.0, 1.0), 1.0))], paths);
        let clear = f64::from(transmitted.y) - 0.96 / 1.04;
        let red = f64::from(transmitted.x / transmitted.y) - 0.5f64.sqrt();
        [clear.abs(), red.abs()]
    };
    let limits = [("clear light", 6e-3), ("red", 6e-3)];
    Ok(Verdict::new("12 in 13 of the light, of red √½ of it, ± 0.006", limits, off(1.5), off(2.4)))
}

fn total_reflection(effort: Effort, _: &dyn Progress) -> Result<Verdict, Cancelled> {
    let surface =
        Surface { metallic: 0.0, roughness: 0.0, transmission: 1.0, is_thin: false, ..Surface::default() };
    // Inside glass with an index of 1.5: the sine of the critical angle is 2/3.
    let interface = Interface::between(1.5, 1.0);
    let bsdf = Bsdf::new(&surface, Frame::flat(DVec3::Z), &interface);
    let count = effort.choose(20_000, 2_000);
    let mut random = Random(5);
    let mut off = |sine: f64| {
        let outgoing = DVec3::new(sine, 0.0, (1.0 - sine * sine).sqrt());
        let mirrored = DVec3::new(-sine, 0.0, outgoing.z);
        worst((0..count).map(|_| match bsdf.sample(outgoing, random.three()) {
            Some(scattered) => {
                scattered.incident.distance(mirrored).max((scattered.weight.total().x - 1.0).abs())
            }
            None => f64::NAN,
        }))
    };
    let right = worst([2.0 / 3.0 + 1e-9, 0.7, 0.9, 0.999_999].map(&mut off));
    let wrong = off(2.0 / 3.0 - 1e-3);
    let limits = [("direction or weight", 1e-9), ("", f64::INFINITY)];
    Ok(Verdict::new(
        "the mirror's direction, weight 1, to 1e-9",
        limits,
        [right, NOT_COMPUTED],
        [wrong, NOT_COMPUTED],
    ))
}
