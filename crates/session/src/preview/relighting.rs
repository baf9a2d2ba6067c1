//! Another backdrop, or another brightness of the world: the light fields stay, in other light. Until they are made, the picture stays,
//! too, multiplied by what pictures without blur show of the change; as it is, it stays where the world lights little of the scene.

use crate::display::{Layer, LightRatio};
use crate::error::SessionError;
use crate::light_field::LightField;
use crate::preview::picture_sizes::resized;
use baselines::FirstHits;
use document::Stage;
use focus::Focus;
use glam::{DVec3, Vec3};
use lens::Camera;
use light::LightQuality;
use progress::Progress;
use salf::LightChange;
use scene::{Backdrop, Environment, Scene, World};
use std::sync::Arc;

/// The share of samples that may look otherwise while the fine light field is baked in another world: fewer than coarse pictures would get wrong.
const MOST_OUTDATED: f64 = 0.05;

/// Columns of the pictures from which light is estimated.
const ESTIMATED_WIDTH: u32 = 160;

/// How the fine light field, which shows the world of before, becomes one of another world.
#[derive(Clone)]
pub(crate) enum Relighting {
    /// The light of its samples changes alike.
    OfSamples(LightChange),
    /// It is baked. Until then it stands in: the world lights little of it.
    ByBake,
    /// It is baked. Until then it is shown as bright as it may be.
    ByEstimate(LightEstimate),
}

/// What brighter or dimmer light of the world does to a picture, about.
#[derive(Clone)]
pub(crate) struct LightEstimate {
    /// What the world's light is multiplied by.
    brightness: f32,
    /// How that shows; `None` before it is made.
    ratio: Option<Arc<LightRatio>>,
}

impl LightEstimate {
    /// Whether it is known how it shows.
    pub fn is_made(&self) -> bool {
        self.ratio.is_some()
    }

    /// Looks at small pictures without blur, before and after.
    ///
    /// # Errors
    /// The light cannot be solved, or the work was cancelled.
    pub fn make(
        &mut self,
        stages: [&Stage; 2],
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<(), SessionError> {
        let width = camera.width.min(ESTIMATED_WIDTH);
        let small = resized(camera, [width, (width * camera.height).div_ceil(camera.width)]);
        let [before, after] = stages.map(|stage| {
            let radiance = stage.lit.solve(&small, LightQuality::Rough, progress)?;
            let hits = FirstHits::trace(stage.tracer(), &*radiance, focus, &small, progress)?;
            Ok::<_, SessionError>(hits.picture())
        });
        let size = [camera.width, camera.height];
        self.ratio = Some(Arc::new(LightRatio::new([&before?, &after?], self.brightness, size)));
        Ok(())
    }
}

impl Relighting {
    /// What is laid over the light field's pictures until it is made.
    pub fn layer(&self) -> Option<Arc<dyn Layer>> {
        match self {
            Self::ByEstimate(estimate) => Some(estimate.ratio.clone()? as _),
            Self::OfSamples(_) | Self::ByBake => None,
        }
    }

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
        let brightness = to.strength / from.strength;
        let is_same_but_for_brightness = World { strength: to.strength, ..from.clone() } == to;
        if is_same_but_for_brightness && brightness.is_finite() && brightness > 0.0 {
            return Some(Self::ByEstimate(LightEstimate { brightness, ratio: None }));
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
        _ if scene.is_unlit() || [from, to].map(is_dark) == [true; 2] => 1.0,
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

/// Whether a world sends no light.
fn is_dark(world: &World) -> bool {
    match world.environment {
        Environment::Uniform(radiance) => radiance * world.strength == Vec3::ZERO,
        _ => world.strength == 0.0,
    }
}
