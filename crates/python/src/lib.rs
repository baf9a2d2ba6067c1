//! The Python module `focus_brush`: scenes opened, focused, rendered and compared, as NumPy arrays.
//!
//! ```text
//! file ─▶ Scene ─▶ Field ─▶ Picture ─▶ arrays, files, compare
//!           │ ▲ Camera, Focus (t, anchor, gloss as arrays)
//!           └ truth ──▶ Picture
//! ```
//!
//! A thin layer over the crates `document`, `render` and `report`, with nothing of its own to compute: values from Python become theirs (`json`,
//! `focus_values`, `render_options`), their results become arrays (`picture`, `field`) and their errors exceptions (`errors`). Long work runs on
//! a thread of its own while the calling one hears Ctrl-C (`work`). What the functions do is documented for Python: in their doc
//! comments, which are the docstrings, and with types in `focus_brush/__init__.pyi`.

mod camera;
mod comparison;
mod errors;
mod field;
mod focus;
mod focus_values;
mod json;
mod lit_input;
mod picture;
mod render_options;
mod rendering;
mod report;
mod scene;
mod threads;
mod work;

use pyo3::prelude::*;

/// The compiled part of `focus_brush`.
#[pymodule(gil_used = false)]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Cancelled", module.py().get_type::<errors::Cancelled>())?;
    module.add("GpuAbsent", module.py().get_type::<errors::GpuAbsent>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<focus::Focus>()?;
    module.add_class::<field::Field>()?;
    module.add_class::<picture::Picture>()?;
    module.add_function(wrap_pyfunction!(scene::open, module)?)?;
    module.add_function(wrap_pyfunction!(comparison::compare, module)?)?;
    module.add_function(wrap_pyfunction!(report::report, module)?)?;
    module.add_function(wrap_pyfunction!(picture::read_picture_file, module)?)?;
    module.add_function(wrap_pyfunction!(threads::set_threads, module)?)?;
    module.add_function(wrap_pyfunction!(threads::run_unwrap_child, module)?)
}
