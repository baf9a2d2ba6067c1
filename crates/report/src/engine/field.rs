//! One light field under one focus, at every tolerance.

use crate::band::{Band, psnr_of};
use crate::engine::dab::Dabbed;
use crate::engine::dense::dense_seconds;
use crate::engine::frame_copy::{FrameCopy, Timing};
use crate::engine::measured::Measured;
use crate::engine::ray_tracer::{RayTracer, Traced};
use crate::engine::{Check, EngineRecord};
use crate::findings::CurvePoint;
use crate::stopwatch::median;
use lens::{Camera, FocusOffset, Picture};
use salf::Salf;
use scene::SurfaceField;
use session::{SessionError, Steps};
use splat::{Splatter, Tolerance};
use std::sync::Arc;
use std::time::Instant;

/// Shares of a circle of confusion of 16 px that a node's side may have, from the converged picture on.
pub const SHARES: [f64; 10] =
    [0.0, 1.0 / 8.0, 3.0 / 16.0, 1.0 / 4.0, 5.0 / 16.0, 3.0 / 8.0, 7.0 / 16.0, 5.0 / 8.0, 3.0 / 4.0, 1.0];

/// How often a dab is painted and taken back.
const DABS: usize = 21;

/// A light field to measure.
pub struct Field {
    /// What it is called.
    pub scene: String,
    /// What it is focused by.
    pub what: &'static str,
    pub salf: Arc<Salf>,
    pub focus: Arc<dyn SurfaceField<FocusOffset> + Send>,
    pub band: Band,
    /// The circle of confusion it is named for, px.
    pub coc_px: f64,
    /// Whether to time dense scatter: all samples are unpainted and see the whole disc.
    pub with_dense: bool,
    /// Whether to paint dabs.
    pub with_dab: bool,
    /// The ground truth of it; nothing that is made up has one.
    pub truth: Option<Truth>,
}

/// What the splat of a scene is held against.
pub struct Truth {
    /// The ray tracer's pictures.
    pub ray_tracer: RayTracer,
    /// What the light field took to bake, s.
    pub bake_seconds: f64,
}

impl Field {
    /// Measures it at every tolerance.
    pub fn measure(
        &self,
        measured: &mut Measured,
        steps: &dyn Steps,
        note: &dyn Fn(&str),
    ) -> Result<(), SessionError> {
        let Measured { frame, records, checks, gpu } = measured;
        let mut keep = |record: EngineRecord| {
            note(&record.line());
            records.push(record);
        };
        let start = Instant::now();
        let mut splatter = Splatter::new(self.salf.clone());
        let hierarchy_seconds = start.elapsed().as_secs_f64();
        splatter.use_gpu(gpu.clone());
        splatter.keep_on_card(true);
        keep(self.record("hierarchy", frame.beside(hierarchy_seconds), &splatter));
        let mut converged: Option<Picture> = None;
        let mut errors = Vec::new();
        for share in SHARES {
            splatter.set_tolerance(Tolerance { share_of_circle: share });
            let camera = &self.salf.camera;
            let progress = steps.begin("splatting");
            let start = Instant::now();
            splatter.render(camera, &*self.focus, &*progress)?;
            let first_seconds = hierarchy_seconds + start.elapsed().as_secs_f64();
            let mut lenses = other_lenses(camera);
            let drawn = frame
                .in_turn(&mut [|| Ok(splatter.refocus(&lenses.next().expect("endless"), &*progress)?)])?;
            splatter.refocus(camera, &*progress)?;
            let mut record = self.record("full_splat", drawn[0], &splatter);
            record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
            record.tolerance = Some(share);
            splatter.fetch()?;
            match &converged {
                None => converged = Some(splatter.picture().clone()),
                Some(converged) => {
                    let picture = splatter.picture();
                    let psnr = psnr_of(&picture.radiance, &converged.radiance);
                    errors.push(psnr);
                    record.psnr = Some(psnr);
                    record.band_psnr = self.band.psnr(&picture.radiance, &converged.radiance);
                    record.band_coverage_rms = self.band.rms(&picture.coverage, &converged.coverage);
                }
            }
            if let Some(Truth { ray_tracer, bake_seconds }) = &self.truth {
                record.truth = Some(ray_tracer.against(splatter.picture(), &self.band)?);
                keep(EngineRecord {
                    what: self.named("bake and first picture"),
                    ..record.clone().lasting(frame.beside(bake_seconds + first_seconds))
                });
            }
            keep(record);
        }
        checks.push(self.check("the error grows with the tolerance", is_growing(&errors)));
        // The others do not depend on what sums.
        if self.with_dense && gpu.is_none() {
            let mut record = self.record("full_splat", frame.beside(dense_seconds(&self.salf)), &splatter);
            (record.renderer, record.bytes) = ("dense_scatter".into(), 0);
            keep(record);
        }
        if self.with_dab {
            let (record, holds) = self.dab(&mut splatter, frame, steps)?;
            keep(record);
            checks.push(self.check("a dab equals a render from scratch, bit for bit, and shows", holds));
        }
        let what = match gpu {
            Some(gpu) => &format!("{} draws the picture of the processor, bit for bit", gpu.name()),
            None => "one thread draws the picture of many, bit for bit",
        };
        let holds = self.is_same_otherwise(&mut splatter, gpu.is_some(), steps)?;
        checks.push(self.check(what, holds));
        Ok(())
    }

