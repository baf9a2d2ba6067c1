//! The focus map: what is painted, and what paints it.

mod focus_map;
mod source;

pub use focus_map::FocusMap;
pub use source::{Focus, FocusImage, FocusSource};
