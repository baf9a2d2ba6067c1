//! The painting tools: brush strokes, fills and gradients, and the symmetry that repeats them.

pub(crate) mod brush;
mod dab;
mod fill;
mod gradient;
mod smoothed_values;
mod stroke;
mod stroke_painter;
pub(crate) mod symmetry;

pub use brush::{Brush, BrushMode, Channels, FocusOffsetFields, PenSample};
pub use fill::{FillTarget, fill, fill_selected};
pub use gradient::{Gradient, GradientLine, GradientShape, draw_gradient};
pub use stroke::{Stroke, SurfaceHit};
pub use symmetry::{Symmetry, SymmetryImage, WORLD_AXES};
