//! What painting does to a document.
//!
//! Strokes, fills, gradients, selections and layers, each a step of undo that can be recorded and done again. Nothing here
//! knows of pictures: what changed is returned.

mod depth_stroke;
mod edits;
mod gradient_in_hand;
mod object_axes;
mod paintable;
mod painter;
mod replay;
mod selecting;
mod stroke_point;
mod underway;

pub use replay::replay;
pub use selecting::rectangle_outline;
pub use stroke_point::{FillRegion, StrokePoint, StrokeTarget};

pub(crate) use gradient_in_hand::ActiveGradient;
pub(crate) use painter::Painter;
pub(crate) use replay::apply_recorded_step;
pub(crate) use underway::ActiveEdit;
