//! `Focus`: t, anchor and gloss as arrays that scripts write, and what they mean to a picture.

use crate::camera::Camera;
use crate::lit_input::LitInput;
use crate::work;
use atlas::{Atlas, TexelMap, UnwrapOptions};
use document::{Input, texels_in_mask};
use focus::{FocusError, FocusMap, FocusSource};
use lens::FocusOffset;
use light::Steps;
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use render::RenderError;
use scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// What the elements of the arrays are.
#[derive(Clone)]
pub enum Over {
    /// Texels of the atlas.
    Atlas(Arc<Atlas>, Arc<TexelMap>),
    /// Parts of the scene.
    Part,
}

impl Over {
    /// The kinds by name.
    pub const NAMES: [&str; 2] = ["atlas", "part"];

    fn name(&self) -> &'static str {
        match self {
            Self::Atlas(..) => "atlas",
            Self::Part => "part",
        }
    }
}

/// How a scene is focused: t, anchor and gloss for each texel of its atlas, or for each of its parts, as arrays that
/// can be written. Made by Scene.focus().
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

/// The values of a [`Focus`], before they become arrays.
pub struct FocusValues {
    pub scene: Arc<Scene>,
    pub over: Over,
    pub shape: Vec<usize>,
    pub t: Vec<f32>,
    pub anchor: Vec<f32>,
    pub gloss: Vec<f32>,
    pub background: FocusOffset,
}

impl FocusValues {
    /// The focus of `file`, or that of the input's project, over the elements of this name.
    ///
    /// # Errors
    /// The file cannot be read, the scene cannot be unwrapped, or a focus that differs within parts is requested over parts.
    pub fn read(
        input: &Input,
        file: Option<&Path>,
        over: &str,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        let focus = input.focus(file, unwrap, steps)?;
        let (scene, background) = (input.scene.clone(), focus.background);
        if over == "part" {
            let value = |source: &FocusSource| match source {
                FocusSource::Constant(value) => Some(*value),
                FocusSource::Uv { .. } | FocusSource::Atlas { .. } => None,
            };
            let values: Option<Vec<_>> = focus.parts.iter().map(value).collect();
            let values = values.ok_or_else(|| {
                let what = "its focus differs within parts (use over=\"atlas\")";
                RenderError::bad_file(file.unwrap_or(&input.path), what)
            })?;
            let numbers = |number: fn(&FocusOffset) -> f64| values.iter().map(|v| number(v) as f32).collect();
            let [t, anchor, gloss] = [numbers(|v| v.t), numbers(|v| v.anchor), numbers(|v| v.gloss)];
            return Ok(Self {
                scene,
                over: Over::Part,
                shape: vec![values.len()],
                t,
                anchor,
                gloss,
                background,
            });
        }
        let painted = focus.parts.iter().find_map(|source| match source {
            FocusSource::Atlas { atlas, map } => Some((atlas.clone(), map.clone())),
            FocusSource::Constant(_) | FocusSource::Uv { .. } => None,
        });
        let atlas = match &painted {
            Some((atlas, _)) => atlas.clone(),
            None => input.atlas(unwrap, steps)?,
        };
        let texels = Arc::new(atlas.texel_map(&scene));
        let map = painted.map_or_else(|| Arc::new(focus.bake(&texels)), |(_, map)| map);
        let shape = vec![map.height() as usize, map.width() as usize];
        let (t, anchor) = map.to_rows().into_iter().map(|[t, anchor]| (t, anchor)).unzip();
        let gloss = map.gloss_rows().unwrap_or_else(|| vec![0.0; shape[0] * shape[1]]);
        Ok(Self { scene, over: Over::Atlas(atlas, texels), shape, t, anchor, gloss, background })
    }
}

impl Focus {
    /// Arrays of these values, of this scene.
    pub fn new(py: Python<'_>, scene: &LitInput, values: FocusValues) -> PyResult<Self> {
        let scene = scene.clone();
        let FocusValues { scene: _, over, shape, t, anchor, gloss, background } = values;
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
        let shape = match &self.over {
            Over::Atlas(atlas, _) => vec![atlas.height as usize, atlas.width as usize],
            Over::Part => vec![self.scene.input.scene.parts.len()],
        };
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
        Ok(FocusValues { scene, over, shape, t, anchor, gloss, background })
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
    /// The focus offset t, float32 of rows × columns of the atlas or one for each part; 1 is the ordinary lens.
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

    /// What the elements of the arrays are: "atlas" (texels) or "part".
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
    /// Raises ValueError for a mask of another size, or a focus over parts; TypeError for one that is not of bool.
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
            return Err(PyValueError::new_err(
                "select: the focus is over parts (use scene.focus(over=\"atlas\"))",
            ));
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
        format!("Focus(over={:?}, {} parts)", self.over.name(), self.scene.input.scene.parts.len())
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
        let FocusValues { scene, over, shape: _, t, anchor, gloss, background } = values;
        match over {
            Over::Part => {
                let numbers = t.into_iter().zip(anchor).zip(gloss);
                let offsets = numbers.map(|((t, anchor), gloss)| {
                    FocusOffset::new(t.into(), anchor.into()).with_gloss(gloss.into())
                });
                let parts: Vec<_> = offsets.map(FocusSource::Constant).collect();
                let focus = focus::Focus { scene, parts, background };
                let is_valid =
                    |source: &FocusSource| matches!(source, FocusSource::Constant(value) if value.is_valid());
                let all_valid = focus.parts.iter().all(is_valid) && background.is_valid();
                if all_valid { Ok(focus) } else { Err(bad_value()) }
            }
            Over::Atlas(atlas, texels) => {
                let rows: Vec<_> = t.into_iter().zip(anchor).map(|(t, anchor)| [t, anchor]).collect();
                let map = FocusMap::from_rows(atlas.width, atlas.height, &rows, background);
                // Without gloss the map's tiles stay blank, and carried light is not drawn twice.
                let is_matt = gloss.iter().all(|gloss| *gloss == 0.0);
                let with_gloss =
                    map.and_then(|mut map| (is_matt || map.set_gloss_rows(&gloss)).then_some(map));
                let mut map = with_gloss.filter(FocusMap::is_valid).ok_or_else(bad_value)?;
                map.fill_gutters(&texels);
                Ok(focus::Focus::from_atlas_map(scene, atlas, Arc::new(map)))
            }
        }
    }
}
