//! The character of a lens, ray by ray: against closed forms, and the two estimators against each other.

use super::agreement::{SHARE_OF_FEW, both, focuses, share_in_agreement, small, stage};
use super::*;
use lens::{Character, Exposure, Rim};

fn everything() -> Character {
    Character {
        widest_radius: None,
        field_curvature: 0.02,
        longitudinal_colour: [4e-4, -6e-4],
        lateral_colour: [0.01, -0.015],
        edges: 0.8,
        rims: [Some(Rim { radius: 0.14, distance: 0.35 }), Some(Rim { radius: 0.16, distance: -0.25 })],
        has_cos4_falloff: true,
    }
}

fn of(character: Character) -> Camera {
    Camera { character, ..camera() }
}

/// The picture of one channel, in all three.
fn channel(picture: &Picture, c: usize) -> Picture {
    Picture { radiance: picture.radiance.iter().map(|rgb| [rgb[c]; 3]).collect(), ..picture.clone() }
}

#[test]
fn both_estimators_agree_on_a_lens_of_character() {
    let scene = stage();
    for (name, focus) in focuses() {
        let (camera, options) = small(128);
        let camera = Camera { character: everything(), ..camera };
        let [a, b] = both(&scene, &focus, &camera, options);
        let share = share_in_agreement(&a, &b);
        assert!(share >= SHARE_OF_FEW, "{name}: {share}");
        assert!(a.picture.colour_coverage.is_some());
        // The control: another lens is told apart.
        let other = Character { edges: -0.8, ..everything() };
        let [_, c] = both(&scene, &focus, &Camera { character: other, ..camera }, options);
        let share = share_in_agreement(&a, &c);
        assert!(share < 0.99, "{name}: {share}");
    }
}

#[test]
fn a_white_room_is_as_dark_as_the_falloff() {
    let room = scene_of([(Mesh::sphere(DVec3::new(0.1, 0.2, -0.3), 5.0, 16), white())]);
    let rims = [Some(Rim { radius: 0.16, distance: 0.4 }), None];
    let camera = Camera {
        width: 60,
        height: 40,
        ..of(Character { rims, has_cos4_falloff: true, ..Character::default() })
    };
    let picture = picture(room, &camera, FocusOffset::STANDARD, 256);
    let vignetting = camera.vignetting().unwrap();
    let mut darkest = 1.0f32;
    for exposure in [Exposure::Conserve, Exposure::Normalise] {
        for (k, rgb) in picture.exposed(exposure).iter().enumerate() {
            let pixel = DVec2::new((k % 60) as f64, (k / 60) as f64) + 0.5;
            let at = vignetting.at(camera.q_from_pixel(pixel));
            let expected = at.rims * at.angle;
            darkest = darkest.min(expected);
            // 256 rays, of which a share passes.
            assert!((rgb[0] - expected).abs() < 0.03, "{exposure:?} {pixel}: {rgb:?}, {expected}");
        }
    }
    assert!(darkest < 0.6, "the corner is darker: {darkest}");
}

#[test]
fn colours_have_discs_of_their_own() {
    let z = 1.5;
    let colours = Character { longitudinal_colour: [2e-3, -3e-3], ..Character::default() };
    let camera = of(colours);
    let optics = camera.optics();
    for focus in [FocusOffset::STANDARD, FocusOffset::SHARP] {
        let picture = picture(spot(&camera, z), &camera, focus, 256);
        let mut radii = [0.0; 3];
        for (c, shift) in [2e-3, 0.0, -3e-3].into_iter().enumerate() {
            let d = optics.image_distance;
            let kappa = optics.kappa(1.0 / z, focus) + 1.0 / (d + shift) - 1.0 / d;
            let disc = optics.splat_radius_px(kappa);
            let expected = (disc.powi(2) + (SPOT_PX.powi(2) + 1.0) / 3.0).sqrt();
            let (energy, _, radius) = moments(&channel(&picture, c));
            assert!((radius - expected).abs() < 0.1, "{focus:?} {c}: {radius} px, expected {expected}");
            assert!((energy / SPOT_PX.powi(2) - 1.0).abs() < 0.02, "{focus:?} {c}: {energy}");
            radii[c] = radius;
        }
        assert!((radii[0] - radii[2]).abs() > 0.5, "the check tells colours apart: {radii:?}");
    }
}

