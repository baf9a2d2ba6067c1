//! The tools: what pointer and pen do in a view, and the marks drawn there.

pub mod active_tool;
pub mod brush_gesture;
pub mod brush_ring;
pub mod curve_stroke;
pub mod drag_tool;
pub mod navigation;
pub mod plane_tool;
pub mod region_highlight;
pub mod stroke_input;
pub mod tool;
pub mod tool_settings;
