//! The character of a lens: sums stay exact, and discs have the light of the formula.

use super::*;
use lens::{Character, Rim};

fn with(character: Character) -> Camera {
    Camera { character, ..camera() }
}

fn everything() -> Character {
    Character {
        widest_radius: Some(0.06),
        field_curvature: 0.05,
        longitudinal_colour: [3e-4, -5e-4],
        lateral_colour: [0.01, -0.02],
        edges: 0.9,
        rims: [Some(Rim { radius: 0.055, distance: 0.15 }), Some(Rim { radius: 0.06, distance: -0.1 })],
        has_cos4_falloff: true,
    }
}

fn rendered_with(character: Character, focus: &ByTriangle) -> Splatter {
    let mut splatter = Splatter::new(light_field());
    splatter.render(&with(character), focus, &Unwatched).unwrap();
    splatter
}

#[test]
fn dabs_take_away_exactly_what_was_added() {
    let plain = rendered(&standard());
    for character in [
        Character { rims: everything().rims, ..Character::default() },
        Character { edges: -1.0, ..Character::default() },
        everything(),
    ] {
        let mut focus = standard();
        let mut splatter = rendered_with(character, &focus);
        assert_ne!(splatter.picture(), plain.picture(), "the character shows");
        for round in 0..6u32 {
            let changed: Vec<u32> = (0..300).map(|k| (round * 977 + k * 13) % (96 * 80)).collect();
            for &index in &changed {
                let t = 0.9 + (index % 21) as f64 * 0.01 * round as f64;
                let painted = FocusOffset::new(t, (round % 3) as f64 / 2.0);
                focus.0[index as usize] = if round == 4 { FocusOffset::STANDARD } else { painted };
            }
            splatter.update(&focus, &changed).unwrap();
        }
        let fresh = rendered_with(character, &focus);
        assert!(splatter.sums == fresh.sums, "the accumulators");
        assert_eq!(splatter.picture(), fresh.picture());
        // Another lens, and this one again.
        splatter.refocus(&camera(), &Unwatched).unwrap();
        assert_eq!(splatter.picture(), rendered(&focus).picture(), "without character nothing is left of it");
        splatter.refocus(&with(character), &Unwatched).unwrap();
        assert_eq!(splatter.picture(), fresh.picture());
    }
}

/// A wall of radiance 1 at one depth.
fn wall(inverse_depth: f32) -> Arc<Salf> {
    let flat = |sample: &mut Sample| {
        (sample.inverse_depth, sample.radiance, sample.tilt) = (inverse_depth, Vec3::ONE, Vec2::ZERO);
        (sample.visibility, sample.is_carried) = (Visibility::Open, false);
    };
    let salf = Salf::clone(&light_field());
    Arc::new(Salf { samples: salf.samples.changed(flat), ..salf })
}

#[test]
fn a_white_wall_is_as_dark_as_the_falloff() {
    let character = Character { rims: everything().rims, ..Character::default() };
    let camera = with(character);
    let falloff = camera.falloff().unwrap();
    let mut darkest = 1.0f32;
    // In focus, and radii of 6 and of 1 px. Images of a pixel are boxes with the moments of what the rims leave: their light is a fourteenth off
    // where two thirds of the aperture are cut.
    for (inverse_depth, tolerance) in [(0.5, [0.01, 0.015]), (1.2, [0.011, 0.02]), (0.385, [0.04, 0.075])] {
        let mut splatter = Splatter::new(wall(inverse_depth));
        splatter.render(&camera, &standard(), &Unwatched).unwrap();
        let picture = splatter.picture();
        for (k, rgb) in picture.radiance.iter().enumerate() {
            let (x, y) = (k % 96, k / 96);
            // Nothing lies outside of the frame.
            if (10..86).contains(&x) && (10..70).contains(&y) {
                let place = DVec2::new(x as f64, y as f64) + 0.5;
                let expected = falloff.at(camera.q_from_pixel(place));
                darkest = darkest.min(expected);
                let [light, coverage] = [(rgb[1] - expected).abs(), (picture.coverage[k] - 1.0).abs()];
                assert!(light < tolerance[0], "{inverse_depth} {x} {y}: {rgb:?} {expected}");
                assert!(coverage < tolerance[1], "{inverse_depth} {x} {y}: {}", picture.coverage[k]);
            }
        }
    }
    assert!(darkest < 0.85, "the control: it is darker somewhere: {darkest}");
}

#[test]
fn colours_lie_where_the_lens_sends_them() {
    let lateral = [0.02, -0.03];
    let camera = with(Character { lateral_colour: lateral, ..Character::default() });
    let lone = |sample: &mut Sample| {
        let is_lit = sample.surface.is_some_and(|point| point.triangle == 20 * 96 + 80);
        (sample.radiance, sample.tilt) = (if is_lit { Vec3::ONE } else { Vec3::ZERO }, Vec2::ZERO);
        (sample.inverse_depth, sample.visibility, sample.is_carried) = (0.8, Visibility::Open, false);
    };
    let salf = Salf::clone(&light_field());
    let salf = Arc::new(Salf { samples: salf.samples.changed(lone), ..salf });
    let mut splatter = Splatter::new(salf);
    splatter.render(&camera, &standard(), &Unwatched).unwrap();
    let picture = splatter.picture();
    for (c, m) in [lateral[0], 0.0, lateral[1]].into_iter().enumerate() {
        let (mut light, mut mean) = (0.0, DVec2::ZERO);
        for (k, rgb) in picture.radiance.iter().enumerate() {
            light += f64::from(rgb[c]);
            mean += f64::from(rgb[c]) * (DVec2::new((k % 96) as f64, (k / 96) as f64) + 0.5);
        }
        let axis = DVec2::new(48.0, 40.0);
        let expected = axis + (DVec2::new(80.5, 20.5) - axis) * (1.0 + m);
        assert!((mean / light).distance(expected) < 0.05, "{c}: {} {expected}", mean / light);
        assert!((light - 1.0).abs() < 0.01, "{c}: {light}");
    }
}
