//! `Focus`: t, anchor and gloss as arrays that scripts write.

use crate::camera::Camera;
use crate::focus_values::{FocusValues, Over};
use crate::lit_input::LitInput;
use crate::work;
use atlas::UnwrapOptions;
use document::{Input, texels_in_mask};
use focus::FocusError;
use lens::FocusOffset;
use light::Steps;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use render::RenderError;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// How a scene is focused: t, anchor and gloss for each texel of its atlas, or for each of its parts, triangles or
/// Gaussian splats, as arrays that can be written. Made by Scene.focus().
///
/// Pictures read the arrays when they are rendered; what is written later does not change them.
#[pyclass(frozen, module = "focus_brush")]
pub struct Focus {
    scene: LitInput,
    over: Over,
    t: Py<PyArrayDyn<f32>>,
    anchor: Py<PyArrayDyn<f32>>,
    gloss: Py<PyArrayDyn<f32>>,
    background: Mutex<FocusOffset>,
}

impl Focus {
    /// Arrays of these values, of this scene.
    pub fn new(py: Python<'_>, scene: &LitInput, values: FocusValues) -> PyResult<Self> {
        let scene = scene.clone();
        let FocusValues { scene: described, over, t, anchor, gloss, background } = values;
        let shape = over.shape(&described);
        let array =
            |values: Vec<f32>| Ok::<_, PyErr>(values.into_pyarray(py).reshape(shape.clone())?.unbind());
        let [t, anchor, gloss] = [array(t)?, array(anchor)?, array(gloss)?];
        Ok(Self { scene, over, t, anchor, gloss, background: Mutex::new(background) })
    }

    /// A copy of the values.
    ///
    /// # Errors
    /// A script has given an array another shape.
    fn values(&self, py: Python<'_>) -> PyResult<FocusValues> {
        let shape = self.over.shape(&self.scene.input.scene);
        let read = |name: &str, array: &Py<PyArrayDyn<f32>>| {
            let array = array.bind(py).try_readonly()?;
            let view = array.as_array();
            if view.shape() != shape {
                let found = view.shape();
                let what = format!("{name}: the array has the shape {found:?} (it must be {shape:?})");
                return Err(PyValueError::new_err(what));
            }
            Ok(view.iter().copied().collect())
        };
        let [t, anchor, gloss] =
            [read("t", &self.t)?, read("anchor", &self.anchor)?, read("gloss", &self.gloss)?];
        let (scene, over, background) =
            (self.scene.input.scene.clone(), self.over.clone(), self.background());
        Ok(FocusValues { scene, over, t, anchor, gloss, background })
    }

