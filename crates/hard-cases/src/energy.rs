//! Light is neither made nor lost.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::light_field::{offset_of, picture_of_stars, star};
use crate::measure::{energies, energy, worst};
use crate::random::Random;
use crate::scenery::{Mesh, scene_of};
use crate::shot::{Shot, picture_by, picture_of};
use glam::{DVec2, DVec3};
use lens::{Camera, Exposure, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{Salf, Sample, Visibility};
use scene::{SurfaceField, SurfacePoint};
use splat::Splatter;
use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;
use trace::Ray;

pub const CASES: &[Case] = &[
    Case {
        name: "energy: picture + outside = input",
        reason: "What a frame cuts off is what an over-wide frame has beyond it, bit for bit, and all of it is the input, but \
                 for the rounding of each of a splat's pixels to a quantum of 2⁻²².",
        control: "mass of the rays that land in the frame, taken for all",
        check: inside_and_outside,
    },
    Case {
        name: "energy: the sum does not depend on t",
        reason: "Paint moves light and makes none: over a frame wide enough the sum of each colour stays. So it does where nothing \
                 is painted, though that picture's coverage is evened out.",
        control: "the normalised picture, whose sum is not energy",
        check: invariant_to_paint,
    },
    Case {
        name: "energy: behind an occluder",
        reason: "What an occluder takes is the same for every t. Where nothing is painted, samples that it hides in part share what \
                 open ones leave, and what that takes from each colour is given back.",
        control: "nothing given back: the picture all but unpainted, divided by its coverage; every sample taken to see the \
                  whole aperture",
        check: behind_an_occluder,
    },
    Case {
        name: "energy: cards just behind one another",
        reason: "Steps of depth far smaller than a pixel's parallax against infinity reveal, along all their length, a part of what \
                 lies behind: as much light as they hide.",
        control: "only what the aperture's centre sees, partly hidden as it is",
        check: just_behind_one_another,
    },
    Case {
        name: "energy: a part of the scene is painted",
        reason: "So it is where paint takes some of the half hidden samples from those that share what open ones leave: the rest \
                 share otherwise, but what they lose is given back.",
        control: "the live picture, in which paint changes what it moves and nothing else",
        check: partly_painted,
    },
];

/// The step of the splat's sums.
const STEP: f64 = splat::QUANTUM;

fn inside_and_outside(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    const FRAME: u32 = 33;
    const BORDER: u32 = 48;
    let camera = |side: u32| Camera { width: side, height: side, aperture_radius: 0.1, ..Camera::default() };
    let (small, wide) = (camera(FRAME), camera(FRAME + 2 * BORDER));
    let count = effort.choose(400, 60);
    let mut random = Random(11);
    // On a grid that f32 holds exactly in either frame.
    let mut coordinate = || (random.unit() * f64::from(FRAME) * 256.0).floor() / 256.0;
    let places: Vec<_> = (0..count).map(|_| DVec2::new(coordinate(), coordinate())).collect();
    let (mut crop, mut lost, mut shares, mut cut) = (Vec::new(), Vec::new(), Vec::new(), f64::INFINITY);
    for radius in [-30.0, -3.0, 0.7, 11.0, 40.0] {
        let crop_energy = |camera: &Camera, shift: f64| {
            let samples = places.iter().map(|&place| star(place + shift, 0.5, 1.0)).collect();
            // The same radius in px in both.
            let offset = offset_of(radius / camera.optics().splat_radius_px(1.0), camera);
            picture_of_stars(camera, samples, offset, progress)
        };
        let (inner, outer) = (crop_energy(&small, 0.0)?, crop_energy(&wide, f64::from(BORDER))?);
        crop.push(difference_to_crop(&inner, &outer, BORDER as usize));
        let lost_by_splat = (energy(&outer) - f64::from(count)) / f64::from(count);
        lost.push(lost_by_splat);
        // The disc, grown by a pixel's diagonal, holds all the pixels that it touches.
        shares.push(lost_by_splat / (STEP * PI * (f64::abs(radius) + SQRT_2).powi(2)));
        cut = cut.min((energy(&inner) - f64::from(count)).abs() / f64::from(count));
    }
    let limits = [("frame", 0.0), ("lost", 1e-5), ("quanta a splat and pixel", 1.0)];
    let expected = "the frame is a crop of the over-wide one, bit for bit; its sum the input's to 1e-5 and to a quantum \
                    a splat and pixel";
    Ok(Verdict::new(
        expected,
        limits,
        [worst(crop), worst(lost), worst(shares)],
        [NOT_COMPUTED, cut, cut / STEP],
    ))
}

/// The largest difference between a picture and the middle of a wider one.
fn difference_to_crop(inner: &Picture, outer: &Picture, border: usize) -> f64 {
    let (width, outer_width) = (inner.width as usize, outer.width as usize);
    worst((0..inner.radiance.len()).map(|k| {
        let (x, y) = (k % width + border, k / width + border);
        f64::from(inner.radiance[k][1] - outer.radiance[y * outer_width + x][1])
    }))
}

/// Two squares before a black background, the nearer one at `near_x`: 0 hides part of the farther one.
fn squares(effort: Effort, near_x: f64) -> Shot {
    let side = effort.choose(160, 96);
    let camera = Camera {
        width: side,
        height: side,
        yfov: 1.2,
        focus_distance: 3.0,
        aperture_radius: 0.15,
        sensor_height: 0.2,
        ..Camera::default()
    };
    let near = Mesh::rectangle(DVec3::new(near_x, -0.1, -2.0), DVec3::X * 0.3, DVec3::new(0.0, 0.3, -0.2));
    let far = Mesh::rectangle(DVec3::new(-0.3, -0.4, -4.0), DVec3::X * 0.9, DVec3::Y * 0.6);
    Shot::new(scene_of([(&near, [0.5, 0.8, 0.2]), (&far, [0.9, 0.3, 0.4])]), camera)
}

/// Paint that moves light about; the last is none.
const OFFSETS: [FocusOffset; 5] = [
    FocusOffset::new(0.85, 1.0),
    FocusOffset::new(1.1, 0.0),
    FocusOffset::new(0.9, 0.5),
    FocusOffset::new(1.2, 1.0),
    FocusOffset::STANDARD,
];

/// How far sums of pictures differ, as a share of the largest: of the colour that differs most.
fn spread<'a>(pictures: impl IntoIterator<Item = &'a [f64; 3]> + Clone) -> f64 {
    worst((0..3).map(|c| {
        let sums = pictures.clone().into_iter().map(|sums| sums[c]);
        let (low, high) = sums.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), s| (l.min(s), h.max(s)));
        (high - low) / high
    }))
}

