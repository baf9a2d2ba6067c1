//! What the preview's thread does with its light fields when the world changes.

use super::Worker;
use crate::light_field::Relightable;
use crate::preview::light_field_maker::FieldOrigin;
use crate::preview::relighting::Relighting;
use document::Stage;
use focus::Focus;
use lens::Camera;
use std::sync::Arc;

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
                    coarse.and_then(|field| Relightable::from(&field).in_light(&light, self.shared.gpu()));
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
            Relighting::OfSamples(light) => FieldOrigin::Relit(fine.into(), light),
            Relighting::ByBake => FieldOrigin::LoadOrBake { least_margin_px: 0.0 },
        };
        self.make_field(origin, stage, camera, focus.clone());
    }

    /// How a light field of `before` becomes one of the stage.
    pub(super) fn relighting_from(&self, before: &Stage) -> Option<Relighting> {
        Relighting::between([before, self.stage.as_ref()?], self.camera.as_ref()?, self.fine.as_ref())
    }
}
