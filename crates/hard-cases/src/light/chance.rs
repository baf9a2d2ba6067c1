//! Light found by single paths must not appear as bokeh discs.

use crate::case::{Case, Effort, Verdict};
use crate::support::shot::picture_of;
use focus::Focus;
use glam::{DVec3, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{BakeOptions, bake};
use scene::SurfacePoint;
use test_scenes::{Mesh, unlit_scene_of};
use trace::{OutgoingRadiance, Radiance, Tracer};

pub const CASES: &[Case] = &[Case {
    name: "paths that find a lamp by chance",
    reason: "The excess of one sample over its neighbours is distributed to all of them, so that no disc \
             remains and no light is lost.",
    control: "light not marked as found by chance",
    check: discs,
}];

/// A wall of radiance 1 with a little noise; one point in `RARITY` emits `SPIKE` more, like a path that reaches
/// a lamp by way of two mirrors.
struct SparklingRadiance {
    reports_chance: bool,
}

const RARITY: f64 = 4e-4;
const SPIKE: f32 = 200.0;

/// A uniform pseudo-random number that depends on the point only.
fn hash(point: SurfacePoint) -> f64 {
    let bits = |value: f64| value.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(31);
    let seed = bits(point.barycentric.x) ^ bits(point.barycentric.y + 2.0) ^ u64::from(point.triangle) << 7;
    test_scenes::Random(seed).unit()
}

impl Radiance for SparklingRadiance {
    fn outgoing(&self, point: SurfacePoint, _eye: DVec3) -> OutgoingRadiance {
        let u = hash(point);
        let spike = if u < RARITY { SPIKE } else { 0.0 };
        let by_chance = Vec3::splat(0.2 + 0.1 * u as f32 + spike);
        let reported = if self.reports_chance { by_chance } else { Vec3::ZERO };
        OutgoingRadiance {
            own: Vec3::splat(0.8) + by_chance,
            noisy: [reported, Vec3::ZERO],
            ..OutgoingRadiance::default()
        }
    }

    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}

fn discs(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let (width, height) = effort.choose((192, 128), (96, 64));
    let camera =
        Camera { width, height, yfov: 0.6, aperture_radius: 0.04, focus_distance: 1.5, ..Camera::default() };
    let scene = unlit_scene_of([(&Mesh::wall(4.0, 9.0), [1.0; 3])]);
    let tracer = Tracer::new(scene.clone());
    let focus = Focus::constant(scene, FocusOffset::STANDARD);
    let picture = |reports_chance: bool| {
        let options = BakeOptions::for_focus(&tracer, &camera, &focus);
        let salf = bake(&tracer, &SparklingRadiance { reports_chance }, &camera, &options, progress)?;
        picture_of(salf, &focus, progress)
    };
    let [spread, left] = [picture(true)?, picture(false)?];
    let loss = |picture: &Picture| (mean(picture) / mean(&left) - 1.0).abs();
    // The mean of the control is right; its discs are wrong.
    let [right, wrong] = [&spread, &left].map(|picture| [brightest(picture), loss(picture)]);
    let limits = [("brightest, σ", 5.0), ("mean", 5e-3)];
    Ok(Verdict::new("no pixel beyond 5 σ of its picture's; mean kept to 0.5 %", limits, right, wrong))
}

fn mean(picture: &Picture) -> f64 {
    picture.radiance.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / picture.radiance.len() as f64
}

/// Distance of the brightest pixel from the mean, in standard deviations of the picture.
fn brightest(picture: &Picture) -> f64 {
    let mean = mean(picture);
    let off = || picture.radiance.iter().map(|pixel| f64::from(pixel[1]) - mean);
    let deviation = (off().map(|off| off * off).sum::<f64>() / picture.radiance.len() as f64).sqrt();
    off().fold(0.0, f64::max) / deviation
}