/// A picture's sums once it is divided by its coverage.
fn normalised(picture: Picture) -> [f64; 3] {
    energies(&Picture { radiance: picture.exposed(Exposure::Normalise), ..picture })
}

fn invariant_to_paint(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = squares(effort, -0.9);
    let (mut splatted, mut divided, mut traced) = (Vec::new(), Vec::new(), Vec::new());
    for offset in OFFSETS {
        let picture = shot.splat(offset, progress)?;
        splatted.push(energies(&picture));
        divided.push(normalised(picture));
        traced.push(energies(&shot.truth(offset, 16, progress)?));
    }
    // The traced sum's own uncertainty, from other random numbers.
    let mut others = Vec::new();
    for seed in 2..effort.choose(10, 6) {
        let unpainted = shot.focus(FocusOffset::STANDARD);
        others.push(energy(&shot.truth_with(&unpainted, 16, seed, progress)?));
    }
    let mean = others.iter().sum::<f64>() / others.len() as f64;
    let variance = others.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / (others.len() - 1) as f64;
    let deviations = spread(&traced) / (variance.sqrt() / mean);
    let limits = [("splat", 1e-4), ("truth, standard errors", 1.0)];
    let expected =
        "the same for every t and anchor, painted or not: to 0.01 % splatted, to a standard error traced";
    Ok(Verdict::new(expected, limits, [spread(&splatted), deviations], [spread(&divided), NOT_COMPUTED]))
}

fn behind_an_occluder(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = squares(effort, -0.15);
    let salf = shot.salf(OFFSETS[0], progress)?;
    let open = |sample: &mut Sample| sample.visibility = Visibility::Open;
    let blind = Salf { samples: salf.samples.changed(open), ..salf.clone() };
    let picture = |salf: &Salf, offset| picture_of(salf.clone(), &shot.focus(offset), progress);
    let sums = |salf: &Salf| -> Result<Vec<[f64; 3]>, Cancelled> {
        OFFSETS.iter().map(|&offset| Ok(energies(&picture(salf, offset)?))).collect()
    };
    let picture_normalised = normalised(picture(&salf, FocusOffset::new(1.0 + 1e-5, 0.0))?);
    let (sums, blind) = (sums(&salf)?, sums(&blind)?);
    let traced = energies(&shot.truth(FocusOffset::STANDARD, 64, progress)?);
    let relative = |sums: &[f64; 3]| worst((0..3).map(|c| sums[c] / traced[c] - 1.0));
    let limits = [("splat", 1e-4), ("against truth", 0.01)];
    let right = [spread(&sums), worst(sums.iter().map(relative))];
    let wrong =
        [spread(&[sums[0], picture_normalised]), blind.iter().map(relative).fold(f64::INFINITY, f64::min)];
    let expected = "each colour's sum the same for every t and anchor, painted or not, to 0.01 %; that of the truth to 1 %";
    Ok(Verdict::new(expected, limits, right, wrong))
}

