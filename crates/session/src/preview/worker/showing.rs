//! The pictures that the preview's thread shows: without blur, of few pixels, fine, and exact.

use super::Worker;
use crate::display::{PictureSource, StandingPicture};
use crate::error::SessionError;
use crate::light_field::{FieldOptions, LightField, Plan, SumUpdate, spare_camera};
use crate::preview::activity::PreviewActivity;
use crate::preview::deliveries::ExactDelivery;
use crate::preview::light_field_maker::FieldOrigin;
use crate::preview::mailbox::UntilCameraMoves;
use crate::preview::picture::{PreviewKind, Quality};
use crate::preview::picture_sizes::{
    coarse_camera_of_splats, has_coarse_pictures, moving_camera, next_coarse_camera, pixel_count, resized,
};
use crate::preview::pinhole::is_same_view;
use crate::preview::presenter::{NewPicture, Relation};
use crate::preview::relighting::Relighting;
use document::Stage;
use focus::Focus;
use lens::{Camera, Picture};
use light::LightQuality;
use render::Modelled;
use splat::Tolerance;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A camera that has not moved for so long rests; until then, the window has the processor.
const HAND_REST: Duration = Duration::from_millis(200);

impl From<&SumUpdate> for PreviewKind {
    fn from(update: &SumUpdate) -> Self {
        if matches!(update, SumUpdate::Region(_)) { Self::Update } else { Self::Splat }
    }
}

impl Worker {
    /// Brings the fine picture up to date; then, after an edit, sees whether another light field would serve better.
    pub(super) fn show_fine(
        &mut self,
        plan: Plan,
        stage: &Arc<Stage>,
        camera: &Camera,
        focus: Focus,
    ) -> Result<(), SessionError> {
        let Some(fine) = &mut self.fine else { return Ok(()) };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let update = fine.execute_plan(plan, camera, &focus, &UntilCameraMoves(&self.shared))?;
        self.standing = None;
        let layer = self.relighting.as_ref().and_then(Relighting::layer);
        let light_passes = fine.light_passes();
        let is_new = std::mem::take(&mut self.is_new);
        if update != SumUpdate::Unchanged || is_new {
            let is_exact = self.tolerance == Tolerance::NONE;
            let costs = &mut self.presenter.costs;
            costs.light_passes = light_passes;
            if light_passes == 0 {
                costs.light_psnr = None;
            }
            if update == SumUpdate::Whole || is_new {
                costs.viewing_psnr = None;
                let seconds = if is_exact { &mut costs.exact_seconds } else { &mut costs.viewing_seconds };
                *seconds = Some(fine.whole_seconds());
            }
            // The sum of a new one may have been made elsewhere.
            let elsewhere = if update == SumUpdate::Unchanged { fine.whole_seconds() } else { 0.0 };
            self.presenter.show(NewPicture {
                picture: fine.source(),
                camera,
                enlarged_to: None,
                quality: match (&layer, is_exact) {
                    (Some(_), _) => Quality::Coarse,
                    (None, true) => Quality::Exact,
                    (None, false) => Quality::Viewing,
                },
                layer,
                kind: PreviewKind::from(&update),
                seconds: start.elapsed().as_secs_f64() + elsewhere,
                modelled: fine.modelled(),
                relation: match update {
                    SumUpdate::Region(rectangle) if !is_new => Relation::Changed(rectangle),
                    _ => Relation::New,
                },
            });
        }
        if !self.is_edit_done || self.maker.is_at_work() || self.is_paused {
            return Ok(());
        }
        self.is_edit_done = false;
        if let Some(least_margin_px) = fine.rebake_margin_px(camera, &focus) {
            self.coarse = None;
            self.make_field(FieldOrigin::LoadOrBake { least_margin_px }, stage, camera, focus);
        }
        Ok(())
    }

    /// Keeps the picture that is shown, if it is a fine one: drafts that follow lie below what stays of it.
    fn keep_standing(&mut self) {
        let shown = self.presenter.shown().filter(|shown| shown.quality > Quality::Coarse);
        let Some(camera) = shown.map(|shown| shown.camera.clone()) else { return };
        let plain = self.presenter.followed().filter(|picture| picture.colour_coverage.is_none());
        self.standing = plain.map(|picture| (StandingPicture::new(picture), camera));
    }