    fn background(&self) -> FocusOffset {
        *self.background.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Writes `value`, a number or anything that NumPy broadcasts, into all of an array.
fn assign(py: Python<'_>, array: &Py<PyArrayDyn<f32>>, value: &Bound<'_, PyAny>) -> PyResult<()> {
    array.bind(py).set_item(py.Ellipsis(), value)
}

#[pymethods]
impl Focus {
    /// The focus offset t, float32 of rows × columns of the atlas or one for each element; 1 is the ordinary lens.
    /// Assigning writes into the array.
    #[getter]
    fn t(&self, py: Python<'_>) -> Py<PyArrayDyn<f32>> {
        self.t.clone_ref(py)
    }

    #[setter]
    fn set_t(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        assign(py, &self.t, value)
    }

    /// What t is relative to, in [0, 1], as t: 0 the sensor, 1 the point's own conjugate, where t = 1 is sharp.
    #[getter]
    fn anchor(&self, py: Python<'_>) -> Py<PyArrayDyn<f32>> {
        self.anchor.clone_ref(py)
    }

    #[setter]
    fn set_anchor(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        assign(py, &self.anchor, value)
    }

    /// How far mirrored and transmitted light obeys t and anchor, in [0, 1], as t.
    #[getter]
    fn gloss(&self, py: Python<'_>) -> Py<PyArrayDyn<f32>> {
        self.gloss.clone_ref(py)
    }

    #[setter]
    fn set_gloss(&self, py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<()> {
        assign(py, &self.gloss, value)
    }

    /// (t, anchor, gloss) of the background.
    #[getter(background)]
    fn python_background(&self) -> (f64, f64, f64) {
        let FocusOffset { t, anchor, gloss } = self.background();
        (t, anchor, gloss)
    }

    #[setter(background)]
    fn set_background(&self, value: (f64, f64, f64)) {
        let (t, anchor, gloss) = value;
        let value = FocusOffset::new(t, anchor).with_gloss(gloss);
        *self.background.lock().unwrap_or_else(PoisonError::into_inner) = value;
    }

    /// What the elements of the arrays are: "atlas" (texels), "part", "triangle" or "splat".
    #[getter]
    fn over(&self) -> &'static str {
        self.over.name()
    }

    /// Makes everything sharp: t and anchor 1, the background's, too.
    fn sharpen(&self, py: Python<'_>) -> PyResult<()> {
        let one = 1.0f32.into_pyobject(py)?.into_any();
        assign(py, &self.t, &one)?;
        assign(py, &self.anchor, &one)?;
        *self.background.lock().unwrap_or_else(PoisonError::into_inner) = FocusOffset::SHARP;
        Ok(())
    }

    /// Which elements a camera sees where `mask` is true, as an array of bool over the atlas. `mask` has the rows and
    /// columns of the camera's picture; `camera` is by default the scene's.
    ///
    /// Raises ValueError for a mask of another size, or a focus over something else; TypeError for one that is not of bool.
    ///
    /// >>> import numpy as np, focus_brush as fb
    /// >>> scene = fb.open("demo.glb")
    /// >>> focus, mask = scene.focus(), np.zeros((scene.camera.height, scene.camera.width), bool)
    /// >>> mask[:, :480] = True
    /// >>> focus.t[focus.select(mask)] = 1.02
    #[pyo3(signature = (mask, camera = None))]
    fn select<'py>(
        &self,
        py: Python<'py>,
        mask: PyReadonlyArray2<'py, bool>,
        camera: Option<&Camera>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let Over::Atlas(_, texels) = &self.over else {
            let what =
                format!("select: the focus is over {}s (use scene.focus(over=\"atlas\"))", self.over.name());
            return Err(PyValueError::new_err(what));
        };
        let camera = camera.map_or_else(|| self.scene.input.camera.clone(), |camera| camera.0.clone());
        let size = [camera.height as usize, camera.width as usize];
        let view = mask.as_array();
        if view.shape() != size {
            let what = format!(
                "mask: an array of the shape {:?} (it must be {size:?}, as the picture)",
                view.shape()
            );
            return Err(PyValueError::new_err(what));
        }
        let mask: Vec<bool> = view.iter().copied().collect();
        let selected = work::run(py, "selecting", None, |_| {
            Ok(texels_in_mask(self.scene.lit()?.tracer(), texels, &camera, &mask))
        })?;
        selected.into_pyarray(py).reshape(vec![texels.height as usize, texels.width as usize])
    }

    fn __repr__(&self) -> String {
        format!("Focus(over={:?}, {:?})", self.over.name(), self.over.shape(&self.scene.input.scene))
    }
}

/// The focus that a picture is rendered with.
pub enum FocusArgument {
    /// The project's, or the ordinary lens.
    Own,
    /// A recipe, a focus map or a table of splats.
    File(PathBuf),
    /// Arrays.
    Values(FocusValues),
}

impl FocusArgument {
    /// The focus that a function of Python is called with.
    ///
    /// # Errors
    /// It is neither a [`Focus`], nor a path, nor None; or an array of it has another shape.
    pub fn from_python(value: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(value) = value else { return Ok(Self::Own) };
        if let Ok(focus) = value.cast::<Focus>() {
            return Ok(Self::Values(focus.get().values(value.py())?));
        }
        value.extract().map(Self::File).map_err(|_| {
            PyTypeError::new_err(format!(
                "focus: {} is no focus (give a Focus, a file or None)",
                value.get_type()
            ))
        })
    }

    /// The focus of the scene of `input`.
    ///
    /// # Errors
    /// The file cannot be read or does not fit; a value is not finite or out of range; the arrays belong to another scene.
    pub fn evaluate(
        self,
        input: &Input,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<focus::Focus, RenderError> {
        let values = match self {
            Self::Own => return Ok(input.focus(None, unwrap, steps)?),
            Self::File(file) => return Ok(input.focus(Some(&file), unwrap, steps)?),
            Self::Values(values) => values,
        };
        if !Arc::ptr_eq(&values.scene, &input.scene) {
            let what = "it belongs to another scene (use the focus() of this one)";
            return Err(RenderError::BadInput(format!("focus: {what}")));
        }
        let bad_value = || RenderError::BadInput(FocusError::BadValue { entry: "focus".into() }.to_string());
        values.evaluate().ok_or_else(bad_value)
    }
}
