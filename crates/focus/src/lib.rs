//! The focus map: what is painted, and what paints it.
//!
//! * [`FocusMap`]: t and anchor over the atlas, in copy-on-write tiles: a clone is a cheap snapshot.
//! * [`Focus`]: the focus of a whole scene, a source a part; what the renderers ask.
//! * [`FocusRecipe`]: focus by name of material and node, for scripts; evaluates to a [`Focus`].
//! * [`Canvas`]: the surface behind the map's texels, found by world position.
//! * [`Brush`] and [`Stroke`]: painting with spheres along a path on the surface, as one transaction.
//! * [`FocusLayer`] and [`LayerStack`]: maps with masks, joined by a [`Blend`]; an [`Adjustment`] (a [`DepthCurve`], a tilted
//!   or curved [`FocalPlane`]) makes an adjustment layer. What they make together is a map again, and that is what is rendered.
//! * [`Keys`]: values at times; of the lens ([`LensMotion`]) and of layers ([`LayerMotion`], [`LayerStack::at`]).
//! * [`LayerEdit`]: a change of the layers, as data.
//! * [`fill`]: the same value over a node, part, material or chart. [`Gradient`]: one that changes along a line.
//! * [`Selection`]: what may be painted. [`Symmetry`]: where else everything is painted.
//! * [`Edit`]: what undo takes back and redo makes again. [`Thumbnail`]: a small picture of a change.

mod adjustment;
mod bake;
mod blend;
mod brush;
mod canvas;
mod changed;
mod curve;
mod dab;
mod depth_curve;
mod edit;
mod error;
mod fill;
mod focal_plane;
mod focus_image;
mod focus_map;
mod gradient;
mod layer;
mod layer_edit;
mod layer_stack;
mod motion;
mod recipe;
mod selection;
mod smooth;
mod source;
mod stroke;
mod symmetry;
mod texel_tree;
mod thumbnail;
mod tile_grid;
mod view_frame;
mod wash;

pub use adjustment::Adjustment;
pub use blend::BlendMode;
pub use brush::{Brush, BrushMode, Channels, FocusOffsetFields, PenSample};
pub use canvas::{Canvas, CanvasTexel};
pub use changed::{ChangedTexels, rectangle_union};
pub use curve::Curve;
pub use depth_curve::DepthCurve;
pub use edit::Edit;
pub use error::FocusError;
pub use fill::{FillTarget, fill, fill_selected};
pub use focal_plane::FocalPlane;
pub use focus_image::FocusImage;
pub use focus_map::FocusMap;
pub use gradient::{Gradient, GradientLine, GradientShape, draw_gradient};
pub use layer::FocusLayer;
pub use layer_edit::LayerEdit;
pub use layer_stack::LayerStack;
pub use motion::{Ease, FocusTarget, Key, KeySpan, Keys, LayerMotion, LensMotion};
pub use recipe::{FocusRecipe, RecipeEntry};
pub use selection::{CombineMode, Selection, SelectionResult};
pub use source::{Focus, FocusSource};
pub use stroke::{Stroke, SurfaceHit};
pub use symmetry::{Symmetry, SymmetryImage, WORLD_AXES};
pub use thumbnail::{EditThumbnail, ThumbnailCell};
pub use tile_grid::TILE_SIDE;
pub use view_frame::ViewFrame;
