//! A painted focus for scenes that come without one, covering the range of what paint can do.

use document::chief_ray;
use focus::{FocusRecipe, RecipeEntry};
use glam::DVec2;
use lens::{Camera, FocusOffset};
use scene::Scene;
use std::collections::BTreeMap;
use trace::Tracer;

/// Diameter of the painted blurs, in picture heights.
const PAINTED_CIRCLE: f64 = 0.06;

/// Probe rays per side of the picture.
const RAYS_A_SIDE: u32 = 64;

/// A recipe by material, or by node if there is only one material. In the order of their share of the picture,
/// they get in turn: sharp at any depth, far blur of a fixed size, focus shifted nearer, and a mix of both
/// anchors. If there is only one of them, it gets the mix, so that paint blurs something. Returns the recipe
/// and a sentence that describes it.
pub fn generic_recipe(scene: &Scene, tracer: &Tracer, camera: &Camera) -> (FocusRecipe, String) {
    let by_material = names_by_coverage(tracer, camera, |triangle| scene.material_of(triangle).name.clone());
    let is_by_material = by_material.len() > 1;
    let names = if is_by_material {
        by_material
    } else {
        names_by_coverage(tracer, camera, |triangle| {
            scene.nodes[scene.part_of(triangle).node as usize].name.clone()
        })
    };
    // t − 1 = κ·d for a surface in focus, for any anchor.
    let optics = camera.optics();
    let kappa = optics.kappa_for_circle_px(PAINTED_CIRCLE * camera.height as f64).unwrap_or_default();
    let shift = kappa * optics.image_distance;
    let between_anchors = FocusOffset::new(1.0 + 0.5 * shift, 0.5);
    let focuses = [
        FocusOffset::new(1.0, 1.0),
        FocusOffset::new(1.0 + shift, 1.0),
        FocusOffset::new(1.0 - shift, 0.0),
        between_anchors,
    ];
    let (cycled_focuses, circle) =
        (if names.len() > 1 { &focuses[..] } else { &[between_anchors] }, PAINTED_CIRCLE * 100.0);
    let what = if names.len() > 1 {
        format!(
            "made up, in turn by {}: sharp wherever it stands, {circle:.0} % of the picture's height of far blur, as \
             much nearer than the lens has it, half way between both anchors",
            if is_by_material { "material" } else { "object" },
        )
    } else {
        format!(
            "made up: all half way between both anchors, with {:.0} % of the picture's height of far blur at the focus \
             distance",
            0.5 * circle
        )
    };
    let entries: Vec<_> = names
        .into_iter()
        .zip(cycled_focuses.iter().copied().cycle())
        .map(|(name, focus)| (name, RecipeEntry::Value(focus)))
        .collect();
    let (materials, nodes) = if is_by_material { (entries, Vec::new()) } else { (Vec::new(), entries) };
    (FocusRecipe { materials, nodes, ..FocusRecipe::default() }, what)
}

/// The names of what is visible in the pinhole picture, by decreasing share.
fn names_by_coverage(tracer: &Tracer, camera: &Camera, name: impl Fn(u32) -> String) -> Vec<String> {
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    for index in 0..RAYS_A_SIDE * RAYS_A_SIDE {
        let at = DVec2::new((index % RAYS_A_SIDE) as f64 + 0.5, (index / RAYS_A_SIDE) as f64 + 0.5);
        if let Some(hit) = tracer.visible_surface(&chief_ray(camera, at / RAYS_A_SIDE as f64)) {
            *counts.entry(name(hit.point.triangle)).or_default() += 1;
        }
    }
    let mut names: Vec<_> = counts.into_iter().collect();
    names.sort_by(|(a, count_a), (b, count_b)| count_b.cmp(count_a).then(a.cmp(b)));
    names.into_iter().map(|(name, _)| name).collect()
}
