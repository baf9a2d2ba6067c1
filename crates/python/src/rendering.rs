//! A picture of an input: what `Scene.render` and `Field.render` share.

use crate::camera::Camera;
use crate::errors::warn;
use crate::focus::FocusArgument;
use crate::lit_input::LitInput;
use crate::picture::Picture;
use crate::work;
use pyo3::prelude::*;
use render::{RenderOptions, render_lit_input};

/// Renders a picture, for a method of Python with these arguments.
pub fn picture(
    py: Python<'_>,
    scene: &LitInput,
    camera: Option<&Camera>,
    focus: Option<&Bound<'_, PyAny>>,
    options: &RenderOptions,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Picture> {
    let focus = FocusArgument::from_python(focus)?;
    let camera = camera.map_or_else(|| scene.input.camera.clone(), |camera| camera.0.clone());
    let rendered = work::run(py, "rendering", progress, |steps| {
        let focus = focus.evaluate(&scene.input, &scene.unwrap, steps)?;
        render_lit_input(&scene.input, &scene.lit()?, &camera, &focus, options, steps)
    })?;
    warn(py, &rendered.warnings)?;
    Ok(Picture::new(rendered, scene.input.exposure()))
}
