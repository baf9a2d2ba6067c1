//! Dynamic range: very bright beside very dim, very many samples on one pixel, and blur wider than the picture.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::light_field::{offset_of, picture_of_stars, star};
use crate::support::measure::{energy, farthest_from, worst};
use crate::support::shot::Shot;
use glam::{DVec2, DVec3};
use lens::{Camera, Exposure, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use std::f64::consts::{PI, SQRT_2};
use test_scenes::{Mesh, Random, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "1e6 fireflies next to 1e-3 walls",
        reason: "Sums are integers: pixels that the light of the firefly does not reach have the same bits \
                 without it.",
        control: "running sums in f32",
        check: fireflies,
    },
    Case {
        name: "1e4 dim samples on one pixel",
        reason: "Each contribution to a pixel is rounded up or down to a quantum, so that at most one quantum \
                 (2⁻²²) per sample and pixel is lost.",
        control: "quanta of 2⁻¹²",
        check: dim_samples,
    },
    Case {
        name: "circle of confusion wider than the picture",
        reason: "Light from outside the frame replaces the light that leaves it, and a normalised white scene \
                 stays white, however wide the blur.",
        control: "no light from outside the frame",
        check: wide_blur,
    },
];

/// Quantum of the splat's integer sums.
const STEP: f64 = splat::QUANTUM;

const FIREFLY: f32 = 1e6;
const WALL: f32 = 1e-3;

fn camera(width: u32, height: u32) -> Camera {
    Camera { width, height, yfov: 0.6, aperture_radius: 0.1, focus_distance: 3.0, ..Camera::default() }
}

fn fireflies(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let camera = camera(72, 48);
    let per_kappa = camera.optics().splat_radius_px(1.0);
    let middle = DVec2::new(36.0, 24.0);
    let reaches = |k: usize, radius: f64| {
        let pixel = DVec2::new((k % 72) as f64, (k / 72) as f64) + 0.5;
        (pixel - middle).abs().max_element() <= radius + 2.0
    };
    let largest_beyond = |with: &Picture, without: &Picture, radius: f64| {
        let pairs = with.radiance.iter().zip(&without.radiance).enumerate();
        worst(pairs.filter(|(k, _)| !reaches(*k, radius)).map(|(_, (a, b))| f64::from(a[0] - b[0])))
    };
    let (mut splatted, mut traced) = (Vec::new(), Vec::new());
    for radius in [-9.0, 0.0, 0.4, 9.0] {
        // Splatted: a pixel of the wall is the firefly.
        let stars = |firefly: f32| {
            let radiance = |k: u32| {
                let center = DVec2::new(f64::from(k % 72) + 0.5, f64::from(k / 72) + 0.5);
                star(center, 0.5, if k == 24 * 72 + 36 { firefly } else { WALL })
            };
            picture_of_stars(
                &camera,
                (0..72 * 48).map(radiance).collect(),
                offset_of(radius / per_kappa, &camera),
                progress,
            )
        };
        splatted.push(largest_beyond(&stars(FIREFLY)?, &stars(WALL)?, f64::abs(radius)));
        // Traced: a lamp with the size of a pixel on the wall.
        let z = 3.0;
        let px = z * camera.optics().tan_half_yfov / camera.optics().half_height_px;
        let lamp = Mesh::rectangle(DVec3::new(0.0, -px, -z), DVec3::X * px, DVec3::Y * px);
        let wall = Mesh::wall(z, 5.0);
        let shot =
            |light: f32| Shot::new(unlit_scene_of([(&lamp, [light; 3]), (&wall, [WALL; 3])]), camera.clone());
        let offset = offset_of(radius / per_kappa, &camera);
        let samples = effort.choose(16, 4);
        let with = shot(FIREFLY).truth(offset, samples, progress)?;
        traced.push(largest_beyond(&with, &shot(WALL).truth(offset, samples, progress)?, f64::abs(radius)));
    }
    // A row of the wall with a firefly spread over 18² px in its centre, as running sums of differences in f32.
    let spread = FIREFLY / (18.0 * 18.0);
    let differences = [WALL, spread, -spread];
    let after = differences.iter().sum::<f32>();
    let expected = "not a bit changes beyond its reach, splatted and traced, radii 0 to 9 px";
    let limits = [("splat", 0.0), ("truth", 0.0)];
    Ok(Verdict::new(
        expected,
        limits,
        [worst(splatted), worst(traced)],
        [f64::from((after - WALL).abs()), NOT_COMPUTED],
    ))
}

