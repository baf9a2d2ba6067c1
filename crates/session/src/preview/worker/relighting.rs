//! What the preview's thread does with its light fields when the world changes.

use super::Worker;
use crate::error::SessionError;
use crate::light_field::Relightable;
use crate::preview::activity::PreviewActivity;
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

    /// Looks what the light of the stage changes, where that is estimated.
    ///
    /// # Errors
    /// The light cannot be solved, or the work was cancelled.
    pub(super) fn estimate_light(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
    ) -> Result<(), SessionError> {
        let (Some(Relighting::ByEstimate(estimate)), Some(shown)) = (&mut self.relighting, &self.shown_stage)
        else {
            return Ok(());
        };
        if estimate.is_made() || self.is_paused {
            return Ok(());
        }
        self.shared.begin(PreviewActivity::Tracing)?;
        estimate.make([shown, stage], camera, focus, &self.shared.quick)?;
        self.is_new = true;
        Ok(())
    }

    /// Begins to make the light field that the fine one stands in for, unless one is being made.
    pub(super) fn make_relit(&mut self, stage: &Arc<Stage>, camera: &Camera, focus: &Focus) {
        let Some((relighting, fine)) = self.relighting.as_ref().zip(self.fine.as_ref()) else { return };
        if self.maker.is_at_work() || self.is_paused {
            return;
        }
        let origin = match relighting {
            Relighting::OfSamples(light) => FieldOrigin::Relit(fine.into(), *light),
            Relighting::ByBake | Relighting::ByEstimate(_) => {
                FieldOrigin::LoadOrBake { least_margin_px: 0.0 }
            }
        };
        self.make_field(origin, stage, camera, focus.clone());
    }

    /// How a light field of `before` becomes one of the stage.
    pub(super) fn relighting_from(&self, before: &Stage) -> Option<Relighting> {
        Relighting::between([before, self.stage.as_ref()?], self.camera.as_ref()?, self.fine.as_ref())
    }
}