    /// The ray tracer's pictures.
    pub fn traced(&self, measured: &mut Measured, note: &dyn Fn(&str)) {
        for traced in self.truth.iter().flat_map(|truth| &truth.ray_tracer.curve) {
            let record = self.traced_at(traced, &mut measured.frame);
            note(&record.line());
            measured.records.push(record);
        }
    }

    /// `what` with the focus, if the field has several.
    fn named(&self, what: &str) -> String {
        if self.what.is_empty() { what.into() } else { format!("{what}, {}", self.what) }
    }

    fn check(&self, what: &str, holds: bool) -> Check {
        Check { scene: self.scene.clone(), what: self.named(what), holds }
    }

    fn traced_at(&self, traced: &Traced, frame: &mut FrameCopy) -> EngineRecord {
        let CurvePoint { seconds, rmse } = traced.point;
        let timing = frame.beside(seconds);
        let record = EngineRecord::of(&self.scene, &self.named("ray tracer"), &self.salf, timing);
        EngineRecord {
            renderer: "truth".into(),
            coc_px: self.coc_px,
            samples: 0,
            spp: Some(traced.spp),
            psnr: Some(project::psnr(rmse.powi(2))),
            ..record
        }
    }

    fn record(&self, what: &str, timing: Timing, splatter: &Splatter) -> EngineRecord {
        let record = EngineRecord::of(&self.scene, &self.named(what), &self.salf, timing).by(splatter);
        EngineRecord { coc_px: self.coc_px, ..record }
    }

    /// Paints a dab and takes it back, again and again, on a live picture at the tolerance of viewing.
    fn dab(
        &self,
        splatter: &mut Splatter,
        frame: &mut FrameCopy,
        steps: &dyn Steps,
    ) -> Result<(EngineRecord, bool), SessionError> {
        let camera = &self.salf.camera;
        let progress = steps.begin("painting");
        splatter.set_tolerance(Tolerance::VIEWING);
        splatter.set_live(true);
        splatter.render(camera, &*self.focus, &*progress)?;
        splatter.fetch()?;
        let before = splatter.picture().clone();
        let dabbed = Dabbed::new(&self.salf, self.focus.clone());
        let mut times = Vec::new();
        for k in 0..DABS {
            let focus: &dyn SurfaceField<FocusOffset> = if k % 2 == 0 { &dabbed } else { &*self.focus };
            let start = Instant::now();
            splatter.update(focus, &dabbed.samples)?;
            times.push(start.elapsed().as_secs_f64());
        }
        let mut record = self.record("dab", frame.beside(median(&mut times)), splatter);
        record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
        record.tolerance = Some(Tolerance::VIEWING.share_of_circle);
        splatter.fetch()?;
        let after = splatter.picture().clone();
        splatter.render(camera, &dabbed, &*progress)?;
        splatter.fetch()?;
        splatter.set_live(false);
        Ok((record, &after == splatter.picture() && after != before))
    }

    /// Whether the picture is the same summed otherwise: that of a card (`is_on_card`) by the processor, that of the processor by
    /// one thread.
    fn is_same_otherwise(
        &self,
        splatter: &mut Splatter,
        is_on_card: bool,
        steps: &dyn Steps,
    ) -> Result<bool, SessionError> {
        let camera = &self.salf.camera;
        let progress = steps.begin("splatting");
        splatter.set_tolerance(Tolerance::VIEWING);
        splatter.render(camera, &*self.focus, &*progress)?;
        splatter.fetch()?;
        let was_on_card = splatter.gpu().is_some();
        let before = splatter.picture().clone();
        splatter.use_gpu(None);
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let alone = alone.map_err(|error| SessionError::Internal(format!("no thread: {error}")))?;
        alone.install(|| splatter.refocus(camera, &*progress))?;
        Ok(was_on_card == is_on_card && &before == splatter.picture())
    }
}

/// Cameras focused elsewhere, by so little that pictures stay as they are, however many are asked for: what is kept for a lens
/// is of no use to the next.
pub fn other_lenses(camera: &Camera) -> impl Iterator<Item = Camera> + use<> {
    let camera = camera.clone();
    (1..).map(move |k| {
        let focus_distance = 1.0 / (camera.focus_distance.recip() + 1e-6 * f64::from(k));
        Camera { focus_distance, ..camera.clone() }
    })
}

/// Whether pictures get no closer to the converged one, dB, from the first to the last: but for what a few nodes make, joined
/// where all others are drawn alike, whose errors happen to offset others.
fn is_growing(decibels: &[f64]) -> bool {
    const BY_CHANCE: f64 = 0.01;
    decibels.windows(2).all(|pair| pair[1] <= pair[0] + BY_CHANCE)
}