fn dim_samples(_: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    const COUNT: usize = 10_000;
    let camera = camera(65, 65);
    let mut random = Random(9);
    let half = 0.5 / (COUNT as f64).sqrt();
    let places: Vec<_> = (0..COUNT)
        .map(|_| 32.0 + half + (1.0 - 2.0 * half) * DVec2::new(random.unit(), random.unit()))
        .collect();
    let (mut errors, mut shares) = (Vec::new(), Vec::new());
    for radius in [0.0, 0.3, 3.0, 12.0] {
        let samples = places.iter().map(|&place| star(place, half, 1.0)).collect();
        let offset = offset_of(radius / camera.optics().splat_radius_px(1.0), &camera);
        errors.push(energy(&picture_of_stars(&camera, samples, offset, progress)?) - 1.0);
        // The disc, enlarged by the diagonal of a pixel, contains all pixels that it touches.
        let pixels = PI * (radius + SQRT_2).powi(2);
        shares.push(errors[errors.len() - 1] / (STEP * pixels * COUNT as f64));
    }
    let coarse = |mass: f64| (mass * 4096.0).round() / 4096.0;
    let rounded = COUNT as f64 * coarse(1.0 / COUNT as f64) - 1.0;
    let expected = "mass 1 to a quantum a sample and pixel, sharp and spread over up to 450 px";
    let limits = [("error", 0.01), ("of quanta", 1.0)];
    let most = STEP * COUNT as f64;
    Ok(Verdict::new(expected, limits, [worst(errors), worst(shares)], [rounded.abs(), rounded.abs() / most]))
}

fn wide_blur(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let (width, height) = effort.choose((40, 30), (20, 15));
    let camera = camera(width, height);
    let shot = Shot::new(unlit_scene_of([(&Mesh::wall(3.0, 200.0), [1.0; 3])]), camera.clone());
    let offset = |heights: f64| {
        let kappa = camera.optics().kappa_for_circle_px(heights * f64::from(height)).unwrap_or(0.0);
        offset_of(kappa, &camera)
    };
    let (mut splatted, mut traced) = (Vec::new(), Vec::new());
    for heights in [-2.5, 1.2, 2.5] {
        splatted.push(farthest_from(&shot.splat(offset(heights), progress)?, 1.0));
        traced.push(farthest_from(&shot.truth(offset(heights), 16, progress)?, 1.0));
    }
    let mut normalised = Vec::new();
    for heights in [5.0, 40.0] {
        let picture = shot.splat(offset(heights), progress)?;
        let white = picture.exposed(Exposure::Normalise);
        normalised.push(farthest_from(&Picture { radiance: white, ..picture }, 1.0));
    }
    // Baked for the unpainted picture only.
    let framed = shot.salf(FocusOffset::SHARP, progress)?;
    let wide = shot.focus(offset(2.5));
    let without = farthest_from(&crate::support::shot::picture_of(framed, &wide, progress)?, 1.0);
    let limits = [("splat", 1e-3), ("truth", 1e-3), ("normalised", 1e-5)];
    let expected = "1 ± 0.1 % up to 2.5 picture heights; normalised 1 at 40";
    let right = [worst(splatted), worst(traced), worst(normalised)];
    Ok(Verdict::new(expected, limits, right, [without, NOT_COMPUTED, NOT_COMPUTED]))
}
