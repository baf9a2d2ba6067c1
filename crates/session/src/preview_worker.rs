//! What the preview thread does with its wishes.

use crate::job::{among_others, guarded};
use crate::light_field::{Brought, Changes, FieldOptions, LightField};
use crate::picture_ring::{PictureRing, Rectangle, whole};
use crate::preview::{Delivery, Shared, Wishes};
use crate::refinement::{Refined, Refinement, Task};
use crate::render::light;
use crate::screen::Patch;
use crate::tone::rectangle_to_screen;
use crate::{
    DrawingCosts, Modelled, Preview, PreviewActivity, PreviewKind, Quality, SessionError, Stage, Tone,
};
use baselines::FirstHits;
use focus::{Focus, FocusMap};
use lens::{Camera, Picture};
use progress::Stage as Share;
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Sides of the coarse picture are this share of the preview's: a ninth of the work.
const COARSE: f64 = 1.0 / 3.0;

/// Below this longest side, px, a picture is quick enough to need no coarse one.
const SMALLEST_COARSE: u32 = 48;

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
    /// How many changes the map holds.
    map_serial: u64,
    coarse: Option<LightField>,
    fine: Option<LightField>,
    /// Whether the fine light field's picture has not been shown yet.
    is_new: bool,
    /// Makes or sums the fine light field.
    helper: Option<JoinHandle<()>>,
    /// Draws the exact picture of the fine light field.
    refinement: Refinement,
    /// For how long nothing must change until it does; none: never.
    exact_after: Option<Duration>,
    /// A stroke goes on.
    is_painting: bool,
    /// How coarse sums may be.
    tolerance: Tolerance,
    /// What pictures cost, where that is known.
    costs: DrawingCosts,
    /// Counts scenes and bakes that were asked for anew: what is of an older epoch is of no use.
    epoch: u64,
    /// What changed since the helper took its snapshot of the map.
    since: Changes,
    /// An edit is complete, and whether the fine light field still fits it has not been looked at.
    is_settled: bool,
    /// The user wants no more work until the next change that needs it.
    is_held: bool,
    /// The newest picture.
    shown: Option<Preview>,
    /// It and those of before.
    pictures: PictureRing,
    /// How pictures are put on screen.
    tone: Tone,
    generation: u64,
    last_id: u64,
}

impl Worker {
    /// `exact_after`: for how long nothing must change until the exact picture is drawn; none: never.
    pub fn new(shared: Arc<Shared>, exact_after: Option<Duration>) -> Self {
        Self {
            shared,
            stage: None,
            camera: None,
            map: None,
            map_serial: 0,
            coarse: None,
            fine: None,
            is_new: false,
            helper: None,
            refinement: Refinement::default(),
            exact_after,
            is_painting: false,
            tolerance: Tolerance::VIEWING,
            costs: DrawingCosts::default(),
            epoch: 0,
            since: Changes::default(),
            is_settled: false,
            is_held: false,
            shown: None,
            pictures: PictureRing::default(),
            tone: Tone::default(),
            generation: 0,
            last_id: 0,
        }
    }

