//! `Field`: a baked light field.

use crate::camera::Camera;
use crate::errors::exception;
use crate::lit_input::LitInput;
use crate::picture::Picture;
use crate::render_options::render_options;
use crate::rendering::picture;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::write_salf;
use salf::{Salf, Sample, Visibility};
use std::path::PathBuf;
use std::sync::Arc;

/// A light field, baked for a camera: which light each small piece of surface sends to which part of the aperture.
/// Made by Scene.bake().
#[pyclass(frozen, module = "focus_brush")]
pub struct Field(pub LitInput);

impl Field {
    fn salf(&self) -> PyResult<&Arc<Salf>> {
        let missing = || render::RenderError::Internal("a field without samples (please report this)".into());
        self.0.input.salf.as_ref().ok_or_else(|| exception(missing()))
    }
}

#[pymethods]
impl Field {
    /// The camera that it was baked for.
    #[getter]
    fn camera(&self) -> Camera {
        Camera(self.0.input.camera.clone())
    }

    /// Renders a picture of it. `camera` may have another focus distance, aperture and character, and a smaller
    /// radius of the aperture; `options` are those of Scene.render() that apply to a light field.
    ///
    /// Raises ValueError for a camera that it was not baked for; warns if the focus needs a wider margin.
    #[pyo3(signature = (focus = None, camera = None, *, progress = None, **options))]
    fn render(
        &self,
        py: Python<'_>,
        focus: Option<&Bound<'_, PyAny>>,
        camera: Option<&Camera>,
        progress: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Picture> {
        let options = render_options(options, &self.0.input)?;
        picture(py, &self.0, camera, focus, &options, progress)
    }

    /// Writes it as .salf, which the program and open() read; it names the scene's file.
    ///
    /// Raises ValueError or OSError if the file cannot be written.
    fn write(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        let (input, salf) = (&self.0.input, self.salf()?);
        py.detach(|| write_salf(&file, &input.path, &input.scene, salf)).map(|_| ()).map_err(exception)
    }

    /// Its samples, as arrays by name: center and half_size (px, n × 2), inverse_depth, weight (px²), radiance (linear
    /// RGB, n × 3), triangle and part (−1 for the background), is_carried, is_open (the whole aperture sees it).
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let samples = &self.salf()?.samples;
        let samples: Vec<Sample> = py.detach(|| samples.to_vec());
        let count = samples.len();
        let pairs = |pair: fn(&Sample) -> [f32; 2]| samples.iter().flat_map(pair).collect::<Vec<f32>>();
        let numbers = |number: fn(&Sample) -> f32| samples.iter().map(number).collect::<Vec<f32>>();
        let flags = |flag: fn(&Sample) -> bool| samples.iter().map(flag).collect::<Vec<bool>>();
        let radiance: Vec<f32> = samples.iter().flat_map(|sample| sample.radiance.to_array()).collect();
        let triangle = |sample: &Sample| sample.surface.map_or(-1, |point| i64::from(point.triangle));
        let triangles: Vec<i64> = samples.iter().map(triangle).collect();
        let arrays = PyDict::new(py);
        let center = pairs(|sample| sample.center.to_array()).into_pyarray(py);
        arrays.set_item("center", center.reshape([count, 2])?)?;
        let half_size = pairs(|sample| sample.half_size.to_array()).into_pyarray(py);
        arrays.set_item("half_size", half_size.reshape([count, 2])?)?;
        arrays.set_item("inverse_depth", numbers(|sample| sample.inverse_depth).into_pyarray(py))?;
        arrays.set_item("weight", numbers(|sample| sample.weight).into_pyarray(py))?;
        arrays.set_item("radiance", radiance.into_pyarray(py).reshape([count, 3])?)?;
        arrays.set_item("triangle", triangles.into_pyarray(py))?;
        let triangles = &self.0.input.scene.triangles;
        let part = |sample: &Sample| {
            sample.surface.map_or(-1, |point| i64::from(triangles[point.triangle as usize].part))
        };
        let parts: Vec<i64> = samples.iter().map(part).collect();
        arrays.set_item("part", parts.into_pyarray(py))?;
        arrays.set_item("is_carried", flags(|sample| sample.is_carried).into_pyarray(py))?;
        let is_open = flags(|sample| sample.visibility == Visibility::Open).into_pyarray(py);
        arrays.set_item("is_open", is_open)?;
        Ok(arrays)
    }

    fn __len__(&self) -> PyResult<usize> {
        Ok(self.salf()?.samples.len())
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("Field({} samples)", self.salf()?.samples.len()))
    }
}
