//! Another backdrop: the light fields stay, with another radiance wherever no surface is.

use super::Worker;
use crate::preview::light_field_maker::FieldOrigin;
use document::Stage;
use glam::{DVec3, Vec3};
use lens::Camera;
use scene::{Backdrop, World};

impl Worker {
    /// Keeps the light fields if nothing but the backdrop changed, which has this radiance; otherwise gives them up.
    pub(super) fn take_up_backdrop(&mut self, backdrop: Option<Vec3>) {
        let (coarse, fine) = (self.coarse.take(), self.fine.take());
        // One that was not taken up yet is followed by another backdrop.
        let before = self.before_backdrop.take().map(|(field, _)| field);
        let (Some(radiance), Some(stage)) = (backdrop, &self.stage) else { return };
        self.coarse = coarse.and_then(|field| field.with_backdrop(stage, radiance, self.shared.gpu()));
        self.before_backdrop = fine.or(before).map(|field| (field, radiance));
    }

    /// What the next light field begins with.
    pub(super) fn next_origin(&mut self, camera: &Camera) -> FieldOrigin {
        let before = self.before_backdrop.take().filter(|(field, _)| field.can_show(camera));
        match before {
            Some((field, radiance)) => FieldOrigin::OtherBackdrop(Box::new(field), radiance),
            None if std::mem::take(&mut self.bakes_anew) => FieldOrigin::Bake,
            None => FieldOrigin::LoadOrBake { least_margin_px: 0.0 },
        }
    }

    /// The radiance of the backdrop of `after`, if it is the same in all directions, and all else of the stage is as in `before`.
    pub(super) fn plain_backdrop(before: &Stage, after: &Stage, camera: &Camera) -> Option<Vec3> {
        let background = camera.background.map(|radiance| DVec3::from_array(radiance).as_vec3());
        let [world_before, world] = [before, after].map(|stage| World::from_scene(&stage.scene, background));
        let is_same_light =
            after.differs_in_world_alone(before) && world.lighting() == world_before.lighting();
        let Backdrop::Color(radiance) = world.backdrop else { return None };
        // Photographs have a backdrop of their own.
        (is_same_light && after.scene.views.is_empty()).then_some(radiance)
    }
}
