//! What the preview thread does with its wishes: bake, splat, update, publish.

use crate::first_hits::FirstHits;
use crate::job::guarded;
use crate::preview::{Changes, Shared, Wishes, serves};
use crate::render::light;
use crate::sample_index::SampleIndex;
use crate::{Preview, PreviewActivity, PreviewKind, SessionError, Stage};
use focus::{Focus, FocusMap};
use lens::{Camera, Picture};
use salf::{BakeOptions, SalfStatistics};
use splat::{SplatError, Splatter};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// The margin is baked this much wider than the paint needs, in picture heights, so that the next strokes find
/// room: a tenth of the height is a circle of confusion as wide as paint usually gives.
const MARGIN_HEADROOM: f64 = 0.1;

/// Below this share of the baked aperture's radius the light field is baked again: half as many of its cells a
/// side are open then.
const SMALLER_APERTURE: f64 = 0.7;

/// The thread's own state.
pub(crate) struct Worker {
    shared: Arc<Shared>,
    stage: Option<Arc<Stage>>,
    camera: Option<Camera>,
    map: Option<Arc<FocusMap>>,
    baked: Option<Baked>,
    /// The camera of the newest picture.
    shown: Option<Camera>,
    generation: u64,
    last_id: u64,
}

/// A light field and its running sum.
struct Baked {
    splatter: Splatter,
    index: SampleIndex,
    statistics: SalfStatistics,
    /// The lens of the sum; none while there is no valid sum.
    summed: Option<Camera>,
}

impl From<SplatError> for SessionError {
    fn from(error: SplatError) -> Self {
        match error {
            SplatError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

impl Worker {
    pub fn new(shared: Arc<Shared>) -> Self {
        Self {
            shared,
            stage: None,
            camera: None,
            map: None,
            baked: None,
            shown: None,
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
                        self.baked = None;
                    }
                    self.shared.fail(error.to_string());
                }
            }
        }
    }

    fn follow(&mut self, wishes: Wishes) -> Result<(), SessionError> {
        if let Some((stage, generation)) = wishes.stage {
            self.stage = Some(stage);
            self.generation = generation;
            self.baked = None;
            self.shown = None;
        }
        if wishes.bake {
            self.baked = None;
        }
        self.camera = wishes.camera.or(self.camera.take());
        self.map = wishes.map.map(Arc::new).or(self.map.take());
        let (Some(stage), Some(camera), Some(map)) = (&self.stage, &self.camera, &self.map) else {
            return Ok(());
        };
        let (stage, camera) = (stage.clone(), camera.clone());
        let focus = Focus::painted(stage.scene.clone(), stage.atlas.clone(), map.clone());
        if !self.baked.as_ref().is_some_and(|baked| serves(&baked.splatter.salf().camera, &camera)) {
            self.baked = None;
            self.baked = Some(self.bake(&stage, &camera, &focus)?);
        }
        self.splat(&camera, &focus, &wishes.changed)?;
        if !wishes.settle {
            return Ok(());
        }
        self.shared.yields.store(true, Ordering::Relaxed);
        let refined = if self.shared.is_quiet() { self.refine(&stage, &camera, &focus) } else { Ok(()) };
        self.shared.yields.store(false, Ordering::Relaxed);
        refined
    }

    /// Bakes again where the light field serves but another one would serve better: when paint or lens has come
    /// to spread light from further outside the frame, or the aperture has become much smaller than the one
    /// whose cells were looked through. Given up for any newer wish; the old light field goes on serving.
    fn refine(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<(), SessionError> {
        let Some(baked) = &self.baked else { return Ok(()) };
        let salf = baked.splatter.salf();
        let is_coarse = camera.aperture_radius < SMALLER_APERTURE * salf.camera.aperture_radius;
        let needed = BakeOptions::for_focus(&stage.tracer, camera, focus).margin_px;
        if needed <= salf.margin_px as f64 && !is_coarse {
            return Ok(());
        }
        self.baked = Some(self.bake(stage, camera, focus)?);
        self.splat(camera, focus, &Changes::Everything)
    }

    /// Shows the pinhole picture if the view is new, and makes the light field.
    fn bake(&mut self, stage: &Stage, camera: &Camera, focus: &Focus) -> Result<Baked, SessionError> {
        let start = Instant::now();
        self.shared.begin(PreviewActivity::Baking)?;
        let radiance = light(&stage.tracer, camera);
        if !self.shown.as_ref().is_some_and(|shown| same_view(shown, camera)) {
            let hits = FirstHits::trace(&stage.tracer, &radiance, focus, camera, &self.shared.progress)?;
            self.publish(hits.picture(), PreviewKind::Pinhole, camera, start, SalfStatistics::default());
        }
        let needed = BakeOptions::for_focus(&stage.tracer, camera, focus).margin_px;
        let options = BakeOptions { margin_px: needed + MARGIN_HEADROOM * camera.height as f64 };
        let salf = Arc::new(salf::bake(&stage.tracer, &radiance, camera, &options, &self.shared.progress)?);
        Ok(Baked {
            index: SampleIndex::new(&salf, &stage.atlas),
            statistics: salf.statistics(),
            splatter: Splatter::new(salf),
            summed: None,
        })
    }

    /// Brings the sum to the camera's lens and the focus, and shows it.
    fn splat(&mut self, camera: &Camera, focus: &Focus, changed: &Changes) -> Result<(), SessionError> {
        let Some(baked) = &mut self.baked else { return Ok(()) };
        let start = Instant::now();
        self.shared.begin(PreviewActivity::Splatting)?;
        let kind = match changed {
            Changes::Texels(texels) if baked.summed.as_ref() == Some(camera) => {
                let samples = baked.index.samples_reading(texels);
                if samples.is_empty() {
                    return Ok(());
                }
                // Until the update is through, the sum is of no lens.
                baked.summed = None;
                baked.splatter.update(focus, &samples)?;
                PreviewKind::Update
            }
            _ => {
                baked.summed = None;
                baked.splatter.render(camera, focus, &self.shared.progress)?;
                PreviewKind::Splat
            }
        };
        baked.summed = Some(camera.clone());
        let (picture, statistics) = (baked.splatter.picture().clone(), baked.statistics);
        self.publish(picture, kind, camera, start, statistics);
        Ok(())
    }

    fn publish(
        &mut self,
        picture: Picture,
        kind: PreviewKind,
        camera: &Camera,
        start: Instant,
        statistics: SalfStatistics,
    ) {
        self.last_id += 1;
        self.shown = Some(camera.clone());
        self.shared.publish(Preview {
            id: self.last_id,
            picture: Arc::new(picture),
            kind,
            camera: camera.clone(),
            seconds: start.elapsed().as_secs_f64(),
            statistics,
            generation: self.generation,
        });
    }
}

/// Whether the two show the same view, whatever their lens.
fn same_view(a: &Camera, b: &Camera) -> bool {
    (a.width, a.height, a.yfov, a.camera_to_world) == (b.width, b.height, b.yfov, b.camera_to_world)
}