    /// A draft of the fine picture, which takes longer.
    pub(super) fn show_draft(&mut self, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        self.keep_standing();
        let Some(fine) = &mut self.fine else { return Ok(()) };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let modelled = fine.modelled();
        let draft = fine.sum_draft(camera, focus, &self.shared.quick)?;
        let (standing, size) = (self.standing.as_mut(), [camera.width, camera.height]);
        let fits = |(picture, of): &&mut (StandingPicture, Camera)| {
            picture.size() == size && is_same_view(of, camera)
        };
        let standing = standing.filter(fits).map(|(picture, _)| Arc::new(picture.layer_over(draft)) as _);
        let layer = self.relighting.as_ref().and_then(Relighting::layer).or(standing);
        self.presenter.show(NewPicture {
            camera: &resized(camera, [draft.width, draft.height]),
            picture: PictureSource::InMemory(draft),
            enlarged_to: Some(size),
            layer,
            kind: PreviewKind::Splat,
            quality: Quality::Coarse,
            seconds: start.elapsed().as_secs_f64(),
            modelled,
            relation: Relation::New,
        });
        Ok(())
    }

    /// A picture without blur that is there at once, if the view is new. Returns whether the camera rests.
    pub(super) fn show_pinhole(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
    ) -> Result<bool, SessionError> {
        if self.presenter.shown().is_some_and(|shown| is_same_view(&shown.camera, camera)) {
            return Ok(true);
        }
        let camera = &moving_camera(camera, self.pinhole.pace());
        self.shared.begin_following();
        let start = Instant::now();
        let traced = self.trace_pinhole(stage, camera, focus).inspect_err(|_| {
            self.shared.end_following(Duration::ZERO);
        })?;
        self.presenter.show(NewPicture {
            picture: PictureSource::InMemory(&traced),
            camera,
            enlarged_to: None,
            layer: None,
            relation: Relation::New,
            kind: PreviewKind::Pinhole,
            quality: Quality::Coarse,
            seconds: start.elapsed().as_secs_f64(),
            modelled: Modelled::default(),
        });
        Ok(self.shared.end_following(HAND_REST))
    }

    pub(super) fn trace_pinhole(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
    ) -> Result<Picture, SessionError> {
        self.shared.begin(PreviewActivity::Tracing)?;
        let Some(map) = &self.map else { return Err(SessionError::NothingOpen) };
        self.pinhole.trace(stage, camera, (focus, map), &self.shared.quick)
    }

    /// The picture without blur of a camera that rests: it is laid over the pictures of few pixels, blurred by itself.
    fn trace_resting(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        self.shared.begin(PreviewActivity::Tracing)?;
        let Some(map) = &self.map else { return Err(SessionError::NothingOpen) };
        self.pinhole.trace_resting(stage, camera, (focus, map), &self.shared.quick)
    }

    /// Shows that picture, unless it was before.
    fn show_defocused(&mut self, camera: &Camera) {
        let start = Instant::now();
        let defocused = self.map.as_ref().and_then(|map| self.pinhole.defocused(camera, map));
        let Some((defocused, true)) = defocused else { return };
        let picture = &defocused.picture;
        self.presenter.show(NewPicture {
            picture: PictureSource::InMemory(picture),
            camera: &resized(camera, [picture.width, picture.height]),
            enlarged_to: Some([camera.width, camera.height]),
            layer: None,
            kind: PreviewKind::Defocused,
            quality: Quality::Coarse,
            seconds: start.elapsed().as_secs_f64(),
            modelled: Modelled::default(),
            relation: Relation::New,
        });
    }

    /// Pictures of few pixels, each of more than the one before; begins with the best that need not be baked, and ends there
    /// while a stroke waits for more.
    pub(super) fn show_coarse(
        &mut self,
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
    ) -> Result<(), SessionError> {
        let (size, mut shown_pixels) = ([camera.width, camera.height], 0.0);
        let standing = self.coarse.as_ref().map(|coarse| (coarse, resized(camera, coarse.size())));
        let standing = standing.filter(|(coarse, small)| coarse.can_show(small)).map(|(_, small)| small);
        if !self.is_painting && has_coarse_pictures(camera) {
            self.trace_resting(stage, camera, focus)?;
            if standing.is_none() {
                self.show_defocused(camera);
            }
        }
        if let Some(small) = standing {
            shown_pixels = pixel_count(&small);
            self.show_small(stage, &small, size, focus)?;
        }
        let has_splats = stage.scene.splats.is_some();
        let next = |shown_pixels: f64, pace: Option<f64>| match has_splats {
            true => coarse_camera_of_splats(camera).filter(|_| shown_pixels == 0.0),
            false => next_coarse_camera(camera, shown_pixels, pace),
        };
        while (shown_pixels == 0.0 || !self.is_painting)
            && let Some(small) = next(shown_pixels, self.coarse_pace)
        {
            shown_pixels = pixel_count(&small);
            self.show_small(stage, &small, size, focus)?;
        }
        Ok(())
    }

