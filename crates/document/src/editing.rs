//! Edits of a document's paint.
//!
//! Strokes, fills, gradients, selections and layers. Each is an undo step that can be recorded and replayed. Nothing here knows of rendered
//! pictures: functions return what they changed.

mod active_edit;
mod active_gradient;
mod depth_stroke;
mod edits;
mod object_axes;
mod paintable;
mod painter;
mod recorded_steps;
mod selection_shapes;
mod spreading;
mod stroke_point;

pub use active_edit::ActiveEdit;
pub use active_gradient::ActiveGradient;
pub use painter::Painter;
pub use recorded_steps::{apply_recorded_step, replay};
pub use selection_shapes::{SelectionMatches, SelectionTask, rectangle_outline};
pub use stroke_point::{FillRegion, StrokePoint, StrokeTarget};
