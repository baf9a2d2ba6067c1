//! Threads and processes: how many threads work, and which processes may.

use crate::errors::exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use render::RenderError;
use std::ffi::OsString;
use std::sync::OnceLock;

/// The process in which work was done first.
static PROCESS: OnceLock<u32> = OnceLock::new();

/// Checks that this process may work: a fork of one that has worked has none of its threads, and would wait for them forever.
///
/// # Errors
/// It is such a fork.
pub fn check_process() -> PyResult<()> {
    if *PROCESS.get_or_init(std::process::id) == std::process::id() {
        return Ok(());
    }
    Err(PyRuntimeError::new_err(
        "this process was forked from one that has already used focus_brush, whose threads it lacks (start worker \
         processes with multiprocessing's method \"spawn\")",
    ))
}

/// Sets how many threads work. Call it before anything else; without it, RAYON_NUM_THREADS counts, or else there is
/// a thread for each processor. Results do not depend on it.
///
/// Raises ValueError for 0, and RuntimeError if work has begun.
///
/// >>> import focus_brush as fb
/// >>> fb.set_threads(0)
/// Traceback (most recent call last):
/// ValueError: threads: 0 cannot work (give 1 or more)
#[pyfunction]
pub fn set_threads(threads: usize) -> PyResult<()> {
    if threads == 0 {
        return Err(PyValueError::new_err("threads: 0 cannot work (give 1 or more)"));
    }
    check_process()?;
    jobs::start_global_pool(threads).map_err(|_| {
        let what = "threads: work has begun with another number (call set_threads before anything else)";
        exception(RenderError::Internal(what.into()))
    })
}

/// Unwraps patches of surface as a child process of `open`, and ends the process.
#[pyfunction]
#[pyo3(name = "_run_unwrap_child")]
pub fn run_unwrap_child(py: Python<'_>, arguments: Vec<OsString>) {
    py.detach(|| atlas::child::run(&arguments))
}
