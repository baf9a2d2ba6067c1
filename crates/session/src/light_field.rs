//! A baked light field with its running sum, and what it takes to bring the sum up to date.

use crate::render::light;
use crate::sample_index::SampleIndex;
use crate::{Modelled, SessionError, Stage};
use focus::Focus;
use lens::{Camera, Picture};
use progress::Progress;
use salf::{BakeOptions, Salf};
use splat::{BackendChoice, Gpu, SplatError, Splatter, Tolerance};
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// The margin is baked this much wider than the paint needs, in picture heights, so that the next strokes find
/// room: a tenth of the height is a circle of confusion as wide as paint usually gives.
const MARGIN_HEADROOM: f64 = 0.1;

/// Below this share of the baked aperture's radius another light field would be better: half of the cells of its
/// masks are closed then.
const SMALLER_APERTURE: f64 = 0.7;

/// When more than this share of the samples move, a whole sum is quicker: it runs on all cores, and removes nothing.
const LARGEST_UPDATE: f64 = 0.25;

/// Texels of the focus map that a sum has not seen yet.
#[derive(Clone, Debug)]
pub(crate) enum Changes {
    /// These.
    Texels(Vec<[u32; 2]>),
    /// All of them, or the background.
    Everything,
}

impl Default for Changes {
    fn default() -> Self {
        Self::Texels(Vec::new())
    }
}

impl Changes {
    /// Whether nothing has changed.
    fn is_none(&self) -> bool {
        matches!(self, Self::Texels(texels) if texels.is_empty())
    }

    /// Takes up newer changes.
    pub fn join(&mut self, newer: &Changes) {
        match (&mut *self, newer) {
            (Self::Texels(texels), Self::Texels(more)) => texels.extend(more),
            _ => *self = Self::Everything,
        }
    }
}

/// What it took to bring a sum up to date.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Brought {
    /// It was.
    Nothing,
    /// Some samples were moved: rows of the picture changed.
    Update(Range<u32>),
    /// The whole sum was made.
    Whole,
}

/// A light field to look at.
#[derive(Clone)]
pub(crate) struct BakedField {
    pub salf: Arc<Salf>,
    pub index: Arc<SampleIndex>,
}

/// A light field and its running sum.
pub(crate) struct LightField {
    splatter: Splatter,
    index: Arc<SampleIndex>,
    modelled: Modelled,
    /// The lens of the sum; none while there is no valid sum.
    summed: Option<Camera>,
    /// What the sum has not seen.
    unseen: Changes,
    /// Seconds that the last whole sum took.
    whole_seconds: f64,
}

impl From<SplatError> for SessionError {
    fn from(error: SplatError) -> Self {
        match error {
            SplatError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

impl LightField {
    /// Bakes what `camera` and `focus` need.
    pub fn bake(
        stage: &Stage,
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<Self, SessionError> {
        let needed = BakeOptions::for_focus(&stage.tracer, camera, focus).margin_px;
        let margin_px = needed + MARGIN_HEADROOM * camera.height as f64;
        let options = BakeOptions { margin_px, ..BakeOptions::default() };
        let radiance = light(&stage.tracer, camera);
        let salf = Arc::new(salf::bake(&stage.tracer, &radiance, camera, &options, progress)?);
        Ok(Self {
            index: Arc::new(SampleIndex::new(&salf, &stage.atlas)),
            modelled: Modelled::with_texels(&salf, &stage.tracer, Some(&stage.texels.texels)),
            splatter: {
                let mut splatter = Splatter::new(salf);
                splatter.set_tolerance(Tolerance::VIEWING);
                // Without a card, or one that works, the processor sums.
                splatter.use_gpu(Gpu::open(BackendChoice::Auto, None).ok().flatten());
                splatter
            },
            summed: None,
            unseen: Changes::default(),
            whole_seconds: f64::INFINITY,
        })
    }

    /// Whether it can show what `camera` sees.
    pub fn serves(&self, camera: &Camera) -> bool {
        serves(&self.splatter.salf().camera, camera)
    }

    /// Whether another bake would serve better: paint or lens has come to spread light from further outside the
    /// frame, or the aperture has become much smaller than the one whose cells were looked through.
    pub fn is_outgrown(&self, stage: &Stage, camera: &Camera, focus: &Focus) -> bool {
        let salf = self.splatter.salf();
        camera.aperture_radius < SMALLER_APERTURE * salf.camera.aperture_radius
            || BakeOptions::for_focus(&stage.tracer, camera, focus).margin_px > salf.margin_px as f64
    }

    /// Notes changes of the focus map.
    pub fn note(&mut self, changes: &Changes) {
        self.unseen.join(changes);
    }

    /// Whether [`Self::bring_up`] would make the whole sum.
    pub fn needs_whole_sum(&self, camera: &Camera) -> bool {
        self.moved_samples(camera).is_none()
    }

    /// The samples that moved since the sum; none where a whole sum is needed or quicker.
    fn moved_samples(&self, camera: &Camera) -> Option<Vec<u32>> {
        let texels = match &self.unseen {
            Changes::Texels(texels) if self.summed.as_ref() == Some(camera) => texels,
            _ => return None,
        };
        let samples = self.index.samples_reading(texels);
        let few = samples.len() as f64 <= LARGEST_UPDATE * self.splatter.salf().samples.len() as f64;
        few.then_some(samples)
    }

    /// Seconds that the last whole sum took; infinite before the first.
    pub fn whole_seconds(&self) -> f64 {
        self.whole_seconds
    }

    /// Brings the sum to a lens and a focus. After an error the next call makes the whole sum.
    pub fn bring_up(
        &mut self,
        camera: &Camera,
        focus: &Focus,
        progress: &dyn Progress,
    ) -> Result<Brought, SessionError> {
        let moved = self.moved_samples(camera);
        // Until all is through, the sum is of no lens.
        let was_summed = self.summed.take().is_some();
        let brought = match moved {
            Some(samples) if samples.is_empty() => Brought::Nothing,
            Some(samples) => Brought::Update(self.splatter.update(focus, &samples)?),
            None => {
                let start = Instant::now();
                if was_summed && self.unseen.is_none() {
                    self.splatter.refocus(camera, progress)?;
                } else {
                    self.splatter.render(camera, focus, progress)?;
                }
                self.whole_seconds = start.elapsed().as_secs_f64();
                Brought::Whole
            }
        };
        self.unseen = Changes::default();
        self.summed = Some(camera.clone());
        Ok(brought)
    }

    /// The picture of the sum.
    pub fn picture(&self) -> &Picture {
        self.splatter.picture()
    }

    /// The light field itself, and where its samples are.
    pub fn baked(&self) -> BakedField {
        BakedField { salf: self.splatter.salf().clone(), index: self.index.clone() }
    }

    /// What it holds, counted.
    pub fn modelled(&self) -> Modelled {
        self.modelled
    }
}

/// Whether a light field that was baked for `baked` can show what `camera` sees.
pub(crate) fn serves(baked: &Camera, camera: &Camera) -> bool {
    let like = Camera {
        focus_distance: baked.focus_distance,
        aperture: baked.aperture.clone(),
        aperture_radius: baked.aperture_radius,
        ..camera.clone()
    };
    like == *baked && camera.aperture_radius <= baked.aperture_radius
}
