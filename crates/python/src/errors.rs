//! Errors of the crates below as Python exceptions, with the sentences of the command line.

use pyo3::exceptions::{PyException, PyFileNotFoundError, PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use render::RenderError;
use std::path::Path;

pyo3::create_exception!(focus_brush, Cancelled, PyException, "The work was cancelled.");
pyo3::create_exception!(
    focus_brush,
    GpuAbsent,
    PyRuntimeError,
    "A graphics card was requested, and none is able to do the work."
);

/// The exception for an error.
pub fn exception(error: impl Into<RenderError>) -> PyErr {
    match error.into() {
        RenderError::BadInput(text) => PyValueError::new_err(text),
        RenderError::TryAgain(text) => PyOSError::new_err(text),
        RenderError::GpuAbsent(text) => GpuAbsent::new_err(text),
        RenderError::Cancelled => Cancelled::new_err("cancelled"),
        RenderError::Internal(text) => PyRuntimeError::new_err(text),
    }
}

/// The same for an error of reading `file`, or a file of its folder.
pub fn reading_exception(file: &Path, error: impl Into<RenderError>) -> PyErr {
    match error.into() {
        RenderError::BadInput(text) if !file.exists() => PyFileNotFoundError::new_err(text),
        other => exception(other),
    }
}

/// Gives each sentence to Python's `warnings`.
pub fn warn(py: Python<'_>, sentences: &[String]) -> PyResult<()> {
    if sentences.is_empty() {
        return Ok(());
    }
    let warnings = py.import("warnings")?;
    sentences.iter().try_for_each(|sentence| warnings.call_method1("warn", (sentence,)).map(|_| ()))
}
