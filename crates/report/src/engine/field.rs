//! Measurements of one light field under one focus, at every tolerance.

use super::dab::DabbedFocus;
use super::dense::dense_seconds;
use super::frame_copy::{FrameCopy, Timing};
use super::measurements::EngineMeasurements;
use super::ray_tracer::{RayTracer, Traced};
use super::{Check, EngineRecord};
use crate::findings::CurvePoint;
use crate::measurement::band::{OutlineBand, picture_psnr};
use crate::measurement::stopwatch::median_seconds;
use lens::{Camera, FocusOffset, Picture};
use light::Steps;
use salf::Salf;
use scene::SurfaceField;
use session::SessionError;
use splat::{Splatter, Tolerance};
use std::sync::Arc;
use std::time::Instant;

/// Tolerances: side of a node as a share of a circle of confusion of 16 px, starting with the converged
/// picture.
pub const SHARES: [f64; 10] =
    [0.0, 1.0 / 8.0, 3.0 / 16.0, 1.0 / 4.0, 5.0 / 16.0, 3.0 / 8.0, 7.0 / 16.0, 5.0 / 8.0, 3.0 / 4.0, 1.0];

/// Number of times a dab is painted or removed.
const DABS: usize = 21;

/// A light field to measure.
pub struct LightFieldCase {
    /// Name of the scene or field.
    pub scene: String,
    /// Name of the focus; empty if there is only one.
    pub what: &'static str,
    /// The light field.
    pub salf: Arc<Salf>,
    /// The focus.
    pub focus: Arc<dyn SurfaceField<FocusOffset> + Send>,
    /// The pixels near outlines, whose errors are counted apart.
    pub band: OutlineBand,
    /// Nominal circle of confusion, px.
    pub coc_px: f64,
    /// Whether to time dense scatter; requires unpainted samples that see the whole disc.
    pub with_dense: bool,
    /// Whether to paint dabs.
    pub with_dab: bool,
    /// The ground truth; `None` for synthetic fields.
    pub truth: Option<GroundTruth>,
}

/// What the splat of a scene is compared with.
pub struct GroundTruth {
    /// The ray tracer's pictures.
    pub ray_tracer: RayTracer,
    /// Time taken to bake the light field, s.
    pub bake_seconds: f64,
}

impl LightFieldCase {
    /// Measures the field at every tolerance.
    ///
    /// # Errors
    /// Splatting fails or is cancelled.
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
        // Dense scatter does not depend on the device, so it is timed once.
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

    /// Appends the name of the focus, if any.
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
            psnr: Some(numerics::psnr(rmse.powi(2))),
            ..record
        }
    }

    fn record(&self, what: &str, timing: Timing, splatter: &Splatter) -> EngineRecord {
        let record = EngineRecord::new(&self.scene, &self.with_focus_name(what), &self.salf, timing)
            .summed_by(splatter);
        EngineRecord { coc_px: self.coc_px, ..record }
    }

    /// Repeatedly paints and removes a dab on a live picture at the viewing tolerance.
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
        let mut record = self.record("dab", frame.timing_of(median_seconds(&mut times)), splatter);
        record.card_ms = splatter.seconds_on_card().map(|seconds| seconds * 1e3);
        record.tolerance = Some(Tolerance::VIEWING.share_of_circle);
        splatter.fetch_picture()?;
        let after = splatter.picture().clone();
        splatter.render(camera, &dabbed, &*progress)?;
        splatter.fetch_picture()?;
        splatter.set_live(false);
        Ok((record, &after == splatter.picture() && after != before))
    }

    /// Whether another device sums the same picture: the processor if it was on a card (`is_on_card`), a single
    /// thread otherwise.
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

/// Cameras with focus distances that differ too little to change the picture, so that data cached for one lens
/// cannot be reused for the next.
pub fn nudged_lenses(camera: &Camera) -> impl Iterator<Item = Camera> + use<> {
    let camera = camera.clone();
    (1..).map(move |k| {
        let focus_distance = 1.0 / (camera.focus_distance.recip() + 1e-6 * f64::from(k));
        Camera { focus_distance, ..camera.clone() }
    })
}

/// Whether the PSNR against the converged picture never increases from the first to the last, apart from small
/// gains where errors of a few merged nodes cancel by chance.
fn errors_grow(decibels: &[f64]) -> bool {
    const CHANCE_DECIBELS: f64 = 0.01;
    decibels.windows(2).all(|pair| pair[1] <= pair[0] + CHANCE_DECIBELS)
}