/// Slanted cards of growing depth, fanned out: each hides most of the next one, less than a pixel of parallax behind, and
/// their outlines lie farther from each other than any parallax.
fn fan(effort: Effort) -> Shot {
    let side = effort.choose(240, 120);
    let camera = Camera {
        width: side,
        height: side,
        yfov: 1.2,
        focus_distance: 3.0,
        aperture_radius: 0.12,
        sensor_height: 0.2,
        ..Camera::default()
    };
    let cards: Vec<_> = (0..5u8)
        .map(|k| {
            let at = f64::from(k);
            let corner = DVec3::new(-1.2 + 0.35 * at, -0.7, -1.0 / (0.42 - 0.033 * at));
            let slant = 0.04 * (2.0 * at).sin();
            let card = Mesh::rectangle(corner, DVec3::new(1.0, 0.0, slant), DVec3::new(0.1, 1.4, 0.0));
            (card, [0.9, 0.4 + 0.1 * f32::from(k), 0.2])
        })
        .collect();
    Shot::new(scene_of(cards.iter().map(|(card, color)| (card, *color))), camera)
}

/// Whether the ray from the aperture's centre meets another surface before a sample.
fn is_hidden_from_center(shot: &Shot, sample: &Sample) -> bool {
    let Some(point) = sample.surface else { return false };
    let (scene, eye) = (shot.tracer.scene(), shot.camera.position());
    let direction = point.position(scene) - eye;
    let ray = Ray { origin: eye, direction, t_min: 0.0, t_max: 1.0 - 1e-9, skip: Some(point.triangle) };
    shot.tracer.first_hit(&ray).is_some()
}

fn just_behind_one_another(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = fan(effort);
    let salf = shot.salf(OFFSETS[0], progress)?;
    let unoccluded = salf.samples.iter().filter(|sample| !is_hidden_from_center(&shot, sample));
    let central = Salf { samples: unoccluded.collect(), ..salf.clone() };
    let sums = |salf: &Salf| -> Result<Vec<[f64; 3]>, Cancelled> {
        let sum = |&offset| Ok(energies(&picture_of(salf.clone(), &shot.focus(offset), progress)?));
        OFFSETS.iter().map(sum).collect()
    };
    let (sums, central) = (sums(&salf)?, sums(&central)?);
    let traced = energies(&shot.truth(FocusOffset::STANDARD, effort.choose(256, 64), progress)?);
    let limits = [("splat", 1e-4), ("against truth", effort.choose(1e-3, 1.5e-3))];
    let errors = |sums: &[[f64; 3]]| {
        let relative = |sums: &[f64; 3]| worst((0..3).map(|c| sums[c] / traced[c] - 1.0));
        [spread(sums), worst(sums.iter().map(relative))]
    };
    let expected = "each colour's sum the same for every t and anchor, painted or not, to 0.01 %; that of the truth to 0.1 % (with \
                    few pixels: 0.15 %)";
    Ok(Verdict::new(expected, limits, errors(&sums), errors(&central)))
}

/// Slanted cards in disorder that hide each other.
fn heap(effort: Effort) -> Shot {
    let side = effort.choose(160, 120);
    let camera = Camera {
        width: side,
        height: side,
        yfov: 1.2,
        focus_distance: 3.0,
        aperture_radius: 0.12,
        sensor_height: 0.2,
        ..Camera::default()
    };
    let mut random = Random(4);
    let mut card = || {
        let [at, across, color] = [(); 3].map(|()| random.in_cube());
        let depth = 4.0 + 1.8 * at.z;
        let middle = DVec3::new(0.3 * depth * at.x, 0.3 * depth * at.y, -depth);
        let across = DVec3::new(0.9, 0.0, 0.4 * across.x);
        let down = DVec3::new(0.0, 0.9, 0.4 * across.y);
        let card = Mesh::rectangle(middle - (across + down) / 2.0, across, down);
        (card, (0.5 + 0.4 * color).as_vec3().to_array())
    };
    let cards: Vec<_> = (0..24).map(|_| card()).collect();
    Shot::new(scene_of(cards.iter().map(|(card, color)| (card, *color))), camera)
}

/// Every other rectangle of a scene of rectangles is painted.
struct EveryOther(FocusOffset);

impl SurfaceField<FocusOffset> for EveryOther {
    fn at(&self, point: SurfacePoint) -> FocusOffset {
        if (point.triangle / 2).is_multiple_of(2) { self.0 } else { FocusOffset::STANDARD }
    }

    fn at_infinity(&self) -> FocusOffset {
        FocusOffset::STANDARD
    }
}

fn partly_painted(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = heap(effort);
    let salf = Arc::new(shot.salf(OFFSETS[0], progress)?);
    let sums = |is_live: bool| -> Result<Vec<[f64; 3]>, Cancelled> {
        let sum = |&offset| {
            let mut splatter = Splatter::new(salf.clone());
            splatter.set_live(is_live);
            Ok(energies(&picture_by(splatter, &EveryOther(offset), progress)?))
        };
        OFFSETS.iter().map(sum).collect()
    };
    let expected = "each colour's sum the same for every t and anchor of the paint, or none, to 0.002 %";
    Ok(Verdict::new(expected, [("splat", 2e-5)], [spread(&sums(false)?)], [spread(&sums(true)?)]))
}