#[test]
fn the_corner_shifts_by_the_lateral_colour() {
    let camera = of(Character { lateral_colour: [0.02, -0.01], ..Character::default() });
    let (z, unit) = (3.0, camera.optics().tan_half_yfov * 3.0 / camera.optics().half_height_px);
    let corner = DVec3::new(40.0 * unit, 30.0 * unit, -z);
    let half = DVec3::new(4.0 * unit, 4.0 * unit, 0.0);
    let spot = Mesh::rectangle(corner - half, DVec3::X * 8.0 * unit, DVec3::Y * 8.0 * unit);
    let picture = picture(scene_of([(spot, white())]), &camera, FocusOffset::STANDARD, 256);
    for (c, m) in [0.02, 0.0, -0.01].into_iter().enumerate() {
        let (_, mean, _) = moments(&channel(&picture, c));
        let expected = DVec2::new(40.0, 30.0) * (1.0 + m);
        assert!(mean.distance(expected) < 0.05, "{c}: {mean}, {expected}");
    }
}

#[test]
fn rims_of_discs_change_sides_and_keep_their_energy() {
    for (edges, z) in [(1.0, 1.5), (1.0, 40.0), (-1.0, 1.5), (-1.0, 40.0)] {
        let camera = of(Character { edges, ..Character::default() });
        let optics = camera.optics();
        let kappa = optics.standard_kappa(1.0 / z);
        let (energy, _, radius) = moments(&picture(spot(&camera, z), &camera, FocusOffset::STANDARD, 256));
        // The second moment of W = 1 ± (2u² − 1) over the disc, in place of r²/2: r²·(1/2 ± 1/6).
        let sign = (edges * kappa).signum();
        let disc = optics.splat_radius_px(kappa).powi(2) * (1.0 + sign / 3.0);
        let expected = (disc + (SPOT_PX.powi(2) + 1.0) / 3.0).sqrt();
        assert!((radius - expected).abs() < 0.15, "{edges} at {z}: {radius} px, expected {expected}");
        assert!((energy / SPOT_PX.powi(2) - 1.0).abs() < 0.02, "{edges} at {z}: {energy}");
    }
}

#[test]
fn a_curved_field_blurs_the_corner_and_not_what_is_anchored() {
    let curvature = 0.1;
    let camera = of(Character { field_curvature: curvature, ..Character::default() });
    let optics = camera.optics();
    let unit = optics.tan_half_yfov * 3.0 / optics.half_height_px;
    const SIDE: f64 = 2.0;
    let spot = |x: f64| {
        let corner = DVec3::new((x - SIDE / 2.0) * unit, -SIDE / 2.0 * unit, -3.0);
        scene_of([(Mesh::rectangle(corner, DVec3::X * SIDE * unit, DVec3::Y * SIDE * unit), white())])
    };
    for x in [0.0, 40.0] {
        for (focus, is_curved) in [(FocusOffset::STANDARD, true), (FocusOffset::SHARP, false)] {
            let (_, mean, radius) = moments(&picture(spot(x), &camera, focus, 256));
            // A flat lens that is focused where the curved one is at that place.
            let more = if is_curved { curvature * (x / 64.0).powi(2) } else { 0.0 };
            let character = Character::default();
            let flat = Camera { focus_distance: 1.0 / (1.0 / 3.0 + more), character, ..camera.clone() };
            let (_, _, expected) = moments(&picture(spot(x), &flat, focus, 256));
            assert!((radius - expected).abs() < 0.1, "{x} {focus:?}: {radius} px, expected {expected}");
            assert!(more == 0.0 || expected > 1.3, "the control: it is blurred there: {expected}");
            assert!((mean - DVec2::X * x).length() < 0.3, "{x} {focus:?}: {mean}");
        }
    }
}
