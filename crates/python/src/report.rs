//! `report`: speed against error, measured.

use crate::errors::{exception, reading_exception, warn};
use crate::json::python_from_json;
use crate::scene::unwrap_options;
use crate::work;
use ::report::{ReportOptions, SceneRequest, build_checksum};
use document::{CameraChoice, VariantChoice};
use light::{LightOptions, Resources};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use render::RenderError;
use serde_json::json;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Measures the speed of every renderer against its error, as `focus-brush report` does, and writes the report into
/// `folder`: report.html, report.md, report.json, report.csv, about.json. What was measured there already, by the same
/// build, is not measured again, so an interrupted report is taken up where it ended. `scenes` is a file or a list of files;
/// `camera` (a name or a file), `focus` (a file) and `size` are those of all of them. The reference has `spp` rays a pixel (1024,
/// or 512 if `quick`); `quick` measures a few points of every sweep, and `hard` the hard cases, too.
///
/// Returns a dict: files, records (a dict for each measurement, as in report.json), new (how many of them were made
/// now), hard_cases (None unless `hard`), machine, seconds.
///
/// Raises FileNotFoundError, ValueError or OSError; warns of what is unusual about the scenes.
#[pyfunction]
#[pyo3(signature = (
    scenes, folder, *, camera = None, focus = None, size = None, spp = None, quick = false, hard = false, progress = None
))]
#[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn report<'py>(
    py: Python<'py>,
    scenes: &Bound<'py, PyAny>,
    folder: PathBuf,
    camera: Option<PathBuf>,
    focus: Option<PathBuf>,
    size: Option<[u32; 2]>,
    spp: Option<u32>,
    quick: bool,
    hard: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let files: Vec<PathBuf> = scenes.extract().map(|file| vec![file]).or_else(|_| scenes.extract())?;
    let camera = camera.map(|camera| CameraChoice::from_argument(camera.as_os_str()));
    let request = |file: PathBuf| SceneRequest {
        file,
        camera: camera.clone(),
        focus: focus.clone(),
        back_faces: None,
        variant: VariantChoice::AsSaved,
        world: None,
        light: LightOptions::default(),
    };
    let requests: Vec<_> = files.into_iter().map(request).collect();
    for request in &requests {
        request.check().map_err(|error| reading_exception(&request.file, error))?;
    }
    let reference_spp = spp.unwrap_or(match quick {
        true => ReportOptions::QUICK_REFERENCE_SPP,
        false => ReportOptions::REFERENCE_SPP,
    });
    if reference_spp < ReportOptions::MIN_REFERENCE_SPP {
        let what = format!("spp: {reference_spp} is out of range (2 or more)");
        return Err(PyValueError::new_err(what));
    }
    let module: PathBuf = py.import("focus_brush._native")?.getattr("__file__")?.extract()?;
    let build = build_checksum(&module).map_err(|error| exception(RenderError::io(&module, &error)))?;
    let options = ReportOptions {
        size,
        reference_spp,
        is_quick: quick,
        with_hard_cases: hard,
        build,
        unwrap: unwrap_options(py)?,
        resources: Resources::default(),
    };
    let warnings = Mutex::new(Vec::new());
    let report = work::run(py, "measuring", progress, |steps| {
        let note = |line: &str| {
            if let Some(warning) = line.strip_prefix("warning: ") {
                warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning.to_owned());
            }
        };
        Ok(::report::run(&requests, &options, &folder, steps, &note)?)
    })?;
    warn(py, &warnings.into_inner().unwrap_or_else(PoisonError::into_inner))?;
    let records: Vec<_> = report.measured.iter().map(|measured| &measured.record).collect();
    let told = json!({
        "files": report.files,
        "records": records,
        "new": report.new,
        "hard_cases": report.hard,
        "machine": report.machine,
        "seconds": report.seconds,
    });
    python_from_json(py, &told)
}
