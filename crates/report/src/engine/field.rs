//! One light field under one focus, at every tolerance.

use crate::band::{OutlineBand, picture_psnr};
use crate::engine::dab::DabbedFocus;
use crate::engine::dense::dense_seconds;
use crate::engine::frame_copy::{FrameCopy, Timing};
use crate::engine::measured::EngineMeasurements;
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
pub struct LightFieldCase {
    /// What it is called.
    pub scene: String,
    /// What it is focused by.
    pub what: &'static str,
    pub salf: Arc<Salf>,
    pub focus: Arc<dyn SurfaceField<FocusOffset> + Send>,
    pub band: OutlineBand,
    /// The circle of confusion it is named for, px.
    pub coc_px: f64,
    /// Whether to time dense scatter: all samples are unpainted and see the whole disc.
    pub with_dense: bool,
    /// Whether to paint dabs.
    pub with_dab: bool,
    /// The ground truth of it; nothing that is made up has one.
    pub truth: Option<GroundTruth>,
}

/// What the splat of a scene is held against.
pub struct GroundTruth {
    /// The ray tracer's pictures.
    pub ray_tracer: RayTracer,
    /// What the light field took to bake, s.
    pub bake_seconds: f64,
}

impl LightFieldCase {
    /// Measures it at every tolerance.
    pub fn measure(
        &self,
        measured: &mut EngineMeasurements,
        steps: &dyn Steps,
        note: &dyn Fn(&str),
    ) -> Result<(), SessionError> {
        let EngineMeasurements { frame, records, checks, gpu } = measured;
        let mut add_record = |record: EngineRecord| {
            note(&record.summary_line());
            records.push(record);
        };
        let start = Instant::now();
        let mut splatter = Splatter::new(self.salf.clone());
        let hierarchy_seconds = start.elapsed().as_secs_f64();
        splatter.use_gpu(gpu.clone());
        splatter.keep_on_card(true);
        add_record(self.record("hierarchy", frame.timing_of(hierarchy_seconds), &splatter));
        let mut converged: Option<Picture> = None;
        let mut errors = Vec::new();
        for share in SHARES {
            splatter.set_tolerance(Tolerance { share_of_circle: share });
            let camera = &self.salf.camera;
            let progress = steps.begin("splatting");
            let start = Instant::now();
            splatter.render(camera, &*self.focus, &*progress)?;
            let first_seconds = hierarchy_seconds + start.elapsed().as_secs_f64();
            let mut lenses = nudged_lenses(camera);
            let drawn = frame.time_interleaved(&mut [|| {
                Ok(splatter.refocus(&lenses.next().expect("endless"), &*progress)?)
            }])?;
            splatter.refocus(camera, &*progress)?;
            let mut record = self.record("full_splat", drawn[0], &splatter);
            record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
            record.tolerance = Some(share);
            splatter.fetch_picture()?;
            match &converged {
                None => converged = Some(splatter.picture().clone()),
                Some(converged) => {
                    let picture = splatter.picture();
                    let psnr = picture_psnr(&picture.radiance, &converged.radiance);
                    errors.push(psnr);
                    record.psnr = Some(psnr);
                    record.band_psnr = self.band.psnr(&picture.radiance, &converged.radiance);
                    record.band_coverage_rms = self.band.rms(&picture.coverage, &converged.coverage);
                }
            }
            if let Some(GroundTruth { ray_tracer, bake_seconds }) = &self.truth {
                record.truth = Some(ray_tracer.against(splatter.picture(), &self.band)?);
                add_record(EngineRecord {
                    what: self.with_focus_name("bake and first picture"),
                    ..record.clone().with_timing(frame.timing_of(bake_seconds + first_seconds))
                });
            }
            add_record(record);
        }
        checks.push(self.check("the error grows with the tolerance", errors_grow(&errors)));
        // The others do not depend on what sums.
        if self.with_dense && gpu.is_none() {
            let mut record = self.record("full_splat", frame.timing_of(dense_seconds(&self.salf)), &splatter);
            (record.renderer, record.bytes) = ("dense_scatter".into(), 0);
            add_record(record);
        }
        if self.with_dab {
            let (record, holds) = self.dab(&mut splatter, frame, steps)?;
            add_record(record);
            checks.push(self.check("a dab equals a render from scratch, bit for bit, and shows", holds));
        }
        let what = match gpu {
            Some(gpu) => &format!("{} draws the picture of the processor, bit for bit", gpu.name()),
            None => "one thread draws the picture of many, bit for bit",
        };
        let holds = self.matches_other_summation(&mut splatter, gpu.is_some(), steps)?;
        checks.push(self.check(what, holds));
        Ok(())
    }

