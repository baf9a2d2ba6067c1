//! Invalid and extreme focus offsets.

use crate::case::{Case, Effort, NOT_COMPUTED, Verdict};
use crate::support::measure::{largest_difference, senseless, worst};
use crate::support::shot::Shot;
use focus::{Brush, FocusMap, FocusRecipe, RecipeEntry};
use glam::DVec3;
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use test_scenes::{Mesh, unlit_scene_of};

pub const CASES: &[Case] = &[
    Case {
        name: "t = 0, negative, up to 1e300",
        reason: "Any finite t is a lens: the picture consists of finite, non-negative numbers, however far \
                 the light is displaced.",
        control: "(t − 1)/d and the rest of κ added where both overflow",
        check: any_finite_offset,
    },
    Case {
        name: "t = NaN, ±∞, anchor outside [0, 1]",
        reason: "Recipes, brushes and maps reject invalid offsets; if one reaches the renderers nevertheless, \
                 it counts as unpainted.",
        control: "κ computed from the invalid number",
        check: not_a_number,
    },
];

fn shot() -> Shot {
    let patch = Mesh::rectangle(DVec3::new(-0.2, -0.3, -2.0), DVec3::X * 0.5, DVec3::Y * 0.4);
    let scene = unlit_scene_of([(&Mesh::wall(4.0, 50.0), [1.0, 0.5, 0.2]), (&patch, [0.1, 2.0, 0.7])]);
    Shot::new(scene, Camera { width: 18, height: 12, aperture_radius: 0.1, ..Camera::default() })
}

const ANCHORS: [f64; 3] = [0.0, 0.5, 1.0];

fn any_finite_offset(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = shot();
    let every = [0.0, -1e-9, -1.0, -3.0, 1e6, -1e6, 1e30, 1e300, f64::MAX, f64::MIN];
    let (mut in_pictures, mut raw) = (0.0, 0.0);
    for (index, &t) in every.iter().enumerate() {
        let anchors = effort.choose(&ANCHORS[..], &ANCHORS[index % 3..=index % 3]);
        for &anchor in anchors {
            let offset = FocusOffset::new(t, anchor);
            in_pictures += senseless(&shot.splat(offset, progress)?);
            raw += f64::from(!raw_kappa(&shot.camera, offset).is_finite());
        }
        // Tracing wide blur is slow.
        if index % effort.choose(1, 4) == 0 {
            in_pictures += senseless(&shot.truth(FocusOffset::new(t, 0.5), 1, progress)?);
            in_pictures += senseless(&shot.truth_from_surfaces(FocusOffset::new(t, 0.5), 1, progress)?);
        }
    }
    let expected = "no number of any picture is NaN, infinite or negative";
    Ok(Verdict::new(expected, [("senseless", 0.0)], [in_pictures], [raw]))
}

/// κ at depth 2 computed without a guard.
fn raw_kappa(camera: &Camera, FocusOffset { t, anchor, .. }: FocusOffset) -> f64 {
    let optics = camera.optics();
    (t - 1.0) / optics.image_distance + t * (1.0 - anchor) * (optics.inverse_focus_distance - 0.5)
}

fn not_a_number(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let shot = shot();
    let offsets = [
        FocusOffset::new(f64::NAN, 0.0),
        FocusOffset::new(f64::INFINITY, 1.0),
        FocusOffset::new(f64::NEG_INFINITY, 0.5),
        FocusOffset::new(1.0, f64::NAN),
        FocusOffset::new(1.1, 1.5),
        FocusOffset::new(1.1, -0.1),
    ];
    let pictures = |offset: FocusOffset| -> Result<[Picture; 3], Cancelled> {
        let splatted = shot.splat(offset, progress)?;
        let traced = shot.truth(offset, 4, progress)?;
        Ok([splatted, traced, shot.truth_from_surfaces(offset, 4, progress)?])
    };
    let standard = pictures(FocusOffset::STANDARD)?;
    let (mut accepted, mut differences, mut raw) = (0.0, Vec::new(), Vec::new());
    for offset in effort.choose(&offsets[..], &offsets[..3]) {
        let recipe = FocusRecipe { default: RecipeEntry::Value(*offset), ..FocusRecipe::default() };
        accepted += f64::from(recipe.evaluate(shot.tracer.scene()).is_ok());
        accepted += f64::from(Brush { target: *offset, ..Brush::default() }.problem().is_none());
        accepted += f64::from(FocusMap::new(4, 4, *offset).is_valid());
        let actual = pictures(*offset)?;
        differences.extend((0..3).map(|k| largest_difference(&actual[k], &standard[k])));
        let optics = shot.camera.optics();
        raw.push(raw_kappa(&shot.camera, *offset) - optics.standard_kappa(0.5));
    }
    let expected = "recipes, brushes and maps refuse it; given to the renderers (splat, rays from the \
                    sensor, rays from the surfaces), the unpainted picture bit for bit";
    let limits = [("accepted", 0.0), ("difference", 0.0)];
    Ok(Verdict::new(expected, limits, [accepted, worst(differences)], [NOT_COMPUTED, worst(raw)]))
}