    /// A picture of few pixels, shown in this size.
    pub(super) fn show_small(
        &mut self,
        stage: &Stage,
        small: &Camera,
        size: [u32; 2],
        focus: &Focus,
    ) -> Result<(), SessionError> {
        self.coarse.take_if(|coarse| !coarse.can_show(small));
        let rough = [small.width, small.height];
        let defocused = self.map.as_ref().and_then(|map| self.pinhole.defocused(small, map));
        let layer = defocused.map(|(picture, _)| Arc::new(picture.layer_over(rough, size)) as _);
        let coarse = match &mut self.coarse {
            Some(coarse) => coarse,
            None => {
                self.shared.begin(PreviewActivity::RoughBaking)?;
                // Circles of a few pixels show how nodes are spaced, and few samples are soon summed.
                let (tolerance, gpu, bake_on) = (Tolerance::NONE, self.shared.gpu(), self.shared.bake_on());
                let options = FieldOptions {
                    least_margin_px: 0.0,
                    tolerance,
                    gpu,
                    bake_on,
                    light: LightQuality::Rough,
                };
                // Rough as it is, it serves a lens that is opened, too.
                let opened = spare_camera(small).unwrap_or_else(|| small.clone());
                let start = Instant::now();
                let coarse = LightField::bake(stage, &opened, focus, options, &self.shared.quick)?;
                self.coarse_pace = Some(start.elapsed().as_secs_f64() / pixel_count(small));
                self.presenter.check_glare(&coarse.baked().salf);
                self.coarse.insert(coarse)
            }
        };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let update = coarse.update_sum(small, focus, &self.shared.quick)?;
        let is_another = self.presenter.shown().is_none_or(|shown| shown.camera != *small);
        if update != SumUpdate::Unchanged || is_another {
            self.presenter.show(NewPicture {
                picture: coarse.source(),
                camera: small,
                enlarged_to: Some(size),
                layer,
                kind: PreviewKind::from(&update),
                quality: Quality::Coarse,
                seconds: start.elapsed().as_secs_f64(),
                modelled: coarse.modelled(),
                relation: match update {
                    SumUpdate::Region(rectangle) => Relation::Changed(rectangle),
                    _ => Relation::New,
                },
            });
        }
        Ok(())
    }

    /// Shows the exact picture, unless something changed while it was drawn.
    pub(super) fn show_exact(&mut self, refined: ExactDelivery) -> Result<(), SessionError> {
        let (exact, field) = match self.refinement.take_up(refined) {
            Ok(drawn) => drawn,
            Err(SessionError::Cancelled) => return Ok(()),
            Err(error) => return Err(error),
        };
        let is_of_this_map = exact.map_serial == self.presenter.map_serial;
        let is_current = is_of_this_map && self.camera.as_ref() == Some(&exact.camera);
        let viewed = self.fine.as_ref().filter(|_| is_current);
        let (Some(field), Some(viewed)) = (field, viewed) else { return Ok(()) };
        if !field.is_twin_of(viewed) || !viewed.is_up_to_date(&exact.camera) {
            return Ok(());
        }
        let costs = &mut self.presenter.costs;
        costs.viewing_psnr = Some(exact.viewing_psnr);
        costs.exact_seconds = Some(field.whole_seconds());
        self.presenter.show(NewPicture {
            picture: field.source(),
            camera: &exact.camera,
            enlarged_to: None,
            layer: None,
            relation: Relation::Overlay,
            kind: PreviewKind::Splat,
            quality: Quality::Exact,
            seconds: exact.seconds,
            modelled: field.modelled(),
        });
        self.refinement.tidy(self.fine.as_ref());
        Ok(())
    }
}
