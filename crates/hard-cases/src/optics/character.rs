//! The character of a lens: the splat against rays.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::psnr;
use crate::support::shot::Shot;
use glam::DVec3;
use lens::{Camera, Character, Exposure, FocusOffset, Picture, Rim};
use progress::{Cancelled, Progress};
use scene::Scene;
use std::sync::Arc;
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "lens character: field curvature",
        reason: "The plane of focus bends by C·|q₀|², for splat and rays alike.",
        control: "rays through a lens whose field curves the other way",
        check: |effort, progress| compare(curved(1.0), curved(-1.0), effort, progress),
    },
    Case {
        name: "lens character: cat's eye",
        reason: "Rims before and behind the aperture cut each point's disc where the real ray meets them, and the picture darkens by \
                 the falloff and by cos⁴.",
        control: "rays through a lens whose rims have changed places",
        check: |effort, progress| compare(cut(1.0), cut(-1.0), effort, progress),
    },
    Case {
        name: "lens character: edges",
        reason: "Rims of far discs are bright and those of near ones soft, or the other way round.",
        control: "rays through a lens of the opposite edges",
        check: |effort, progress| compare(weighed(1.0), weighed(-1.0), effort, progress),
    },
    Case {
        name: "lens character: colour fringes",
        reason: "Each colour has a focus and a size of its own.",
        control: "rays through a lens with red and blue exchanged",
        check: |effort, progress| compare(fringed(1.0), fringed(-1.0), effort, progress),
    },
    Case {
        name: "lens character: all together",
        reason: "What a lens does to a ray it does at once.",
        control: "rays through a lens of the opposite edges and colours",
        check: |effort, progress| compare(everything(1.0), everything(-1.0), effort, progress),
    },
];

fn curved(sign: f64) -> Character {
    Character { field_curvature: sign * 0.05, ..Character::default() }
}

fn cut(sign: f64) -> Character {
    let rim = |radius, distance: f64| Some(Rim { radius, distance: sign * distance });
    Character { rims: [rim(0.055, 0.12), rim(0.07, -0.1)], has_cos4_falloff: true, ..Character::default() }
}

fn weighed(sign: f64) -> Character {
    Character { edges: sign * 0.9, ..Character::default() }
}

fn fringed(sign: f64) -> Character {
    Character {
        longitudinal_colour: [sign * 6e-4, -sign * 8e-4],
        lateral_colour: [sign * 0.01, -sign * 0.012],
        ..Character::default()
    }
}

fn everything(sign: f64) -> Character {
    Character { rims: cut(1.0).rims, field_curvature: 0.05, edges: sign * 0.9, ..fringed(sign) }
}

/// A wall of colours far behind, a card in focus, lamps behind and before it, and bars close to the lens.
fn stage() -> Arc<Scene> {
    let card = |x: f64, y: f64, z: f64, half: f64| {
        Mesh::rectangle(DVec3::new(x - half, y - half, -z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half)
    };
    let bar = |x: f64| Mesh::rectangle(DVec3::new(x, -1.0, -1.4), DVec3::X * 0.07, DVec3::Y * 2.0);
    let meshes = [
        (Mesh::wall(9.0, 20.0), [0.12, 0.1, 0.08]),
        (card(-1.6, 0.9, 8.0, 0.9), [0.5, 0.15, 0.1]),
        (card(1.8, -0.8, 7.0, 1.0), [0.1, 0.3, 0.5]),
        (card(0.0, 0.0, 3.0, 0.35), [0.6, 0.55, 0.3]),
        (card(-2.1, -1.2, 8.5, 0.06), [30.0, 28.0, 25.0]),
        (card(2.6, 1.6, 8.5, 0.06), [30.0, 20.0, 35.0]),
        (card(0.5, 0.42, 1.9, 0.015), [20.0, 30.0, 25.0]),
        (bar(-0.5), [0.3, 0.35, 0.2]),
        (bar(0.33), [0.25, 0.2, 0.3]),
    ];
    unlit_scene_of(meshes.iter().map(|(mesh, color)| (mesh, *color)))
}

/// The least agreement that counts, dB.
const LEAST_DB: f64 = 45.0;
/// Or so much less than that of the same picture by a lens without character.
const LESS_DB: f64 = 1.5;

fn compare(
    character: Character,
    wrong: Character,
    effort: Effort,
    progress: &dyn Progress,
) -> Result<Verdict, Cancelled> {
    let (side, samples) = effort.choose((64, 1024), (48, 512));
    let camera = Camera {
        width: side * 3 / 2,
        height: side,
        yfov: 0.6,
        focus_distance: 3.0,
        aperture_radius: 0.04,
        sensor_height: 0.05,
        ..Camera::default()
    };
    let shot = Shot::new(stage(), camera.clone());
    let with = |character| shot.with_camera(Camera { character, ..camera.clone() });
    let (mut missing, mut control) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for offset in [FocusOffset::STANDARD, FocusOffset::new(0.985, 0.3)] {
        let agreement = |splat: &Picture, traced: &Shot| {
            Ok::<f64, Cancelled>(agreement(splat, &traced.truth(offset, samples, progress)?))
        };
        let plain = agreement(&shot.splat(offset, progress)?, &shot)?;
        let least = LEAST_DB.min(plain - LESS_DB);
        let splat = with(character).splat(offset, progress)?;
        missing = missing.max(least - agreement(&splat, &with(character))?);
        control = control.max(least - agreement(&splat, &with(wrong))?);
    }
    let expected = format!(
        "{LEAST_DB} dB against rays, or at most {LESS_DB} dB less than a plain lens, unpainted and painted"
    );
    Ok(Verdict::new(expected, [("dB too few", 0.0)], [missing], [control]))
}

/// How well two pictures agree as they are shown: the lesser of both exposures, dB.
fn agreement(a: &Picture, b: &Picture) -> f64 {
    let psnr_of = |exposure| psnr(&a.exposed(exposure), &b.exposed(exposure));
    psnr_of(Exposure::Normalise).min(psnr_of(Exposure::Conserve))
}
