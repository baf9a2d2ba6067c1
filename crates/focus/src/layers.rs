//! Layers of focus: painted layers and adjustment layers, how they blend, and the stack that composites them.

mod adjustment;
mod blend_mode;
mod depth_curve;
mod focal_plane;
mod layer;
mod layer_edit;
mod layer_stack;

pub use adjustment::Adjustment;
pub use blend_mode::BlendMode;
pub use depth_curve::DepthCurve;
pub use focal_plane::FocalPlane;
pub use layer::FocusLayer;
pub use layer_edit::LayerEdit;
pub use layer_stack::LayerStack;
