//! What the preview's thread does while nothing changes: the exact picture, light fields for other apertures, and refined light.

use super::Worker;
use crate::light_field::{ApertureFit, spare_camera};
use crate::preview::exact_refinement::ExactTask;
use crate::preview::light_refinement::LightTask;
use crate::preview::picture::Quality;
use document::Stage;
use focus::Focus;
use lens::Camera;
use std::sync::Arc;

impl Worker {
    /// Whether the picture is up to date and could be better.
    pub(super) fn may_refine(&self) -> bool {
        let is_viewing = self.presenter.shown().is_some_and(|shown| shown.quality == Quality::Viewing);
        let field = self.fine.as_ref().zip(self.camera.as_ref());
        let is_complete =
            field.is_some_and(|(fine, camera)| fine.is_up_to_date(camera) && fine.can_show(camera));
        is_viewing && is_complete && self.is_quiet() && !self.refinement.is_at_work()
    }

    /// Whether nobody waits for anything else.
    pub(super) fn is_quiet(&self) -> bool {
        let is_at_work = self.maker.is_at_work() || self.relighting.is_some();
        !self.is_paused && !self.is_painting && !is_at_work && !self.shared.is_exporting()
    }

    /// Whether light fields may be made that are not needed for the picture that is shown.
    pub(super) fn may_make_fields(&self) -> bool {
        let is_quiet = self.is_quiet() && !self.is_background_paused;
        is_quiet && self.fine.is_some() && !self.spare.is_at_work() && !self.refinement.is_at_work()
    }

    /// Whether the fine light field is as good as one of the lens's own aperture.
    pub(super) fn has_close_aperture(&self) -> bool {
        let fine = self.fine.as_ref().zip(self.camera.as_ref());
        fine.and_then(|(fine, camera)| fine.aperture_fit(camera)).is_some_and(ApertureFit::is_close)
    }

    /// The camera of the spare that is missing, if one is.
    pub(super) fn missing_spare(&self) -> Option<Camera> {
        let camera = self.camera.as_ref()?;
        spare_camera(camera).filter(|_| !self.spare.is_ready_for(camera))
    }

    /// Whether there is work to do while there are no requests.
    pub(super) fn has_idle_work(&self) -> bool {
        let lacks_field = || !self.has_close_aperture() || self.missing_spare().is_some();
        self.may_refine() || (self.may_make_fields() && lacks_field()) || self.refinable_passes().is_some()
    }

    /// By how many passes the light of the picture may be refined, which is exact but for that.
    pub(super) fn refinable_passes(&self) -> Option<u32> {
        let (fine, camera, stage) = (self.fine.as_ref()?, self.camera.as_ref()?, self.stage.as_ref()?);
        let is_exact = self.presenter.shown().is_some_and(|shown| shown.quality == Quality::Exact);
        let is_quiet = self.is_quiet() && !self.is_background_paused;
        let is_quiet = is_quiet && !self.spare.is_at_work() && !self.light.is_at_work();
        let is_allowed = is_exact && is_quiet && fine.is_up_to_date(camera) && stage.lit.can_be_refined();
        self.light.next_passes(camera, fine.light_passes(), self.light_passes).filter(|_| is_allowed)
    }

    /// Begins to refine the light, unless there is a new request.
    pub(super) fn refine_light(&mut self, passes: u32, stage: Arc<Stage>, camera: Camera, focus: Focus) {
        let (tolerance, epoch, exposure) = (self.tolerance, self.epoch, self.presenter.exposure());
        let Some(fine) = &mut self.fine else { return };
        let margin_px = f64::from(fine.baked().salf.margin_px);
        let Ok(displayed) = fine.fetch_picture().cloned().map(Arc::new) else { return };
        let task =
            LightTask { stage, camera, focus, tolerance, displayed, exposure, margin_px, passes, epoch };
        // The exact picture stands; its sum would take memory beside the light field that is made now.
        self.refinement.forget();
        self.light.start(&self.shared, task);
    }

    /// Begins to draw the exact picture, unless there is a new request.
    pub(super) fn refine(&mut self, camera: Camera, focus: Focus) {
        let Some(fine) = &mut self.fine else { return };
        let fetched = || fine.fetch_picture().ok().cloned().map(Arc::new);
        let Some(viewing) = self.presenter.followed().or_else(fetched) else { return };
        let (exposure, map_serial) = (self.presenter.exposure(), self.presenter.map_serial);
        let task = ExactTask { camera, focus, viewing, exposure, map_serial };
        self.refinement.start(&self.shared, fine, task);
    }
}
