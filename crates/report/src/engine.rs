//! Speed and error of the splat engine: `focus-brush report --engine`.
//!
//! Synthetic light fields and light fields of scenes are splatted at every tolerance. Each picture is compared
//! with the converged one, as a whole and near outlines, and each time with that of copying one frame in the
//! same run. Pictures of scenes are also compared with the ground truth, and with the ray tracer at equal
//! error. How the time of a bake grows is measured on foliage made by code.

mod dab;
mod dense;
mod field;
mod frame_copy;
mod growth;
mod measurements;
mod plots;
mod ray_tracer;
mod record;
mod synthetic;
mod write;

pub use measurements::{Check, EngineReport};
pub use record::EngineRecord;

use crate::measurement::band::{OutlineBand, inverse_depths};
use crate::measurement::contender::Shot;
use crate::measurement::machine::Machine;
use crate::options::{ReportOptions, SceneRequest};
use crate::subject::Subject;
use field::{GroundTruth, LightFieldCase};
use frame_copy::FrameCopy;
use graphics_card::Gpu;
use light::Steps;
use measurements::EngineMeasurements;
use numerics::order_statistic;
use ray_tracer::RayTracer;
use render::{RenderOptions, bake};
use session::SessionError;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Measures the engine on each of `backends` (`None`: the processor) and writes `report.json`, `engine.md`,
/// `engine.html` and `about.json` into `folder`.
///
/// # Errors
/// A scene cannot be opened or rendered, a file cannot be written, or the run is cancelled.
pub fn run_engine(
    requests: &[SceneRequest],
    options: &ReportOptions,
    backends: &[Option<Gpu>],
    folder: &Path,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<EngineReport, SessionError> {
    std::fs::create_dir_all(folder).map_err(|error| SessionError::io(folder, &error))?;
    let [width, height] = options.size.unwrap_or([1920, 1080]);
    let frame = FrameCopy::new(width as usize * height as usize);
    let mut measured = EngineMeasurements { frame, records: Vec::new(), checks: Vec::new(), gpu: None };
    for gpu in backends {
        measured.gpu.clone_from(gpu);
        for field in synthetic::fields([width, height]) {
            field.measure(&mut measured, steps, note)?;
        }
        synthetic::sweep_circles([width, height], &mut measured, steps, note)?;
        synthetic::sweep_sizes([width, height], &mut measured, steps, note)?;
    }
    growth::measure([width, height], &mut measured, steps, note)?;
    for request in requests {
        let options = ReportOptions { size: Some([width, height]), ..options.clone() };
        let subject = Subject::open(request, &options, steps)?;
        measure_scene(&subject, options.reference_spp, backends, &mut measured, steps, note)?;
    }
    let EngineMeasurements { records, checks, frame, .. } = measured;
    note(&format!("copying one frame of {width} × {height} takes {:.2} ms", frame.seconds() * 1e3));
    let mut report = EngineReport { records, checks, machine: Machine::current(), files: Vec::new() };
    report.files = write::write_engine_report(&report, frame.seconds(), folder)?;
    Ok(report)
}

/// Bakes a scene's light field and measures it and the ray tracer under each focus.
fn measure_scene(
    subject: &Subject,
    reference_spp: u32,
    backends: &[Option<Gpu>],
    measured: &mut EngineMeasurements,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<(), SessionError> {
    let painted = &subject.focuses.last().expect("every subject has a painted focus").focus;
    let tolerance_px = RenderOptions::default().tolerance_px;
    let start = Instant::now();
    let salf = Arc::new(bake(&subject.lit, &subject.camera, painted, tolerance_px, steps)?);
    let seconds = start.elapsed().as_secs_f64();
    let timing = measured.frame.timing_of(seconds);
    let mut record = EngineRecord::new(&subject.name, "bake", &salf, timing);
    record.bytes = salf.statistics().bytes as u64;
    note(&record.summary_line());
    measured.records.push(record);
    let depths = inverse_depths(subject.lit.tracer(), &subject.camera);
    let band = OutlineBand::from_depths(&depths, &subject.camera);
    let coc_px = circle_of_confusion_px(&depths, &subject.camera);
    for named in &subject.focuses {
        let shot = Shot { lit: &subject.lit, camera: &subject.camera, focus: &named.focus };
        let ray_tracer = RayTracer::measure(shot, reference_spp, steps)?;
        let field = LightFieldCase {
            scene: subject.name.clone(),
            what: named.name,
            salf: salf.clone(),
            focus: Arc::new(named.focus.clone()),
            band: band.clone(),
            coc_px,
            with_dense: false,
            with_dab: true,
            truth: Some(GroundTruth { ray_tracer, bake_seconds: seconds }),
        };
        field.record_ray_tracer(measured, note);
        for gpu in backends {
            measured.gpu.clone_from(gpu);
            field.measure(measured, steps, note)?;
        }
    }
    Ok(())
}

/// The 99th percentile of the circle of confusion under the standard lens, px.
fn circle_of_confusion_px(inverse_depths: &[f32], camera: &lens::Camera) -> f64 {
    let optics = camera.optics();
    let circle =
        |&inverse_depth: &f32| optics.circle_of_confusion_px(optics.standard_kappa(inverse_depth.into()));
    let mut circles: Vec<f64> = inverse_depths.iter().map(circle).collect();
    let rank = circles.len() * 99 / 100;
    order_statistic(&mut circles, rank).unwrap_or(0.0)
}
