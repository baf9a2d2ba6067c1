//! `Camera`: the fields of a camera file.

use crate::errors::{exception, reading_exception};
use crate::json::{json_from_fields, python_from_json};
use project::{
    ProjectError, camera_from_json, camera_to_json, read_aperture_mask, read_camera, write_camera,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};

/// What messages about fields that come from no file begin with.
const SOURCE: &str = "camera";

/// A wide-aperture camera: the fields of a camera file, as keyword arguments. Fields that are left out have the
/// values of a 50 mm lens at f/2, 960 × 540 px. Lengths are in scene units, angles in rad. It never changes:
/// replace() returns another.
///
/// Raises ValueError for an unknown field or a value out of range.
///
/// >>> import focus_brush as fb
/// >>> camera = fb.Camera(width=320, height=180, focus_distance=2.0)
/// >>> camera.replace(aperture_radius=0.05).aperture_radius
/// 0.05
/// >>> fb.Camera(focus_distance=-1)
/// Traceback (most recent call last):
/// ValueError: camera: focus_distance: cannot be used (it must be above 0, or "inf")
#[pyclass(frozen, eq, module = "focus_brush", from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Camera(pub lens::Camera);

fn camera_with(fields: Option<&Bound<'_, PyDict>>, defaults: &lens::Camera) -> PyResult<Camera> {
    let text = json_from_fields(fields)?.to_string();
    let read_mask = |name: &str| -> Result<_, ProjectError> { read_aperture_mask(Path::new(name), name) };
    camera_from_json(Path::new(SOURCE), &text, defaults, &read_mask).map(Camera).map_err(exception)
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (**fields))]
    fn new(fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        camera_with(fields, &lens::Camera::default())
    }

    /// Reads a camera file. Missing fields have the default values.
    ///
    /// Raises FileNotFoundError, or ValueError for what cannot be used in it.
    #[staticmethod]
    fn read(file: PathBuf) -> PyResult<Self> {
        let camera = read_camera(&file, &lens::Camera::default());
        camera.map(Self).map_err(|error| reading_exception(&file, error))
    }

    /// Writes a camera file.
    ///
    /// Raises OSError or ValueError if it cannot be written.
    fn write(&self, file: PathBuf) -> PyResult<()> {
        write_camera(&file, &self.0).map_err(exception)
    }

    /// Another camera, with these fields replaced; `size` is (width, height).
    ///
    /// Raises ValueError for an unknown field or a value out of range.
    ///
    /// >>> import focus_brush as fb
    /// >>> fb.Camera().replace(size=(640, 360), focus_distance=float("inf"))
    /// Camera(640 × 360, focus_distance=inf, aperture_radius=0.0125)
    #[pyo3(signature = (*, size = None, **fields))]
    fn replace(&self, size: Option<[u32; 2]>, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let [width, height] = size.unwrap_or([self.0.width, self.0.height]);
        camera_with(fields, &lens::Camera { width, height, ..self.0.clone() })
    }

    /// All fields, as a camera file has them.
    ///
    /// >>> import focus_brush as fb
    /// >>> fb.Camera().to_dict()["sensor_height"]
    /// 0.024
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_from_json(py, &camera_to_json(&self.0))
    }

    /// Columns of the picture.
    #[getter]
    fn width(&self) -> u32 {
        self.0.width
    }

    /// Rows of the picture.
    #[getter]
    fn height(&self) -> u32 {
        self.0.height
    }

    /// Full vertical angle of view, rad.
    #[getter]
    fn yfov(&self) -> f64 {
        self.0.yfov
    }

    /// Distance to the focus plane along the axis, in scene units; may be infinite.
    #[getter]
    fn focus_distance(&self) -> f64 {
        self.0.focus_distance
    }

    /// Half the side of the square that the aperture lies in, in scene units; 0 is a pinhole.
    #[getter]
    fn aperture_radius(&self) -> f64 {
        self.0.aperture_radius
    }

    /// Height of the sensor, in scene units.
    #[getter]
    fn sensor_height(&self) -> f64 {
        self.0.sensor_height
    }

    /// The f-number.
    #[getter]
    fn f_number(&self) -> f64 {
        self.0.f_number()
    }

    fn __repr__(&self) -> String {
        let lens::Camera { width, height, focus_distance, aperture_radius, .. } = &self.0;
        format!(
            "Camera({width} × {height}, focus_distance={focus_distance}, aperture_radius={aperture_radius})"
        )
    }
}
