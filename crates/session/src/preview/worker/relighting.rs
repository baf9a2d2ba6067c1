//! Another backdrop, or another brightness of the world: the light fields stay, in other light. Until they are made, the picture stays,
//! too; so it does where the world lights little of the scene.

use super::Worker;
use crate::preview::light_field_maker::{FieldOrigin, MadeField};
use document::Stage;
use focus::Focus;
use glam::DVec3;
use lens::Camera;
use salf::LightChange;
use scene::{Backdrop, Environment, Scene, World};
use std::sync::Arc;

/// The share of samples that may look otherwise while the fine light field is baked in another world: fewer than coarse pictures would get wrong.
const MOST_OUTDATED: f64 = 0.05;

/// How the fine light field, which shows the world of before, becomes one of another world.
#[derive(Clone, Copy)]
pub(super) enum Relighting {
    /// The light of its samples changes alike.
    OfSamples(LightChange),
    /// It is baked. Until then it stands in: the world lights little of it.
    ByBake,
}

impl Worker {
    /// Keeps the light fields if they can be shown in the world of the new stage; otherwise gives them up. Returns whether the fine one stays.
    pub(super) fn relight(&mut self, keeps: bool) -> bool {
        let (coarse, stage) = (self.coarse.take(), self.stage.clone().filter(|_| keeps));
        let shown = self.shown_stage.clone().filter(|_| stage.is_some());
        self.relighting = shown.and_then(|shown| self.relighting_from(&shown));
        self.fine.take_if(|_| self.relighting.is_none());
        if self.fine.is_none() {
            if let Some(Relighting::OfSamples(light)) = self.relighting.take() {
                self.coarse =
                    coarse.and_then(|field| field.relightable().in_light(&light, self.shared.gpu()));
            }
            self.shown_stage = stage;
        }
        self.fine.is_some()
    }

    /// Begins to make the light field that the fine one stands in for, unless one is being made.
    pub(super) fn make_relit(&mut self, stage: &Arc<Stage>, camera: &Camera, focus: &Focus) {
        let Some((relighting, fine)) = self.relighting.zip(self.fine.as_ref()) else { return };
        if self.maker.is_at_work() || self.is_paused {
            return;
        }
        let origin = match relighting {
            Relighting::OfSamples(light) => FieldOrigin::Relit(fine.relightable(), light),
            Relighting::ByBake => FieldOrigin::LoadOrBake { least_margin_px: 0.0 },
        };
        self.make_field(origin, stage, camera, focus.clone());
    }

    /// Whether what was made is of the stage, or can be shown in its world.
    pub(super) fn is_wanted(&self, made: &MadeField) -> bool {
        made.epoch == self.epoch || (self.fine.is_some() && self.relighting_from(&made.stage).is_some())
    }

    /// How a light field of `before` becomes one of the stage; `None` if there is no other way than from the start.
    pub(super) fn relighting_from(&self, before: &Stage) -> Option<Relighting> {
        let (stage, camera) = (self.stage.as_ref()?, self.camera.as_ref()?);
        // Photographs have a backdrop of their own.
        if !stage.differs_in_world_alone(before) || !stage.scene.views.is_empty() {
            return None;
        }
        let background = camera.background.map(|radiance| DVec3::from_array(radiance).as_vec3());
        let [from, to] = [before, stage].map(|stage| World::from_scene(&stage.scene, background));
        if let Some(light) = light_change(&stage.scene, &from, &to) {
            return Some(Relighting::OfSamples(light));
        }
        let changes =
            |triangle: Option<u32>| triangle.is_none_or(|triangle| !stage.scene.material_of(triangle).unlit);
        let outdated = self.fine.as_ref()?.share_of_samples(changes);
        (outdated <= MOST_OUTDATED).then_some(Relighting::ByBake)
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
