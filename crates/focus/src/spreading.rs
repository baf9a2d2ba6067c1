//! Paint that finds edges: strokes spread over the surface to all that hangs together with them.
//!
//! ```text
//! Canvas ─▶ SurfaceLinks (which texels are neighbours) ─┐
//! colours ──────────────────────────────────────────────┴▶ SurfaceGraph ─┐
//! strokes of a layer ─▶ SpreadLabels (which texel has which value) ──────┴▶ SpreadField ─▶ values and mask, at any reach
//! ```

mod nearest_islands;
mod refined_selection;
mod spread_field;
mod spread_labels;
mod spread_settings;
mod surface_graph;
mod surface_link;
mod surface_links;

pub use spread_field::SpreadField;
pub use spread_labels::SpreadLabels;
pub use spread_settings::{Spread, SpreadSettings};
pub use surface_graph::{Likeness, SurfaceGraph};
