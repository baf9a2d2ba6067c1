//! `compare`: error measures between two pictures.

use crate::errors::{exception, reading_exception};
use crate::json::python_from_json;
use crate::picture::Picture;
use numpy::PyReadonlyArray3;
use project::{LinearPicture, read_picture};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// How far picture `a` is from the reference `b`: the measures of `focus-brush compare --json`, by name (rmse, psnr,
/// rel_mse, flip, signed_mean_error, …). Each is a Picture, a file, or an array of height × width × 3, linear RGB.
/// `exposure` is that of Pictures, see Picture.exposed().
///
/// Raises ValueError if the sizes differ, FileNotFoundError or ValueError for files.
///
/// >>> import numpy as np, focus_brush as fb
/// >>> white, grey = np.ones((4, 6, 3)), np.full((4, 6, 3), 0.9)
/// >>> round(fb.compare(grey, white)["psnr"], 3)
/// 20.0
#[pyfunction]
#[pyo3(signature = (a, b, *, exposure = None))]
pub fn compare<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    exposure: Option<&str>,
) -> PyResult<Bound<'py, PyAny>> {
    let (a, b) = (linear_picture("a", a, exposure)?, linear_picture("b", b, exposure)?);
    let errors = py.detach(|| project::compare(&a, &b)).map_err(exception)?;
    python_from_json(py, &serde_json::json!(errors))
}

fn linear_picture(name: &str, value: &Bound<'_, PyAny>, exposure: Option<&str>) -> PyResult<LinearPicture> {
    if let Ok(picture) = value.cast::<Picture>() {
        return picture.get().linear_picture(exposure);
    }
    if let Ok(file) = value.extract::<PathBuf>() {
        let picture = value.py().detach(|| read_picture(&file));
        return picture.map_err(|error| reading_exception(&file, error));
    }
    // NumPy converts what is no array of float32: other numbers, lists, other libraries' arrays.
    let settings = PyDict::new(value.py());
    settings.set_item("dtype", "float32")?;
    let array = value.py().import("numpy")?.call_method("asarray", (value,), Some(&settings));
    let array = array.map_err(|_| {
        let what = "is no picture (give a Picture, a file, or an array of height × width × 3)";
        PyTypeError::new_err(format!("{name}: {} {what}", value.get_type()))
    })?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let [height, width, 3] = shape[..] else {
        let what = "its shape must be height × width × 3";
        return Err(PyValueError::new_err(format!("{name}: an array of the shape {shape:?} ({what})")));
    };
    let array: PyReadonlyArray3<'_, f32> = array.extract()?;
    let side = |side: usize| {
        let unusable =
            || PyValueError::new_err(format!("{name}: {side} px do not make a picture (1 to 16384)"));
        u32::try_from(side)
            .ok()
            .filter(|side| (1..=lens::Camera::LARGEST_SIDE_PX).contains(side))
            .ok_or_else(unusable)
    };
    let (width, height) = (side(width)?, side(height)?);
    let values: Vec<f32> = array.as_array().iter().copied().collect();
    let rgb = values.as_chunks::<3>().0.to_vec();
    Ok(LinearPicture { width, height, rgb, ..LinearPicture::default() })
}
