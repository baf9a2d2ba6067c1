//! `open` and `Scene`.

use crate::camera::Camera;
use crate::errors::{reading_exception, warn};
use crate::field::Field;
use crate::focus::{Focus, FocusArgument};
use crate::focus_values::{FocusValues, Over};
use crate::lit_input::LitInput;
use crate::picture::Picture;
use crate::render_options::render_options;
use crate::rendering::picture;
use crate::work;
use atlas::UnwrapOptions;
use document::{CameraChoice, Input};
use light::{DiskCache, LightQuality, Resources};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::{RenderError, RenderOptions, Renderer};
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

/// Opens what the program opens: a glTF file, a project, a capture (a folder, or a picture with its depth), Gaussian
/// splats or a baked light field. `variant` names a variant of its materials ("" for its own). `cache` is a folder
/// where computed light and atlases are kept for the next time; without one nothing is written. `progress` is called
/// as progress(share, step) with the share of a step that is done, in [0, 1]; what it raises stops the work and comes
/// out as it is.
///
/// Raises FileNotFoundError, ValueError for a file that cannot be used, OSError for a temporary problem; warns of
/// what is unusual about the file.
///
/// >>> import focus_brush as fb
/// >>> scene = fb.open("demo.glb")
/// >>> fb.open("nowhere.glb")
/// Traceback (most recent call last):
/// FileNotFoundError: nowhere.glb: cannot be read: No such file or directory (os error 2) (check the path and its permissions)
#[pyfunction]
#[pyo3(signature = (path, *, variant = None, cache = None, progress = None))]
pub fn open(
    py: Python<'_>,
    path: PathBuf,
    variant: Option<&str>,
    cache: Option<PathBuf>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Scene> {
    let unwrap = unwrap_options(py)?;
    let variant = document::VariantChoice::from_argument(variant);
    let resources =
        cache.map_or_else(Resources::default, |folder| Resources::with_cache(DiskCache::in_folder(&folder)));
    let opened = work::run(py, "opening", progress, |steps| {
        let mut input = match Input::open_variant(&path, &variant, &resources, steps) {
            Ok(input) => input,
            Err(error) => return Ok(Err(error)),
        };
        input.transfer_paint_if_changed(&unwrap, steps)?;
        Ok(Ok(input))
    })?;
    let input = opened.map_err(|error| reading_exception(&path, error))?;
    warn(py, &input.warnings)?;
    Ok(Scene(LitInput::new(input, unwrap)))
}

/// The options for unwrapping: its engines run in children of this Python.
pub fn unwrap_options(py: Python<'_>) -> PyResult<UnwrapOptions> {
    let executable: Option<PathBuf> = py.import("sys")?.getattr("executable")?.extract()?;
    let script: OsString = py.import("focus_brush")?.getattr("_UNWRAP_CHILD")?.extract()?;
    Ok(UnwrapOptions {
        child: executable.filter(|path| !path.as_os_str().is_empty()),
        // Neither the environment nor what is installed beside NumPy delays the child.
        child_arguments: vec!["-E".into(), "-S".into(), script],
        ..UnwrapOptions::default()
    })
}

/// An opened file. It never changes: what changes is the focus and the camera that pictures are made with.
#[pyclass(frozen, module = "focus_brush")]
pub struct Scene(LitInput);

#[pymethods]
impl Scene {
    /// The file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.0.input.path.clone()
    }

    /// What is unusual about the file, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.input.warnings.clone()
    }

    /// The project's camera, or the scene's first.
    #[getter]
    fn camera(&self) -> Camera {
        Camera(self.0.input.camera.clone())
    }

    /// The names of the scene's cameras.
    #[getter]
    fn cameras(&self) -> Vec<String> {
        self.0.input.scene.cameras.iter().map(|camera| camera.name.clone()).collect()
    }

    /// The camera of a name, "photo:NAME" for that of a photograph, or of a file (.json), whose missing fields are
    /// those of `camera`.
    ///
    /// Raises ValueError if there is none.
    fn find_camera(&self, name: PathBuf) -> PyResult<Camera> {
        let choice = CameraChoice::from_argument(name.as_os_str());
        let camera = self.0.input.camera(Some(&choice));
        camera.map(Camera).map_err(|error| match choice {
            CameraChoice::File(file) => reading_exception(&file, error),
            CameraChoice::Named(_) => crate::errors::exception(error),
        })
    }

    /// The parts of the scene as (node, material): what a focus over parts has an element for.
    #[getter]
    fn parts(&self) -> Vec<(String, String)> {
        let scene = &self.0.input.scene;
        let names = scene.parts.iter().map(|part| {
            let (node, material) =
                (&scene.nodes[part.node as usize], &scene.materials[part.material as usize]);
            (node.name.clone(), material.name.clone())
        });
        names.collect()
    }

    /// The number of triangles.
    #[getter]
    fn triangles(&self) -> usize {
        self.0.input.scene.triangles.len()
    }

    /// The focus of `file` (a recipe, a focus map or a table of splats), or that of the project, or of the ordinary
    /// lens, as arrays over the texels of the atlas ("atlas"), the parts ("part"), the triangles ("triangle") or the
    /// Gaussian splats ("splat"; what is no splat keeps its focus).
    ///
    /// Raises FileNotFoundError, or ValueError for a file that does not fit, a focus that differs within an element, or
    /// another `over`.
    ///
    /// >>> import focus_brush as fb
    /// >>> focus = fb.open("demo.glb").focus(over="part")
    /// >>> focus.t[:] = 1.02
    #[pyo3(signature = (file = None, *, over = "atlas", progress = None))]
    fn focus(
        &self,
        py: Python<'_>,
        file: Option<PathBuf>,
        over: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Focus> {
        if !Over::NAMES.contains(&over) {
            let available = Over::NAMES.join(", ");
            return Err(PyValueError::new_err(format!("over: there is no {over:?} (choose {available})")));
        }
        let values = work::run(py, "reading the focus", progress, |steps| {
            Ok(FocusValues::read(&self.0.input, file.as_deref(), over, &self.0.unwrap, steps))
        })?;
        let values = values.map_err(|error| match &file {
            Some(file) => reading_exception(file, error),
            None => crate::errors::exception(error),
        })?;
        Focus::new(py, &self.0, values)
    }

    /// Bakes the light field for a camera: from it, pictures of any focus distance, any smaller aperture and any
    /// focus are made quickly. Its margin is that of `focus`, by default the scene's own: what is to be blurred more
    /// needs light from farther outside the frame. `light_passes` refine the light by path tracing.
    ///
    /// Raises ValueError for a camera or focus that cannot be used.
    #[pyo3(signature = (camera = None, focus = None, *, light_passes = 0, progress = None))]
    fn bake(
        &self,
        py: Python<'_>,
        camera: Option<&Camera>,
        focus: Option<&Bound<'_, PyAny>>,
        light_passes: u32,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Field> {
        let focus = FocusArgument::from_python(focus)?;
        let LitInput { input, unwrap, .. } = &self.0;
        let camera = camera.map_or_else(|| input.camera.clone(), |camera| camera.0.clone());
        let options =
            RenderOptions { light: LightQuality::from_passes(light_passes), ..RenderOptions::default() };
        let salf = work::run(py, "baking", progress, |steps| {
            camera.validate().map_err(|error| RenderError::bad_file(&input.path, error))?;
            let focus = focus.evaluate(input, unwrap, steps)?;
            options.bake(&self.0.lit()?, &camera, &focus, steps)
        })?;
        let baked = Input { salf: Some(Arc::new(salf)), camera, ..Input::clone(input) };
        Ok(Field(self.0.with_input(baked)))
    }

    /// Renders a picture, as `focus-brush render` does. `focus` is a Focus, a file, or None for the project's own;
    /// `options` are those of the command line: renderer, spp, seed, tolerance, cells, light_passes, aov (a list),
    /// backend ("cpu", the default, "gpu" or "auto").
    ///
    /// Raises ValueError for what cannot be used, GpuAbsent without the requested card; warns of what the picture
    /// lacks.
    #[pyo3(signature = (camera = None, focus = None, *, progress = None, **options))]
    fn render(
        &self,
        py: Python<'_>,
        camera: Option<&Camera>,
        focus: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Picture> {
        let options = render_options(options, &self.0.input)?;
        picture(py, &self.0, camera, focus, &options, progress)
    }

    /// The ground truth by ray tracing, with `spp` rays per pixel.
    ///
    /// Raises ValueError for what cannot be used.
    #[pyo3(signature = (camera = None, focus = None, *, spp = 256, seed = 0, progress = None))]
    fn truth(
        &self,
        py: Python<'_>,
        camera: Option<&Camera>,
        focus: Option<&Bound<'_, PyAny>>,
        spp: u32,
        seed: u32,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Picture> {
        let options = PyDict::new(py);
        options.set_item("renderer", Renderer::Truth.name())?;
        options.set_item("spp", spp)?;
        options.set_item("seed", seed)?;
        self.render(py, camera, focus, progress, Some(&options))
    }

    fn __repr__(&self) -> String {
        format!("Scene({:?})", self.0.input.path)
    }
}
