//! The preview thread's work: processing requests.

mod idle_work;
mod relighting;
mod showing;

use crate::display::StandingPicture;
use crate::error::SessionError;
use crate::light_field::{Changes, LightField, Plan};
use crate::preview::deliveries::{FieldDelivery, FinerField, InterimField};
use crate::preview::exact_refinement::ExactRefinement;
use crate::preview::light_field_maker::{FieldOrder, FieldOrigin, LightFieldMaker, MadeField};
use crate::preview::light_refinement::LightRefinement;
use crate::preview::mailbox::Shared;
use crate::preview::picture_sizes::interim_camera;
use crate::preview::pinhole::PinholeTracer;
use crate::preview::presenter::Presenter;
use crate::preview::relighting::Relighting;
use crate::preview::request::PreviewRequest;
use crate::preview::spare_field::{SpareField, SpareTask};
use document::Stage;
use focus::{Focus, FocusMap};
use jobs::catch_panics;
use lens::Camera;
use render::LightFieldStore;
use splat::Tolerance;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Before a whole sum that takes longer than this many seconds a draft is shown: what is dragged then follows the hand.
const QUICK_SECONDS: f64 = 0.05;

/// The thread's own state.
pub(crate) struct Worker {
    shared: Arc<Shared>,
    stage: Option<Arc<Stage>>,
    camera: Option<Camera>,
    map: Option<Arc<FocusMap>>,
    coarse: Option<LightField>,
    /// Seconds that a pixel of it took to bake; `None` before the scene's first.
    coarse_pace: Option<f64>,
    fine: Option<LightField>,
    /// What the light fields show: the stage, or it in other light until there are new ones.
    shown_stage: Option<Arc<Stage>>,
    /// How the fine light field becomes one of the stage, if it shows it in another world.
    relighting: Option<Relighting>,
    /// The last fine picture, while drafts of pictures through other lenses are shown, and what it shows.
    standing: Option<(StandingPicture, Camera)>,
    /// Whether the fine light field's picture has not been shown yet.
    is_new: bool,
    /// Makes or sums the fine light field.
    maker: LightFieldMaker,
    /// What it made, until there is time to take it up.
    delivery: Option<FieldDelivery>,
    /// Draws the exact picture of the fine light field.
    refinement: ExactRefinement,
    /// Refines the light of the fine light field.
    light: LightRefinement,
    /// Bakes one for a wider aperture.
    spare: SpareField,
    /// By how many passes at most.
    light_passes: u32,
    /// What is done while nothing changes is paused until scene or camera change.
    is_background_paused: bool,
    /// For how long nothing must change until either is done; none: never.
    exact_after: Option<Duration>,
    /// A stroke is in progress.
    is_painting: bool,
    /// Tolerance of sums.
    tolerance: Tolerance,
    /// Traces pictures without blur.
    pinhole: PinholeTracer,
    /// Counts new scenes and requested bakes: results of an older epoch are discarded.
    epoch: u64,
    /// An edit is complete, and whether the fine light field still fits it has not been looked at.
    is_edit_done: bool,
    /// The light field is to be baked, whatever is in the store.
    bakes_anew: bool,
    /// Work is paused until the next change that needs it.
    is_paused: bool,
    /// The user knows that the card was lost.
    is_loss_reported: bool,
    presenter: Presenter,
}

impl Worker {
    /// `exact_after`: for how long nothing must change until the exact picture is drawn; none: never.
    /// `store`: where light fields are kept.
    pub fn new(
        shared: Arc<Shared>,
        exact_after: Option<Duration>,
        light_passes: u32,
        store: Option<LightFieldStore>,
    ) -> Self {
        Self {
            presenter: Presenter::new(shared.clone()),
            shared,
            stage: None,
            camera: None,
            map: None,
            coarse: None,
            coarse_pace: None,
            fine: None,
            shown_stage: None,
            relighting: None,
            standing: None,
            is_new: false,
            maker: LightFieldMaker::new(store),
            delivery: None,
            refinement: ExactRefinement::default(),
            light: LightRefinement::default(),
            spare: SpareField::default(),
            light_passes,
            is_background_paused: false,
            exact_after,
            is_painting: false,
            tolerance: Tolerance::VIEWING,
            pinhole: PinholeTracer::default(),
            epoch: 0,
            is_edit_done: false,
            bakes_anew: false,
            is_paused: false,
            is_loss_reported: false,
        }
    }

