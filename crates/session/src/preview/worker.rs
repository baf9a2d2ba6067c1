//! What the preview thread does with its wishes.

use super::activity::PreviewActivity;
use super::coarse::{between_of, coarse_of};
use super::deliveries::{Between, Delivery, Finer, Refined};
use super::light_refinement::{self, LightRefinement};
use super::mailbox::Shared;
use super::maker::{Begin, LightFieldMaker, Order};
use super::picture::{PreviewKind, Quality};
use super::presenter::{Made, Presenter, Relation};
use super::refinement::{Refinement, Task};
use super::wishes::Wishes;
use crate::display::Source;
use crate::document::Stage;
use crate::error::SessionError;
use crate::jobs::guarded;
use crate::light_field::{
    Brought, FieldOptions, LightField, LightFieldStore, LightQuality, Modelled, Plan, light, may_be_refined,
};
use baselines::FirstHits;
use focus::{Focus, FocusMap};
use lens::Camera;
use splat::Tolerance;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A whole sum that takes less than this many seconds is made at once for every new lens: two frames.
const QUICK_SECONDS: f64 = 0.033;

impl From<&Brought> for PreviewKind {
    fn from(brought: &Brought) -> Self {
        if matches!(brought, Brought::Update(_)) { Self::Update } else { Self::Splat }
    }
}

