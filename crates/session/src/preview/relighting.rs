//! Another backdrop, or another brightness of the world: the light fields stay, in other light. Until they are made, the picture stays,
//! too; so it does where the world lights little of the scene.

use crate::light_field::LightField;
use document::Stage;
use glam::DVec3;
use lens::Camera;
use salf::LightChange;
use scene::{Backdrop, Environment, Scene, World};

/// The share of samples that may look otherwise while the fine light field is baked in another world: fewer than coarse pictures would get wrong.
const MOST_OUTDATED: f64 = 0.05;

/// How the fine light field, which shows the world of before, becomes one of another world.
#[derive(Clone, Copy)]
pub(crate) enum Relighting {
    /// The light of its samples changes alike.
    OfSamples(LightChange),
    /// It is baked. Until then it stands in: the world lights little of it.
    ByBake,
}

impl Relighting {
    /// How a light field of a stage becomes one of another; `fine` is what is there. `None` if there is no other way than from the start.
    pub fn between([before, stage]: [&Stage; 2], camera: &Camera, fine: Option<&LightField>) -> Option<Self> {
        // Photographs have a backdrop of their own.
        if !stage.differs_in_world_alone(before) || !stage.scene.views.is_empty() {
            return None;
        }
        let background = camera.background.map(|radiance| DVec3::from_array(radiance).as_vec3());
        let [from, to] = [before, stage].map(|stage| World::from_scene(&stage.scene, background));
        if let Some(light) = light_change(&stage.scene, &from, &to) {
            return Some(Self::OfSamples(light));
        }
        let changes =
            |triangle: Option<u32>| triangle.is_none_or(|triangle| !stage.scene.material_of(triangle).unlit);
        let outdated = fine?.share_of_samples(changes);
        (outdated <= MOST_OUTDATED).then_some(Self::ByBake)
    }
}

/// How light changes from one world to another, if it changes alike on all surfaces.
fn light_change(scene: &Scene, from: &World, to: &World) -> Option<LightChange> {
    let brightness = if from.strength == to.strength { 1.0 } else { to.strength / from.strength };
    let is_same_but_for_brightness = World { strength: to.strength, ..from.lighting() } == to.lighting();
    let factor = match () {
        // The world lights none of it.
        _ if scene.is_unlit() => 1.0,
        _ if !is_same_but_for_brightness => return None,
        _ if brightness == 1.0 || (brightness.is_finite() && scene.is_lit_by_world_alone()) => brightness,
        _ => return None,
    };
    let backdrop = match (to.backdrop, &to.environment) {
        (Backdrop::Color(radiance), _) => Some(radiance),
        (Backdrop::Environment, Environment::Uniform(radiance)) => Some(*radiance * to.strength),
        // What stands behind changes by the same factor.
        _ if is_same_but_for_brightness && from.backdrop == to.backdrop && brightness == factor => None,
        _ => return None,
    };
    Some(LightChange { factor, backdrop })
}