    /// Processes requests until the session is dropped.
    pub fn run(mut self) {
        while let Some(request) = self.shared.next_request(self.exact_after.filter(|_| self.has_idle_work()))
        {
            self.presenter.begun = Instant::now();
            let outcome = catch_panics("drawing the preview", || self.process(request));
            self.report_loss();
            self.note_memory();
            match outcome {
                Ok(()) | Err(SessionError::Cancelled) => {}
                Err(error) => {
                    if matches!(error, SessionError::Internal(_)) {
                        (self.coarse, self.fine) = (None, None);
                    }
                    self.is_paused = true;
                    self.shared.report_failure(error.to_string());
                }
            }
        }
        // They were cancelled with everything else.
        self.maker.join();
        self.refinement.join();
        self.light.join();
        self.spare.join();
    }

    fn note_memory(&mut self) {
        let fields = [self.coarse.as_ref(), self.fine.as_ref(), self.spare.field(), self.light.field()];
        let exact = [0, self.refinement.bytes()];
        let bytes = fields.into_iter().flatten().map(LightField::bytes).chain([exact]);
        self.shared.note_field_bytes(bytes.fold([0, 0], |[a, b], [c, d]| [a + c, b + d]));
    }

    /// Tells the user once that the card was lost.
    fn report_loss(&mut self) {
        if let Some(loss) = self.shared.loss_message().filter(|_| !self.is_loss_reported) {
            self.is_loss_reported = true;
            self.shared.notice(loss);
        }
    }

