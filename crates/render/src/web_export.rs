//! Web pages: a picture that anyone can refocus, drawn at many focus distances; or a light field with the program that draws it.
//!
//! ```text
//! first surfaces ─▶ range of distances, maps ──────────────────────────┐
//!        └─▶ for each aperture: bake once ─▶ sum at each distance ─▶ slices ─▶ page
//!
//! light field, focus of its samples ─▶ page of the engine, which draws and paints by itself
//! ```

mod engine_page;
mod estimate;
mod export;
mod first_surfaces;
mod options;
mod page_error;
mod report;
mod stacks;

pub use engine_page::{export_engine_page, usual_engine_camera};
pub use estimate::{WebPageEstimate, estimate_web_page};
pub use export::export_web_page;
pub use options::WebPageOptions;
pub use report::{StackReport, WebPageReport};
pub use web_page::Caption;