    /// Follows wishes until the session goes.
    pub fn run(mut self) {
        while let Some(wishes) = self.shared.next(self.exact_after.filter(|_| self.may_refine())) {
            match guarded("drawing the preview", || self.follow(wishes)) {
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
        if let Some(helper) = self.helper.take() {
            // It was cancelled with everything else.
            let _ = helper.join();
        }
        self.refinement.join();
    }

    /// Whether the picture is up to date and could be better.
    fn may_refine(&self) -> bool {
        let is_viewing = self.shown.as_ref().is_some_and(|shown| shown.quality == Quality::Viewing);
        let field = self.fine.as_ref().zip(self.camera.as_ref());
        let is_up_to_date = field.is_some_and(|(fine, camera)| fine.is_up_to_date(camera));
        let is_quiet = !self.is_held && !self.is_painting && self.helper.is_none();
        is_viewing && is_up_to_date && is_quiet && !self.refinement.is_at_work()
    }

    /// Begins to draw the exact picture, if nothing was wished meanwhile.
    fn refine(&mut self, camera: Camera, focus: Focus) {
        let (Some(fine), Some(viewing)) = (&self.fine, self.pictures.followed()) else { return };
        let (exposure, map_serial) = (self.tone.exposure, self.map_serial);
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
        let is_current = exact.map_serial == self.map_serial && self.camera.as_ref() == Some(&exact.camera);
        let viewed = self.fine.as_ref().filter(|_| is_current);
        let (Some(field), Some(viewed)) = (field, viewed) else { return Ok(()) };
        if !field.is_twin_of(viewed) || !viewed.is_up_to_date(&exact.camera) {
            return Ok(());
        }
        self.costs.viewing_psnr = Some(exact.viewing_psnr);
        self.costs.exact_seconds = Some(field.whole_seconds());
        let (picture, changed) = self.pictures.overlay(field.picture());
        let (kind, modelled) = (PreviewKind::Splat, field.modelled());
        let quality = Quality::Exact;
        let made = Made { picture, changed, kind, quality, seconds: exact.seconds, modelled };
        self.publish(made, &exact.camera);
        self.refinement.tidy(self.fine.as_ref());
        Ok(())
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

        if self.fine.take_if(|fine| !fine.serves(&camera)).is_some() {
            self.refinement.forget();
        }
        if let Some(fine) = &mut self.fine
            && (fine.whole_seconds() < QUICK_SECONDS || !fine.needs_whole_sum(&camera))
        {
            self.shared.begin(PreviewActivity::Splatting)?;
            let start = Instant::now();
            let brought = fine.bring_up(&camera, &focus, &self.shared.quick)?;
            if brought != Brought::Nothing || self.is_new {
                // The helper's sum took its time elsewhere.
                let elsewhere = if self.is_new { fine.whole_seconds() } else { 0.0 };
                let (picture, changed) = match &brought {
                    Brought::Update(rows) if !self.is_new => {
                        self.pictures.follow(fine.picture(), rows.clone())
                    }
                    _ => (self.pictures.begin(fine.picture()), Some(whole(fine.picture()))),
                };
                let (kind, modelled) = (PreviewKind::from(&brought), fine.modelled());
                let seconds = start.elapsed().as_secs_f64() + elsewhere;
                let is_exact = self.tolerance == Tolerance::NONE;
                let quality = if is_exact { Quality::Exact } else { Quality::Viewing };
                if brought == Brought::Whole || self.is_new {
                    self.costs.viewing_psnr = None;
                    let known = if is_exact {
                        &mut self.costs.exact_seconds
                    } else {
                        &mut self.costs.viewing_seconds
                    };
                    *known = Some(fine.whole_seconds());
                }
                self.is_new = false;
                self.publish(Made { picture, changed, kind, quality, seconds, modelled }, &camera);
            }
            let may_bake = self.is_settled && self.helper.is_none() && !self.is_held;
            let fine = self.fine.as_mut().filter(|_| may_bake);
            self.is_settled &= !may_bake;
            if let Some(least_margin_px) = fine.and_then(|fine| fine.is_outgrown(&camera, &focus)) {
                self.coarse = None;
                self.start_helper(&stage, &camera, focus, Begin::Bake { least_margin_px });
            }
            return Ok(());
        }
        self.show_coarse(&stage, &camera, &focus)?;
        if self.helper.is_none() && !self.is_held {
            let unsummed = self.fine.take().map(|fine| Begin::Sum(Box::new(fine)));
            let begin = unsummed.unwrap_or(Begin::Bake { least_margin_px: 0.0 });
            self.start_helper(&stage, &camera, focus, begin);
        }
        Ok(())
    }

    /// Takes up what changed, and what the helper brought.
    fn take_in(&mut self, wishes: Wishes) -> Result<(), SessionError> {
        let mut failed = Ok(());
        if let Some(tolerance) = wishes.tolerance.filter(|tolerance| *tolerance != self.tolerance) {
            self.tolerance = tolerance;
            (self.costs.viewing_psnr, self.costs.viewing_seconds) = (None, None);
            for field in [&mut self.coarse, &mut self.fine].into_iter().flatten() {
                field.set_tolerance(tolerance);
            }
        }
        if let Some(delivery) = wishes.delivery {
            if let Some(helper) = self.helper.take() {
                // Its result is here; its panics were caught.
                let _ = helper.join();
            }
            let since = std::mem::take(&mut self.since);
            match delivery.made {
                Ok(mut field) => {
                    field.note(&since);
                    field.set_tolerance(self.tolerance);
                    self.fine = Some(field).filter(|_| delivery.epoch == self.epoch);
                    self.is_new = true;
                    if let Some(field) = &self.fine {
                        self.shared.publish_field(self.generation, field.baked());
                    }
                }
                Err(SessionError::Cancelled) => {}
                Err(error) => failed = Err(error),
            }
        }
        let is_opened = wishes.stage.is_some();
        if let Some((stage, generation)) = wishes.stage {
            self.stage = Some(stage);
            self.generation = generation;
            (self.coarse, self.fine, self.shown) = (None, None, None);
            self.costs = DrawingCosts::default();
            self.refinement.forget();
            self.epoch += 1;
        }
        if wishes.bake {
            (self.coarse, self.fine) = (None, None);
            self.refinement.forget();
            self.epoch += 1;
        }
        let wants_work = self.stage.is_some() && (wishes.camera.is_some() || wishes.bake || wishes.settle);
        self.is_held = wishes.hold || (self.is_held && !wants_work);
        let is_complete = wishes.settle || is_opened;
        self.is_painting = !is_complete && (self.is_painting || wishes.map.is_some());
        // A stroke that goes on is no time for more.
        self.is_settled = wishes.settle || (self.is_settled && wishes.map.is_none());
        self.camera = wishes.camera.or(self.camera.take());
        if let Some(tone) = wishes.tone.filter(|tone| *tone != self.tone) {
            self.tone = tone;
            self.show_again();
        }
        if let Some((map, serial)) = wishes.map {
            (self.map, self.map_serial) = (Some(Arc::new(map)), serial);
        }
        for field in [&mut self.coarse, &mut self.fine].into_iter().flatten() {
            field.note(&wishes.changed);
        }
        self.since.join(&wishes.changed);
        self.refinement.note(&wishes.changed);
        self.refinement.tidy(self.fine.as_ref());
        failed
    }

    /// The pinhole picture if the view is new, then the picture of few pixels.
    fn show_coarse(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        let small = coarse_of(camera);
        let start = Instant::now();
        if !self.shown.as_ref().is_some_and(|shown| same_view(&shown.camera, camera)) {
            self.shared.begin(PreviewActivity::Baking)?;
            let radiance = light(&stage.tracer, camera);
            let hits = FirstHits::trace(&stage.tracer, &radiance, focus, camera, &self.shared.quick)?;
            let picture = self.pictures.begin(&hits.picture());
            let made = Made {
                changed: Some(whole(&picture)),
                picture,
                kind: PreviewKind::Pinhole,
                quality: Quality::Coarse,
                seconds: start.elapsed().as_secs_f64(),
                modelled: Modelled::default(),
            };
            self.publish(made, camera);
        }
        let Some(small) = small else { return Ok(()) };
        self.coarse.take_if(|coarse| !coarse.serves(&small));
        let coarse = match &mut self.coarse {
            Some(coarse) => coarse,
            None => {
                self.shared.begin(PreviewActivity::Baking)?;
                let how = FieldOptions { least_margin_px: 0.0, tolerance: self.tolerance };
                self.coarse.insert(LightField::bake(stage, &small, focus, how, &self.shared.quick)?)
            }
        };
        self.shared.begin(PreviewActivity::Splatting)?;
        let start = Instant::now();
        let brought = coarse.bring_up(&small, focus, &self.shared.quick)?;
        if brought != Brought::Nothing || self.shown.as_ref().is_none_or(|shown| shown.camera != small) {
            let (picture, changed) = match &brought {
                Brought::Update(rows) => self.pictures.follow(coarse.picture(), rows.clone()),
                _ => (self.pictures.begin(coarse.picture()), Some(whole(coarse.picture()))),
            };
            let (kind, modelled) = (PreviewKind::from(&brought), coarse.modelled());
            let seconds = start.elapsed().as_secs_f64();
            let quality = Quality::Coarse;
            self.publish(Made { picture, changed, kind, quality, seconds, modelled }, &small);
        }
        Ok(())
    }

    /// Makes the fine light field and sums it, on a thread of its own.
    fn start_helper(&mut self, stage: &Arc<Stage>, camera: &Camera, focus: Focus, begin: Begin) {
        if !self.shared.begin_helper() {
            return;
        }
        let tolerance = self.tolerance;
        self.since = Changes::default();
        let (shared, stage, camera, epoch) = (self.shared.clone(), stage.clone(), camera.clone(), self.epoch);
        let work = move || {
            let make = || {
                let mut field = match begin {
                    Begin::Sum(field) => *field,
                    Begin::Bake { least_margin_px } => {
                        let how = FieldOptions { least_margin_px, tolerance };
                        let baking = Share::new(&shared.progress, 0.0, 0.7);
                        LightField::bake(&stage, &camera, &focus, how, &baking)?
                    }
                };
                shared.helper_sums();
                field.bring_up(&camera, &focus, &Share::new(&shared.progress, 0.7, 1.0))?;
                field.survey(&camera, &focus);
                Ok(field)
            };
            let made = guarded("drawing the preview", || among_others(make));
            shared.deliver(Delivery { made, epoch });
        };
        let thread = std::thread::Builder::new().name("light field".into()).stack_size(16 << 20).spawn(work);
        match thread {
            Ok(thread) => self.helper = Some(thread),
            Err(error) => {
                let made = Err(SessionError::TryAgain(format!("no thread: {error} (try again)")));
                self.shared.deliver(Delivery { made, epoch });
            }
        }
    }

    /// Shows a picture.
    fn publish(&mut self, made: Made, camera: &Camera) {
        let Made { picture, changed, kind, quality, seconds, modelled } = made;
        self.last_id += 1;
        let preview = Preview {
            id: self.last_id,
            picture,
            kind,
            quality,
            costs: self.costs,
            camera: camera.clone(),
            seconds,
            modelled,
            map_serial: self.map_serial,
            generation: self.generation,
        };
        self.shown = Some(preview.clone());
        self.put_on_screen(preview, changed);
    }

    /// Shows the newest picture by another tone.
    fn show_again(&mut self) {
        if let Some(mut preview) = self.shown.clone() {
            self.last_id += 1;
            preview.id = self.last_id;
            let all = whole(&preview.picture);
            self.put_on_screen(preview, Some(all));
        }
    }

    fn put_on_screen(&self, preview: Preview, changed: Option<Rectangle>) {
        let patch = changed.map(|rectangle| Patch {
            size: [preview.picture.width, preview.picture.height],
            pixels: rectangle_to_screen(&preview.picture, self.tone, rectangle.clone()),
            rectangle,
        });
        self.shared.publish(preview, patch);
    }
}

/// What the helper begins with.
enum Begin {
    /// A light field that is there.
    Sum(Box<LightField>),
    /// None: it is baked, with a margin of at least this many pixels.
    Bake { least_margin_px: f64 },
}

/// A picture that was made.
struct Made {
    picture: Arc<Picture>,
    /// Where it differs from the one before.
    changed: Option<Rectangle>,
    kind: PreviewKind,
    quality: Quality,
    seconds: f64,
    modelled: Modelled,
}

/// The camera of the coarse picture; none where the picture is small anyway.
fn coarse_of(camera: &Camera) -> Option<Camera> {
    let scaled = |side: u32| ((side as f64 * COARSE).round() as u32).max(1);
    let (width, height) = (scaled(camera.width), scaled(camera.height));
    (width.max(height) >= SMALLEST_COARSE).then(|| Camera { width, height, ..camera.clone() })
}

/// Whether the two show the same view, whatever their lens and size.
fn same_view(a: &Camera, b: &Camera) -> bool {
    (a.yfov, a.camera_to_world) == (b.yfov, b.camera_to_world)
        && (a.aspect() - b.aspect()).abs() < 0.1 * b.aspect()
}