/// The thread's own state.
pub(crate) struct Worker {
    shared: Arc<Shared>,
    stage: Option<Arc<Stage>>,
    camera: Option<Camera>,
    map: Option<Arc<FocusMap>>,
    coarse: Option<LightField>,
    fine: Option<LightField>,
    /// Whether the fine light field's picture has not been shown yet.
    is_new: bool,
    /// Makes or sums the fine light field.
    maker: LightFieldMaker,
    /// What it made, until there is time to take it up.
    delivery: Option<Delivery>,
    /// Draws the exact picture of the fine light field.
    refinement: Refinement,
    /// Refines the light of the fine light field.
    light: LightRefinement,
    /// By how many passes at most.
    light_passes: u32,
    /// The user wants no light refined until another scene or camera is looked at.
    is_light_held: bool,
    /// For how long nothing must change until either is done; none: never.
    exact_after: Option<Duration>,
    /// A stroke goes on.
    is_painting: bool,
    /// How coarse sums may be.
    tolerance: Tolerance,
    /// Counts scenes and bakes that were asked for anew: what is of an older epoch is of no use.
    epoch: u64,
    /// An edit is complete, and whether the fine light field still fits it has not been looked at.
    is_settled: bool,
    /// The light field is to be baked, whatever is in the store.
    bakes_anew: bool,
    /// The user wants no more work until the next change that needs it.
    is_held: bool,
    /// The user knows that the card was lost.
    is_loss_told: bool,
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
            fine: None,
            is_new: false,
            maker: LightFieldMaker::new(store),
            delivery: None,
            refinement: Refinement::default(),
            light: LightRefinement::default(),
            light_passes,
            is_light_held: false,
            exact_after,
            is_painting: false,
            tolerance: Tolerance::VIEWING,
            epoch: 0,
            is_settled: false,
            bakes_anew: false,
            is_held: false,
            is_loss_told: false,
        }
    }

    /// Follows wishes until the session goes.
    pub fn run(mut self) {
        while let Some(wishes) = self.shared.next(self.exact_after.filter(|_| self.is_idle_of_use())) {
            self.presenter.begun = Instant::now();
            let followed = guarded("drawing the preview", || self.follow(wishes));
            self.tell_loss();
            match followed {
                Ok(()) | Err(SessionError::Cancelled) => {}
                Err(error) => {
                    if matches!(error, SessionError::Internal(_)) {
                        (self.coarse, self.fine) = (None, None);
                    }
                    self.is_held = true;
                    self.shared.fail(error.to_string());
                }
            }
        }
        // They were cancelled with everything else.
        self.maker.join();
        self.refinement.join();
        self.light.join();
    }

    /// Tells the user once that the card was lost.
    fn tell_loss(&mut self) {
        if let Some(loss) = self.shared.loss().filter(|_| !self.is_loss_told) {
            self.is_loss_told = true;
            self.shared.notice(loss);
        }
    }

    fn follow(&mut self, mut wishes: Wishes) -> Result<(), SessionError> {
        let (is_idle, refined) = (wishes.is_idle, wishes.refined.take());
        let taken_in = self.take_in(wishes);
        if let Some(refined) = refined {
            self.show_exact(refined)?;
        }
        taken_in?;
        let (Some(stage), Some(camera), Some(map)) = (&self.stage, &self.camera, &self.map) else {
            return Ok(());
        };
        let (stage, camera) = (stage.clone(), camera.clone());
        let focus = Focus::painted(stage.scene.clone(), stage.atlas.clone(), map.clone());
        if self.is_held && self.fine.is_none() && self.coarse.is_none() {
            return Ok(());
        }
        if is_idle && self.may_refine() {
            self.refine(camera, focus);
            return Ok(());
        }
        if is_idle && let Some(passes) = self.may_refine_light() {
            self.refine_light(passes, stage, camera, focus);
            return Ok(());
        }

        if self.fine.take_if(|fine| !fine.serves(&camera)).is_some() {
            self.refinement.forget();
        }
        let plan =
            self.fine.as_ref().map(|fine| (fine.plan(&camera, &focus), fine.whole_seconds() < QUICK_SECONDS));
        if let Some((plan, is_quick)) = plan
            && (is_quick || matches!(plan, Plan::Move(_)))
        {
            return self.show_fine(plan, &stage, &camera, focus);
        }
        self.show_pinhole(&stage, &camera, &focus)?;
        // What is kept is there sooner than the coarse picture.
        let is_kept = self.fine.is_none() && !self.bakes_anew && self.maker.has_stored(&stage, &camera);
        if !is_kept {
            self.show_coarse(&stage, &camera, &focus)?;
        }
        if !self.maker.is_at_work() && !self.is_held {
            let begin = match self.fine.take() {
                Some(fine) => Begin::Sum(Box::new(fine)),
                None if std::mem::take(&mut self.bakes_anew) => Begin::Bake,
                None => Begin::Find { least_margin_px: 0.0 },
            };
            self.make_field(begin, &stage, &camera, focus);
        }
        Ok(())
    }

    /// Takes up what changed, and what was made.
    fn take_in(&mut self, wishes: Wishes) -> Result<(), SessionError> {
        if let Some(tolerance) = wishes.tolerance.filter(|tolerance| *tolerance != self.tolerance) {
            self.tolerance = tolerance;
            (self.presenter.costs.viewing_psnr, self.presenter.costs.viewing_seconds) = (None, None);
            for field in [&mut self.coarse, &mut self.fine].into_iter().flatten() {
                field.set_tolerance(tolerance);
            }
        }
        let is_opened = wishes.stage.is_some();
        if let Some((stage, generation)) = wishes.stage {
            self.stage = Some(stage);
            self.presenter.open(generation);
        }
        if is_opened || wishes.bake {
            (self.coarse, self.fine) = (None, None);
            self.refinement.forget();
            self.light.forget();
            self.epoch += 1;
            self.bakes_anew = wishes.bake;
        }
        let wants_work = self.stage.is_some() && (wishes.camera.is_some() || wishes.bake || wishes.settle);
        self.is_held = wishes.hold || (self.is_held && !wants_work);
        self.is_light_held = wishes.hold_light || (self.is_light_held && !wants_work);
        let is_complete = wishes.settle || is_opened;
        self.is_painting = !is_complete && (self.is_painting || wishes.map.is_some());
        // A stroke that goes on is no time for more.
        self.is_settled = wishes.settle || (self.is_settled && wishes.map.is_none());
        self.camera = wishes.camera.or(self.camera.take());
        if let Some(tone) = wishes.tone {
            self.presenter.set_tone(tone);
        }
        if let Some((map, serial)) = wishes.map {
            self.map = Some(Arc::new(map));
            self.presenter.map_serial = serial;
        }
        for field in [&mut self.coarse, &mut self.fine].into_iter().flatten() {
            field.note(&wishes.changed);
        }
        self.maker.note(&wishes.changed);
        self.refinement.note(&wishes.changed);
        self.light.note(&wishes.changed);
        if let Some(refined_light) = wishes.refined_light {
            self.light.take_back(refined_light);
        }
        if let Some(between) = wishes.between {
            self.take_up_between(between);
        }
        self.delivery = wishes.delivery.or(self.delivery.take());
        let taken_up = self.take_up().and_then(|()| self.take_up_light());
        self.refinement.tidy(self.fine.as_ref());
        taken_up
    }

    /// Takes up the light field that was made first, in place of the coarse one.
    fn take_up_between(&mut self, between: Between) {
        let (mut field, epoch) = self.maker.take_up_between(between);
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
            Ok((mut field, epoch)) if epoch == self.epoch => {
                field.set_tolerance(self.tolerance);
                self.presenter.look_for_glare(&field.baked().salf);
                self.shared.publish_field(self.presenter.generation, field.baked());
                self.fine = Some(field);
                self.is_new = true;
                // One from the store may be of another focus.
                self.is_settled = true;
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
        let standing = fine.light_passes();
        let Some(finer) = self.light.take_up(self.epoch, standing)? else { return Ok(()) };
        let Finer { mut field, errors, seconds } = finer;
        if !field.serves(camera) || field.light_passes() <= standing {
            return Ok(());
        }
        self.maker.keep(stage, &field, seconds);
        if standing == 0 {
            self.presenter.costs.light_psnr = errors.map(|errors| project::psnr(errors.standing));
        }
        field.set_tolerance(self.tolerance);
        self.shared.publish_field(self.presenter.generation, field.baked());
        self.fine = Some(field);
        self.is_new = true;
        Ok(())
    }

    /// Brings the fine picture up to date; then, after an edit, sees whether another light field would serve better.
    fn show_fine(
        &mut self,
        plan: Plan,
        stage: &Arc<Stage>,
        camera: &Camera,
        focus: Focus,
    ) -> Result<(), SessionError> {
        let Some(fine) = &mut self.fine else { return Ok(()) };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let brought = fine.carry_out(plan, camera, &focus, &self.shared.quick)?;
        let light_passes = fine.light_passes();
        let is_new = std::mem::take(&mut self.is_new);
        if brought != Brought::Nothing || is_new {
            let is_exact = self.tolerance == Tolerance::NONE;
            let costs = &mut self.presenter.costs;
            costs.light_passes = light_passes;
            if light_passes == 0 {
                costs.light_psnr = None;
            }
            if brought == Brought::Whole || is_new {
                costs.viewing_psnr = None;
                let known = if is_exact { &mut costs.exact_seconds } else { &mut costs.viewing_seconds };
                *known = Some(fine.whole_seconds());
            }
            // The sum of a new one was made elsewhere.
            let elsewhere = if is_new { fine.whole_seconds() } else { 0.0 };
            self.presenter.show(Made {
                picture: fine.source(),
                camera,
                enlarged_to: None,
                kind: PreviewKind::from(&brought),
                quality: if is_exact { Quality::Exact } else { Quality::Viewing },
                seconds: start.elapsed().as_secs_f64() + elsewhere,
                modelled: fine.modelled(),
                relation: match brought {
                    Brought::Update(rectangle) if !is_new => Relation::Changed(rectangle),
                    _ => Relation::New,
                },
            });
        }
        if !self.is_settled || self.maker.is_at_work() || self.is_held {
            return Ok(());
        }
        self.is_settled = false;
        if let Some(least_margin_px) = fine.is_outgrown(camera, &focus) {
            self.coarse = None;
            self.make_field(Begin::Find { least_margin_px }, stage, camera, focus);
        }
        Ok(())
    }

    /// The picture without blur, if the view is new; of fewer pixels where one between is due.
    fn show_pinhole(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        if self.presenter.shown().is_some_and(|shown| same_view(&shown.camera, camera)) {
            return Ok(());
        }
        self.shared.begin(PreviewActivity::Tracing)?;
        let start = Instant::now();
        let camera = &between_of(camera).unwrap_or_else(|| camera.clone());
        let radiance = light(&stage.tracer, camera, LightQuality::Rough, &self.shared.quick)?;
        let hits = FirstHits::trace(&stage.tracer, &*radiance, focus, camera, &self.shared.quick)?;
        self.presenter.show(Made {
            picture: Source::Here(&hits.picture()),
            camera,
            enlarged_to: None,
            relation: Relation::New,
            kind: PreviewKind::Pinhole,
            quality: Quality::Coarse,
            seconds: start.elapsed().as_secs_f64(),
            modelled: Modelled::default(),
        });
        Ok(())
    }

    /// Pictures of few pixels, each of more than the one before; begins with the best that need not be baked, and ends there
    /// while a stroke waits for more.
    fn show_coarse(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        let size = [camera.width, camera.height];
        let serves = |small: &Camera| self.coarse.as_ref().is_some_and(|coarse| coarse.serves(small));
        if let Some(between) = between_of(camera).filter(serves) {
            return self.show_small(stage, &between, size, focus);
        }
        let sizes = coarse_of(camera);
        let first = sizes.iter().rposition(serves).unwrap_or(0);
        let count = if self.is_painting { 1 } else { sizes.len() };
        sizes[first..].iter().take(count).try_for_each(|small| self.show_small(stage, small, size, focus))
    }

    /// A picture of few pixels, shown in this size.
    fn show_small(
        &mut self,
        stage: &Stage,
        small: &Camera,
        size: [u32; 2],
        focus: &Focus,
    ) -> Result<(), SessionError> {
        self.coarse.take_if(|coarse| !coarse.serves(small));
        let coarse = match &mut self.coarse {
            Some(coarse) => coarse,
            None => {
                self.shared.begin(PreviewActivity::RoughBaking)?;
                let (tolerance, gpu) = (self.tolerance, self.shared.gpu());
                let how = FieldOptions { least_margin_px: 0.0, tolerance, gpu, light: LightQuality::Rough };
                let coarse = LightField::bake(stage, small, focus, how, &self.shared.quick)?;
                self.presenter.look_for_glare(&coarse.baked().salf);
                self.coarse.insert(coarse)
            }
        };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let brought = coarse.bring_up(small, focus, &self.shared.quick)?;
        let is_another = self.presenter.shown().is_none_or(|shown| shown.camera != *small);
        if brought != Brought::Nothing || is_another {
            self.presenter.show(Made {
                picture: coarse.source(),
                camera: small,
                enlarged_to: Some(size),
                kind: PreviewKind::from(&brought),
                quality: Quality::Coarse,
                seconds: start.elapsed().as_secs_f64(),
                modelled: coarse.modelled(),
                relation: match brought {
                    Brought::Update(rectangle) => Relation::Changed(rectangle),
                    _ => Relation::New,
                },
            });
        }
        Ok(())
    }

    /// Makes the fine light field and sums it, on a thread of its own.
    fn make_field(&mut self, begin: Begin, stage: &Arc<Stage>, camera: &Camera, focus: Focus) {
        let (stage, camera) = (stage.clone(), camera.clone());
        // Where a fine picture stands already, none of fewer pixels is wanted.
        let between = if self.fine.is_none() { between_of(&camera) } else { None };
        let (tolerance, epoch) = (self.tolerance, self.epoch);
        let order = Order { begin, stage, camera, between, focus, tolerance, epoch };
        self.maker.start(&self.shared, order);
    }

    /// Whether the picture is up to date and could be better.
    fn may_refine(&self) -> bool {
        let is_viewing = self.presenter.shown().is_some_and(|shown| shown.quality == Quality::Viewing);
        let field = self.fine.as_ref().zip(self.camera.as_ref());
        let is_up_to_date = field.is_some_and(|(fine, camera)| fine.is_up_to_date(camera));
        let is_quiet = !self.is_held && !self.is_painting && !self.maker.is_at_work();
        let is_quiet = is_quiet && !self.shared.is_exporting();
        is_viewing && is_up_to_date && is_quiet && !self.refinement.is_at_work()
    }

    /// Whether there is anything to do while nothing is wished.
    fn is_idle_of_use(&self) -> bool {
        self.may_refine() || self.may_refine_light().is_some()
    }

    /// By how many passes the light of the picture may be refined, which is exact but for that.
    fn may_refine_light(&self) -> Option<u32> {
        let (fine, camera, stage) = (self.fine.as_ref()?, self.camera.as_ref()?, self.stage.as_ref()?);
        let is_exact = self.presenter.shown().is_some_and(|shown| shown.quality == Quality::Exact);
        let is_quiet = !self.is_held && !self.is_light_held && !self.is_painting && !self.maker.is_at_work();
        let is_quiet = is_quiet && !self.shared.is_exporting() && !self.light.is_at_work();
        let may = is_exact && is_quiet && fine.is_up_to_date(camera) && may_be_refined(&stage.tracer);
        self.light.next_passes(camera, fine.light_passes(), self.light_passes).filter(|_| may)
    }

    /// Begins to refine the light, if nothing was wished meanwhile.
    fn refine_light(&mut self, passes: u32, stage: Arc<Stage>, camera: Camera, focus: Focus) {
        let (tolerance, epoch, exposure) = (self.tolerance, self.epoch, self.presenter.exposure());
        let Some(fine) = &mut self.fine else { return };
        let margin_px = f64::from(fine.baked().salf.margin_px);
        let Ok(standing) = fine.brought().cloned().map(Arc::new) else { return };
        let task = light_refinement::Task {
            stage,
            camera,
            focus,
            tolerance,
            standing,
            exposure,
            margin_px,
            passes,
            epoch,
        };
        self.light.start(&self.shared, task);
    }

    /// Begins to draw the exact picture, if nothing was wished meanwhile.
    fn refine(&mut self, camera: Camera, focus: Focus) {
        let Some(fine) = &mut self.fine else { return };
        let brought = || fine.brought().ok().cloned().map(Arc::new);
        let Some(viewing) = self.presenter.followed().or_else(brought) else { return };
        let (exposure, map_serial) = (self.presenter.exposure(), self.presenter.map_serial);
        let task = Task { camera, focus, viewing, exposure, map_serial };
        self.refinement.start(&self.shared, fine, task);
    }

    /// Shows the exact picture, unless something changed while it was drawn.
    fn show_exact(&mut self, refined: Refined) -> Result<(), SessionError> {
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
        self.presenter.show(Made {
            picture: field.source(),
            camera: &exact.camera,
            enlarged_to: None,
            relation: Relation::Better,
            kind: PreviewKind::Splat,
            quality: Quality::Exact,
            seconds: exact.seconds,
            modelled: field.modelled(),
        });
        self.refinement.tidy(self.fine.as_ref());
        Ok(())
    }
}

/// Whether the two show the same view, whatever their lens and size.
fn same_view(a: &Camera, b: &Camera) -> bool {
    (a.yfov, a.shift, a.camera_to_world) == (b.yfov, b.shift, b.camera_to_world)
        && (a.aspect() - b.aspect()).abs() < 0.1 * b.aspect()
}
