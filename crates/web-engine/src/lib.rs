//! The splatter as a program of a web page: a light field that visitors refocus and paint.
//!
//! ```text
//! page.html ── FieldOfPage (bytes) ─▶ Engine ─┬─ refocus(lens) ─────────────▶ screen pixels
//!                                             ├─ first surfaces ─▶ what a click focuses on
//!                                             └─ strokes ─▶ focus of samples ─▶ screen pixels
//! ```
//!
//! [`FieldOfPage`] is what a page holds: a light field whose samples have no surface addresses, with the focus of each of them. [`Engine`] draws
//! it, in the same bytes on every machine. Built for `wasm32-unknown-unknown`, the crate exports it by plain functions of numbers
//! (`exports`) and imports nothing. It is built without baking and without graphics cards, which are features of `salf` and `splat`.

mod brush;
mod engine;
mod error;
#[cfg(target_family = "wasm")]
mod exports;
mod field_of_page;
mod first_surfaces;
mod history;
mod sample_places;
mod stroke;
#[cfg(test)]
mod test_field;
#[cfg(test)]
mod tests;

pub use brush::{PageBrush, Paint};
pub use engine::{ApertureChoice, Engine, LensChoice, ScreenPixels};
pub use error::EngineError;
pub use field_of_page::FieldOfPage;