    fn process(&mut self, mut request: PreviewRequest) -> Result<(), SessionError> {
        let (is_idle, refined) = (request.is_idle, request.refined.take());
        let intake = self.apply_request(request);
        if let Some(refined) = refined {
            self.show_exact(refined)?;
        }
        intake?;
        let (Some(stage), Some(camera), Some(map)) = (&self.stage, &self.camera, &self.map) else {
            return Ok(());
        };
        let (stage, camera) = (stage.clone(), camera.clone());
        let focus = Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), map.clone());
        if self.is_paused && self.fine.is_none() && self.coarse.is_none() {
            return Ok(());
        }
        if is_idle && let Some(fine) = &mut self.fine {
            fine.release_room();
        }
        if is_idle && self.may_refine() {
            self.refine(camera, focus);
            return Ok(());
        }
        if is_idle && self.may_make_fields() {
            if !self.has_close_aperture() {
                self.make_field(FieldOrigin::LoadOrBake { least_margin_px: 0.0 }, &stage, &camera, focus);
                return Ok(());
            }
            if let Some(baked_camera) = self.missing_spare() {
                let (tolerance, epoch) = (self.tolerance, self.epoch);
                let task = SpareTask { stage, baked_camera, focus, tolerance, epoch };
                self.spare.start(&self.shared, self.maker.store(), task);
                return Ok(());
            }
        }
        if is_idle && let Some(passes) = self.refinable_passes() {
            self.refine_light(passes, stage, camera, focus);
            return Ok(());
        }

        self.choose_field(&camera);
        if self.fine.is_none() {
            (self.shown_stage, self.relighting) = (Some(stage.clone()), None);
        }
        self.estimate_light(&stage, &camera, &focus)?;
        self.make_relit(&stage, &camera, &focus);
        if let Some(fine) = &self.fine {
            let plan = fine.plan(&camera, &focus);
            if matches!(plan, Plan::Whole) && fine.whole_seconds() >= QUICK_SECONDS {
                if self.is_paused {
                    return Ok(());
                }
                self.show_draft(&camera, &focus)?;
            }
            return self.show_fine(plan, &stage, &camera, focus);
        }
        if !self.show_pinhole(&stage, &camera, &focus)? {
            return Ok(());
        }
        // What is kept is there sooner than the coarse picture.
        let is_stored = !self.bakes_anew && self.maker.has_stored(&stage, &camera, self.shared.baked_on());
        if !is_stored {
            self.show_coarse(&stage, &camera, &focus)?;
        }
        if !self.maker.is_at_work() && !self.is_paused {
            let origin = if std::mem::take(&mut self.bakes_anew) {
                FieldOrigin::Bake
            } else {
                FieldOrigin::LoadOrBake { least_margin_px: 0.0 }
            };
            self.make_field(origin, &stage, &camera, focus);
        }
        Ok(())
    }

    /// Works with the light field whose aperture fits the lens best; gives up those of another view.
    fn choose_field(&mut self, camera: &Camera) {
        self.spare.tidy(camera);
        // What is being made may be the light field itself, with another sum.
        if !self.maker.is_at_work()
            && self.spare.exchange(&mut self.fine, camera, self.shared.gpu())
            && let Some(fine) = &self.fine
        {
            self.shared.publish_field(self.presenter.generation, fine.baked());
            self.refinement.tidy(self.fine.as_ref());
            // Its sum may be up to date, and another picture shown.
            self.is_new = true;
        }
        if self.fine.take_if(|fine| fine.aperture_fit(camera).is_none()).is_some() {
            self.refinement.forget();
        }
    }

    /// Takes up what changed, and what was made.
    fn apply_request(&mut self, request: PreviewRequest) -> Result<(), SessionError> {
        if let Some(tolerance) = request.tolerance.filter(|tolerance| *tolerance != self.tolerance) {
            self.tolerance = tolerance;
            (self.presenter.costs.viewing_psnr, self.presenter.costs.viewing_seconds) = (None, None);
            [self.fine.as_mut(), self.spare.field_mut()]
                .into_iter()
                .flatten()
                .for_each(|field| field.set_tolerance(tolerance));
        }
        let (is_opened, has_camera) = (request.stage.is_some(), request.camera.is_some());
        self.camera = request.camera.or(self.camera.take());
        let mut changed = request.changed;
        if let Some((stage, generation)) = request.stage {
            self.stage = Some(stage);
            self.pinhole.forget();
            self.coarse_pace = None;
            self.presenter.open(generation);
        }
        if is_opened || request.bake {
            let stays = self.relight(!request.bake);
            if let (true, Some(map), Some((new_map, _))) = (stays, &self.map, &request.map)
                && map.shares_tiles_with(new_map)
            {
                changed = Changes::default();
            }
            self.refinement.forget();
            self.light.forget();
            self.spare.forget();
            self.epoch += 1;
            self.bakes_anew = request.bake;
        }
        let resumes_work = self.stage.is_some() && (has_camera || request.bake || request.edit_done);
        self.is_paused = request.pause || (self.is_paused && !resumes_work);
        self.is_background_paused = request.pause_background || (self.is_background_paused && !resumes_work);
        let is_complete = request.edit_done || is_opened;
        self.is_painting = !is_complete && (self.is_painting || request.map.is_some());
        // A stroke that goes on is no time for more.
        self.is_edit_done = request.edit_done || (self.is_edit_done && request.map.is_none());
        if let Some(tone) = request.tone {
            self.presenter.set_tone(tone);
        }
        if let Some((map, serial)) = request.map {
            self.map = Some(Arc::new(map));
            self.presenter.map_serial = serial;
        }
        for field in [&mut self.coarse, &mut self.fine].into_iter().flatten() {
            field.note(&changed);
        }
        self.maker.note(&changed);
        self.refinement.note(&changed);
        self.light.note(&changed);
        self.spare.note(&changed);
        if let Some(refined_light) = request.refined_light {
            self.light.take_back(refined_light);
        }
        let spare = request.spare.map(|spare| self.spare.take_up(spare, self.epoch));
        if let Some(interim) = request.interim {
            self.take_up_interim(interim);
        }
        self.delivery = request.delivery.or(self.delivery.take());
        let taken_up =
            spare.unwrap_or(Ok(())).and_then(|()| self.take_up()).and_then(|()| self.take_up_light());
        self.refinement.tidy(self.fine.as_ref());
        if request.is_card_lost {
            self.presenter.forget_shown();
            self.is_new = true;
        }
        taken_up
    }

    /// Takes up the light field that was made first, in place of the coarse one.
    fn take_up_interim(&mut self, interim: InterimField) {
        let (mut field, epoch) = self.maker.take_up_interim(interim);
        if epoch == self.epoch && self.fine.is_none() {
            field.set_tolerance(self.tolerance);
            self.coarse = Some(field);
        }
    }

    /// Takes up the light field that was made; not while a stroke goes on that the old one shows.
    fn take_up(&mut self) -> Result<(), SessionError> {
        let has_time = !self.is_painting || self.fine.is_none();
        let Some(delivery) = self.delivery.take_if(|_| has_time) else { return Ok(()) };
        match self.maker.take_up(delivery) {
            Ok(Some(MadeField { mut field, stage, epoch })) => {
                if epoch == self.epoch {
                    self.relighting = None;
                } else {
                    // Made for the world of before, it is nearer to the new one than what stands, if anything does.
                    let relighting = self.fine.as_ref().and_then(|_| self.relighting_from(&stage));
                    let Some(relighting) = relighting else { return Ok(()) };
                    self.relighting = Some(relighting);
                }
                self.shown_stage = Some(stage);
                field.set_tolerance(self.tolerance);
                self.presenter.check_glare(&field.baked().salf);
                self.shared.publish_field(self.presenter.generation, field.baked());
                if let (Some(replaced), Some(camera)) = (self.fine.replace(field), &self.camera) {
                    self.spare.offer(replaced, camera, self.shared.gpu());
                }
                self.is_new = true;
                // One from the store may be of another focus.
                self.is_edit_done = true;
                Ok(())
            }
            Ok(_) | Err(SessionError::Cancelled) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Takes up the light field of refined light, if it is better; not while a stroke goes on, or the old one is worked with.
    fn take_up_light(&mut self) -> Result<(), SessionError> {
        let (Some(fine), Some(camera), Some(stage)) = (&self.fine, &self.camera, &self.stage) else {
            return Ok(());
        };
        if self.is_painting || self.maker.is_at_work() {
            return Ok(());
        }
        let displayed_passes = fine.light_passes();
        let Some(finer) = self.light.take_up(self.epoch, displayed_passes, self.shared.gpu())? else {
            return Ok(());
        };
        let FinerField { mut field, errors, seconds } = finer;
        if !field.can_show(camera) || field.light_passes() <= displayed_passes {
            return Ok(());
        }
        self.maker.save(stage, &field, seconds);
        if displayed_passes == 0 {
            self.presenter.costs.light_psnr = errors.map(|errors| numerics::psnr(errors.displayed));
        }
        field.set_tolerance(self.tolerance);
        self.shared.publish_field(self.presenter.generation, field.baked());
        self.fine = Some(field);
        self.is_new = true;
        Ok(())
    }

    /// Makes the fine light field and sums it, on a thread of its own.
    fn make_field(&mut self, origin: FieldOrigin, stage: &Arc<Stage>, camera: &Camera, focus: Focus) {
        let (stage, camera) = (stage.clone(), camera.clone());
        // With a fine picture already shown, an interim one would be worse.
        let interim = if self.fine.is_none() { interim_camera(&camera) } else { None };
        let (tolerance, epoch) = (self.tolerance, self.epoch);
        let order = FieldOrder { origin, stage, camera, interim, focus, tolerance, epoch };
        self.maker.start(&self.shared, order);
    }
}
