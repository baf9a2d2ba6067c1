//! What the preview thread does with its wishes.

use crate::job::{among_others, guarded};
use crate::light_field::{Brought, Changes, LightField};
use crate::picture_ring::{PictureRing, Rectangle, whole};
use crate::preview::{Delivery, Shared, Wishes};
use crate::render::light;
use crate::screen::Patch;
use crate::tone::rectangle_to_screen;
use crate::{Modelled, Preview, PreviewActivity, PreviewKind, SessionError, Stage, Tone};
use baselines::FirstHits;
use focus::{Focus, FocusMap};
use lens::{Camera, Picture};
use progress::Stage as Share;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

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
    pub fn new(shared: Arc<Shared>) -> Self {
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
        while let Some(wishes) = self.shared.next() {
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
    }

    fn follow(&mut self, wishes: Wishes) -> Result<(), SessionError> {
        self.take_in(wishes)?;
        let (Some(stage), Some(camera), Some(map)) = (&self.stage, &self.camera, &self.map) else {
            return Ok(());
        };
        let (stage, camera) = (stage.clone(), camera.clone());
        let focus = Focus::painted(stage.scene.clone(), stage.atlas.clone(), map.clone());
        if self.is_held && self.fine.is_none() && self.coarse.is_none() {
            return Ok(());
        }

        self.fine.take_if(|fine| !fine.serves(&camera));
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
                self.is_new = false;
                let (kind, modelled) = (PreviewKind::from(&brought), fine.modelled());
                let seconds = start.elapsed().as_secs_f64() + elsewhere;
                self.publish(Made { picture, changed, kind, seconds, modelled }, &camera);
            }
            let may_refine = self.is_settled && self.helper.is_none() && !self.is_held;
            let fine = self.fine.as_ref().filter(|_| may_refine);
            self.is_settled &= !may_refine;
            if fine.is_some_and(|fine| fine.is_outgrown(&stage, &camera, &focus)) {
                self.coarse = None;
                self.start_helper(&stage, &camera, focus, None);
            }
            return Ok(());
        }
        self.show_coarse(&stage, &camera, &focus)?;
        if self.helper.is_none() && !self.is_held {
            let unsummed = self.fine.take();
            self.start_helper(&stage, &camera, focus, unsummed);
        }
        Ok(())
    }

    /// Takes up what changed, and what the helper brought.
    fn take_in(&mut self, wishes: Wishes) -> Result<(), SessionError> {
        let mut failed = Ok(());
        if let Some(delivery) = wishes.delivery {
            if let Some(helper) = self.helper.take() {
                // Its result is here; its panics were caught.
                let _ = helper.join();
            }
            let since = std::mem::take(&mut self.since);
            match delivery.made {
                Ok(mut field) => {
                    field.note(&since);
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
        if let Some((stage, generation)) = wishes.stage {
            self.stage = Some(stage);
            self.generation = generation;
            (self.coarse, self.fine, self.shown) = (None, None, None);
            self.epoch += 1;
        }
        if wishes.bake {
            (self.coarse, self.fine) = (None, None);
            self.epoch += 1;
        }
        let wants_work = self.stage.is_some() && (wishes.camera.is_some() || wishes.bake || wishes.settle);
        self.is_held = wishes.hold || (self.is_held && !wants_work);
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
                self.coarse.insert(LightField::bake(stage, &small, focus, &self.shared.quick)?)
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
            self.publish(Made { picture, changed, kind, seconds, modelled }, &small);
        }
        Ok(())
    }

    /// Makes the fine light field (or takes an `unsummed` one) and sums it, on a thread of its own.
    fn start_helper(
        &mut self,
        stage: &Arc<Stage>,
        camera: &Camera,
        focus: Focus,
        unsummed: Option<LightField>,
    ) {
        if !self.shared.begin_helper() {
            return;
        }
        self.since = Changes::default();
        let (shared, stage, camera, epoch) = (self.shared.clone(), stage.clone(), camera.clone(), self.epoch);
        let work = move || {
            let make = || {
                let mut field = match unsummed {
                    Some(field) => field,
                    None => {
                        LightField::bake(&stage, &camera, &focus, &Share::new(&shared.progress, 0.0, 0.7))?
                    }
                };
                shared.helper_sums();
                field.bring_up(&camera, &focus, &Share::new(&shared.progress, 0.7, 1.0))?;
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
        let Made { picture, changed, kind, seconds, modelled } = made;
        self.last_id += 1;
        let full = self.camera.as_ref().map(|camera| (camera.width, camera.height));
        let preview = Preview {
            id: self.last_id,
            is_coarse: full != Some((picture.width, picture.height)),
            picture,
            kind,
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

/// A picture that was made.
struct Made {
    picture: Arc<Picture>,
    /// Where it differs from the one before.
    changed: Option<Rectangle>,
    kind: PreviewKind,
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