    /// The ray tracer's pictures.
    pub fn record_ray_tracer(&self, measured: &mut EngineMeasurements, note: &dyn Fn(&str)) {
        for traced in self.truth.iter().flat_map(|truth| &truth.ray_tracer.curve) {
            let record = self.ray_tracer_record(traced, &mut measured.frame);
            note(&record.summary_line());
            measured.records.push(record);
        }
    }

    /// `what` with the focus, if the field has several.
    fn with_focus_name(&self, what: &str) -> String {
        if self.what.is_empty() { what.into() } else { format!("{what}, {}", self.what) }
    }

    fn check(&self, what: &str, holds: bool) -> Check {
        Check { scene: self.scene.clone(), what: self.with_focus_name(what), holds }
    }

    fn ray_tracer_record(&self, traced: &Traced, frame: &mut FrameCopy) -> EngineRecord {
        let CurvePoint { seconds, rmse } = traced.point;
        let timing = frame.timing_of(seconds);
        let record = EngineRecord::new(&self.scene, &self.with_focus_name("ray tracer"), &self.salf, timing);
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
        let record = EngineRecord::new(&self.scene, &self.with_focus_name(what), &self.salf, timing)
            .summed_by(splatter);
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
        splatter.fetch_picture()?;
        let before = splatter.picture().clone();
        let dabbed = DabbedFocus::new(&self.salf, self.focus.clone());
        let mut times = Vec::new();
        for k in 0..DABS {
            let focus: &dyn SurfaceField<FocusOffset> = if k % 2 == 0 { &dabbed } else { &*self.focus };
            let start = Instant::now();
            splatter.update(focus, &dabbed.samples)?;
            times.push(start.elapsed().as_secs_f64());
        }
        let mut record = self.record("dab", frame.timing_of(median(&mut times)), splatter);
        record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
        record.tolerance = Some(Tolerance::VIEWING.share_of_circle);
        splatter.fetch_picture()?;
        let after = splatter.picture().clone();
        splatter.render(camera, &dabbed, &*progress)?;
        splatter.fetch_picture()?;
        splatter.set_live(false);
        Ok((record, &after == splatter.picture() && after != before))
    }

    /// Whether the picture is the same summed otherwise: that of a card (`is_on_card`) by the processor, that of the processor by
    /// one thread.
    fn matches_other_summation(
        &self,
        splatter: &mut Splatter,
        is_on_card: bool,
        steps: &dyn Steps,
    ) -> Result<bool, SessionError> {
        let camera = &self.salf.camera;
        let progress = steps.begin("splatting");
        splatter.set_tolerance(Tolerance::VIEWING);
        splatter.render(camera, &*self.focus, &*progress)?;
        splatter.fetch_picture()?;
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
pub fn nudged_lenses(camera: &Camera) -> impl Iterator<Item = Camera> + use<> {
    let camera = camera.clone();
    (1..).map(move |k| {
        let focus_distance = 1.0 / (camera.focus_distance.recip() + 1e-6 * f64::from(k));
        Camera { focus_distance, ..camera.clone() }
    })
}

/// Whether pictures get no closer to the converged one, dB, from the first to the last: but for what a few nodes make, joined
/// where all others are drawn alike, whose errors happen to offset others.
fn errors_grow(decibels: &[f64]) -> bool {
    const CHANCE_DECIBELS: f64 = 0.01;
    decibels.windows(2).all(|pair| pair[1] <= pair[0] + CHANCE_DECIBELS)
}
