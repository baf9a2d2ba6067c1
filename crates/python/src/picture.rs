//! `Picture`: a rendered picture, whose arrays NumPy reads where they are.

use crate::errors::{exception, reading_exception};
use lens::Exposure;
use numpy::ndarray::{ArrayView2, ArrayView3};
use numpy::{IntoPyArray, PyArray2, PyArray3, PyArrayMethods};
use project::{LinearPicture, PictureOptions, read_picture, write_picture};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::Rendered;
use std::path::PathBuf;

/// A rendered picture: linear RGB with Rec. 709 primaries, row 0 on top. Its arrays are views that cannot be
/// written; copy() them to change them.
#[pyclass(frozen, module = "focus_brush")]
pub struct Picture {
    rendered: Rendered,
    /// The exposure that it has unless another is requested.
    exposure: Exposure,
}

impl Picture {
    pub fn new(rendered: Rendered, exposure: Exposure) -> Self {
        Self { rendered, exposure }
    }

    /// The picture as `compare` takes it.
    pub fn linear_picture(&self, exposure: Option<&str>) -> PyResult<LinearPicture> {
        Ok(LinearPicture::from_picture(&self.rendered.picture, self.exposure_named(exposure)?))
    }

    fn exposure_named(&self, name: Option<&str>) -> PyResult<Exposure> {
        match name {
            None => Ok(self.exposure),
            Some("normalise") => Ok(Exposure::Normalise),
            Some("conserve") => Ok(Exposure::Conserve),
            Some(other) => Err(PyValueError::new_err(format!(
                "exposure: there is no {other:?} (choose normalise or conserve)"
            ))),
        }
    }
}

/// A read-only array over `values`, height × width, which `owner` holds.
#[allow(unsafe_code, reason = "NumPy reads memory of ours")]
fn view<'py>(owner: &Bound<'py, Picture>, values: &[f32]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let array = ArrayView2::from_shape(size(owner), values).map_err(size_fault)?;
    // SAFETY: `values` belong to `owner`, which is frozen: they are neither moved nor freed while the array keeps it alive.
    let array = unsafe { PyArray2::borrow_from_array(&array, owner.clone().into_any()) };
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

/// The same, height × width × RGB.
#[allow(unsafe_code, reason = "NumPy reads memory of ours")]
fn view_of_colours<'py>(
    owner: &Bound<'py, Picture>,
    values: &[[f32; 3]],
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let [height, width] = size(owner);
    let array = ArrayView3::from_shape([height, width, 3], values.as_flattened()).map_err(size_fault)?;
    // SAFETY: as in `view`.
    let array = unsafe { PyArray3::borrow_from_array(&array, owner.clone().into_any()) };
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

/// Rows and columns.
fn size(picture: &Bound<'_, Picture>) -> [usize; 2] {
    let picture = &picture.get().rendered.picture;
    [picture.height as usize, picture.width as usize]
}

fn size_fault(error: numpy::ndarray::ShapeError) -> PyErr {
    exception(render::RenderError::Internal(format!(
        "a picture of another size: {error} (please report this)"
    )))
}

/// The linear RGB of a picture file, float32 of height × width × 3: .exr, .hdr, .png, .jpg or .webp.
///
/// Raises FileNotFoundError, or ValueError for a file that cannot be used.
///
/// >>> import focus_brush as fb
/// >>> picture = fb.open("demo.glb").truth(fb.Camera(width=32, height=18), spp=1)
/// >>> picture.write("picture.exr")
/// >>> bool((fb.read_picture("picture.exr") == picture.exposed()).all())
/// True
#[pyfunction]
#[pyo3(name = "read_picture")]
pub fn read_picture_file(py: Python<'_>, file: PathBuf) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let picture = py.detach(|| read_picture(&file)).map_err(|error| reading_exception(&file, error))?;
    let [height, width] = [picture.height as usize, picture.width as usize];
    picture.rgb.into_flattened().into_pyarray(py).reshape([height, width, 3])
}

#[pymethods]
impl Picture {
    /// Linear RGB as the model sums it, float32 of height × width × 3: not divided by coverage.
    #[getter]
    fn radiance<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        view_of_colours(this, &this.get().rendered.picture.radiance)
    }

    /// The same sum for a scene of radiance 1, float32 of height × width: 1 where nothing is painted.
    #[getter]
    fn coverage<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        view(this, &this.get().rendered.picture.coverage)
    }

    /// The extra channels that were requested, by name, each float32 of height × width.
    #[getter]
    fn layers<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let layers = PyDict::new(this.py());
        for layer in &this.get().rendered.layers {
            layers.set_item(&layer.name, view(this, &layer.values)?)?;
        }
        Ok(layers)
    }

    /// The picture as it is shown and written, float32 of height × width × 3, a new array. `exposure` is "normalise"
    /// (radiance over coverage: white stays white) or "conserve" (radiance itself); by default what the scene's
    /// project says, else "normalise".
    ///
    /// Raises ValueError for another exposure.
    #[pyo3(signature = (exposure = None))]
    fn exposed<'py>(this: &Bound<'py, Self>, exposure: Option<&str>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let (py, [height, width], picture) = (this.py(), size(this), this.get());
        let exposure = picture.exposure_named(exposure)?;
        let rgb = py.detach(|| picture.rendered.picture.exposed(exposure));
        rgb.into_flattened().into_pyarray(py).reshape([height, width, 3])
    }

    /// Writes the picture and its layers as .exr or .png: the file of `focus-brush render`, byte for byte.
    ///
    /// Raises ValueError for another extension or exposure, OSError if the disk is full.
    #[pyo3(signature = (file, *, exposure = None))]
    fn write(&self, py: Python<'_>, file: PathBuf, exposure: Option<&str>) -> PyResult<()> {
        let Rendered { picture, layers, attributes, .. } = &self.rendered;
        let exposure = self.exposure_named(exposure)?;
        let options =
            PictureOptions { exposure, attributes: attributes.clone(), ..PictureOptions::default() };
        let written = py.detach(|| write_picture(&file, picture, layers, &options));
        written.map(|_| ()).map_err(exception)
    }

    /// Columns.
    #[getter]
    fn width(&self) -> u32 {
        self.rendered.picture.width
    }

    /// Rows.
    #[getter]
    fn height(&self) -> u32 {
        self.rendered.picture.height
    }

    /// What the picture lacks, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.rendered.warnings.clone()
    }

    fn __repr__(&self) -> String {
        format!("Picture({} × {})", self.width(), self.height())
    }
}
