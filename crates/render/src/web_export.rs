//! Web pages: a picture that anyone can refocus, drawn at many focus distances.
//!
//! ```text
//! first surfaces ─▶ range of distances, maps ──────────────────────────┐
//!        └─▶ for each aperture: bake once ─▶ sum at each distance ─▶ slices ─▶ page
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
