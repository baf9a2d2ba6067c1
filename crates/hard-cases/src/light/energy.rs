//! Conservation of energy.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::light_field::{offset_of, picture_of_stars, star};
use crate::support::measure::{energies, energy, worst};
use crate::support::shot::{Shot, picture_by, picture_of};
use glam::{DVec2, DVec3};
use lens::{Camera, Exposure, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{Salf, Sample, Visibility};
use scene::{SurfaceField, SurfacePoint};
use splat::Splatter;
use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;
use test_scenes::{Mesh, Random, unlit_scene_of};
use trace::Ray;

pub const CASES: &[Case] = &[
    Case {
        name: "energy: picture + outside = input",
        reason: "The part cut off by a frame is what a wider frame has beyond it, bit for bit, and the total \
                 is the input, except for the rounding of each pixel of a splat to a quantum of 2⁻²².",
        control: "the mass of the rays inside the frame, taken as the total",
        check: inside_and_outside,
    },
    Case {
        name: "energy: the sum does not depend on t",
        reason: "Paint displaces light without creating any: over a sufficiently wide frame the sum of each \
                 colour is constant. The same holds without paint, although the coverage of that picture is \
                 normalised.",
        control: "the normalised picture, whose sum is not the energy",
        check: invariant_to_paint,
    },
    Case {
        name: "energy: behind an occluder",
        reason: "An occluder removes the same light for every t. Without paint, samples that are partly \
                 hidden share the coverage that open ones leave, and the light this removes from each colour \
                 is added back.",
        control: "no light added back: the picture with almost no paint, divided by its coverage; every \
                  sample treated as seeing the whole aperture",
        check: behind_an_occluder,
    },
    Case {
        name: "energy: cards just behind one another",
        reason: "Depth steps far smaller than the parallax of a pixel against infinity reveal, along their \
                 whole length, as much light from behind as they hide.",
        control: "only the samples visible from the centre of the aperture, with their partial occlusion",
        check: just_behind_one_another,
    },
    Case {
        name: "energy: a part of the scene is painted",
        reason: "The same holds if paint removes some of the partly hidden samples from those that share the \
                 coverage left by open ones: the others share it differently, but the light they lose is \
                 added back.",
        control: "the live picture, in which paint changes only the samples it displaces",
        check: partly_painted,
    },
];

/// Quantum of the splat's integer sums.
const STEP: f64 = splat::QUANTUM;

fn inside_and_outside(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    const FRAME: u32 = 33;
    const BORDER: u32 = 48;
    let camera = |side: u32| Camera { width: side, height: side, aperture_radius: 0.1, ..Camera::default() };
    let (small, wide) = (camera(FRAME), camera(FRAME + 2 * BORDER));
    let count = effort.choose(400, 60);
    let mut random = Random(11);
    // Coordinates that f32 represents exactly in both frames.
    let mut coordinate = || (random.unit() * f64::from(FRAME) * 256.0).floor() / 256.0;
    let places: Vec<_> = (0..count).map(|_| DVec2::new(coordinate(), coordinate())).collect();
    let (mut crop, mut lost, mut shares, mut cut) = (Vec::new(), Vec::new(), Vec::new(), f64::INFINITY);
    for radius in [-30.0, -3.0, 0.7, 11.0, 40.0] {
        let crop_energy = |camera: &Camera, shift: f64| {
            let samples = places.iter().map(|&place| star(place + shift, 0.5, 1.0)).collect();
            // The same radius in px for both.
            let offset = offset_of(radius / camera.optics().splat_radius_px(1.0), camera);
            picture_of_stars(camera, samples, offset, progress)
        };
        let (inner, outer) = (crop_energy(&small, 0.0)?, crop_energy(&wide, f64::from(BORDER))?);
        crop.push(difference_to_crop(&inner, &outer, BORDER as usize));
        let lost_by_splat = (energy(&outer) - f64::from(count)) / f64::from(count);
        lost.push(lost_by_splat);
        // The disc, enlarged by the diagonal of a pixel, contains all pixels that it touches.
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

/// The largest difference between a picture and the central crop of a wider one.
fn difference_to_crop(inner: &Picture, outer: &Picture, border: usize) -> f64 {
    let (width, outer_width) = (inner.width as usize, outer.width as usize);
    worst((0..inner.radiance.len()).map(|k| {
        let (x, y) = (k % width + border, k / width + border);
        f64::from(inner.radiance[k][1] - outer.radiance[y * outer_width + x][1])
    }))
}

/// Two squares in front of a black background, the nearer one at `near_x`; at 0 it hides a part of the
/// farther one.
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
    Shot::new(unlit_scene_of([(&near, [0.5, 0.8, 0.2]), (&far, [0.9, 0.3, 0.4])]), camera)
}

/// Paint that displaces light; the last one is unpainted.
const OFFSETS: [FocusOffset; 5] = [
    FocusOffset::new(0.85, 1.0),
    FocusOffset::new(1.1, 0.0),
    FocusOffset::new(0.9, 0.5),
    FocusOffset::new(1.2, 1.0),
    FocusOffset::STANDARD,
];

/// The relative difference of the sums of pictures, for the colour that differs most.
fn spread<'a>(pictures: impl IntoIterator<Item = &'a [f64; 3]> + Clone) -> f64 {
    worst((0..3).map(|c| {
        let sums = pictures.clone().into_iter().map(|sums| sums[c]);
        let (low, high) = sums.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), s| (l.min(s), h.max(s)));
        (high - low) / high
    }))
}

/// Sums of a picture divided by its coverage.
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
    // The uncertainty of the traced sum, from different random numbers.
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
    let expected = "each colour's sum the same for every t and anchor, painted or not, to 0.01 %; that of \
                    the truth to 1 %";
    Ok(Verdict::new(expected, limits, right, wrong))
}

/// Slanted cards of increasing depth, fanned out: each hides most of the next, which is less than a pixel of
/// parallax behind; their outlines are farther apart than any parallax.
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
    Shot::new(unlit_scene_of(cards.iter().map(|(card, color)| (card, *color))), camera)
}

/// Whether another surface occludes a sample from the centre of the aperture.
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

/// Slanted cards in random order that occlude each other.
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
    Shot::new(unlit_scene_of(cards.iter().map(|(card, color)| (card, *color))), camera)
}

/// A focus that paints every other rectangle of a scene of rectangles.
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
