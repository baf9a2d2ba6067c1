//! The focus map: what is painted, and the tools that paint it.
//!
//! * [`FocusMap`]: t and anchor over the atlas, in copy-on-write tiles: a clone is a cheap snapshot.
//! * [`Focus`]: the focus of a whole scene, one source for each part; what the renderers evaluate.
//! * [`FocusRecipe`]: focus by name of material and node, for scripts; evaluates to a [`Focus`].
//! * [`Canvas`]: the surface behind the map's texels, searchable by world position.
//! * [`Brush`] and [`Stroke`]: painting with spheres along a path on the surface, as one transaction.
//! * [`FocusLayer`] and [`LayerStack`]: maps with masks, combined by a [`BlendMode`]. An [`Adjustment`] (a [`DepthCurve`], or a
//!   tilted or curved [`FocalPlane`]) makes an adjustment layer. The composite is a map again, which is what is rendered.
//! * [`Keys`]: values over time, of the lens ([`LensMotion`]) and of layers ([`LayerMotion`], [`LayerStack::at_time`]).
//! * [`LayerEdit`]: a change of the layers, as data.
//! * [`fill`]: one value over a node, part, material or chart. [`Gradient`]: a value that changes along a line.
//! * [`Selection`]: which texels may be painted. [`Symmetry`]: where else everything is painted.
//! * [`Spread`]: strokes of a layer, spread to all that hangs together with them ([`SurfaceGraph`], [`SpreadField`]).
//! * [`Edit`]: an undoable change. [`EditThumbnail`]: a small picture of a change. ⏎
//!
//! # Example
//!
//! ```
//! use focus::FocusMap;
//! use lens::FocusOffset;
//!
//! let mut map = FocusMap::new(64, 64, FocusOffset::STANDARD);
//! let before = map.clone(); // a snapshot: tiles are copied only when written
//! map.set(3, 4, [0.5, 1.0]);
//! assert_eq!(map.at(3, 4), FocusOffset::new(0.5, 1.0));
//! assert_eq!(before.at(3, 4), FocusOffset::STANDARD);
//! ```

mod bake;
mod canvas;
mod curve;
mod error;
mod focus_map;
mod layers;
mod motion;
mod painting;
mod recipe;
mod source;
mod spreading;
mod view_frame;

pub use canvas::{Canvas, CanvasTexel, CombineMode, Selection, SelectionResult};
pub use curve::Curve;
pub use error::FocusError;
pub use focus_map::{
    ChangedTexels, Edit, EditThumbnail, FocusImage, FocusMap, TILE_SIDE, ThumbnailCell, rectangle_union,
};
pub use layers::{Adjustment, BlendMode, DepthCurve, FocalPlane, FocusLayer, LayerEdit, LayerStack};
pub use motion::{Ease, FocusTarget, Key, KeySpan, KeyedCharacter, Keys, LayerMotion, LensMotion};
pub use painting::{
    Brush, BrushMode, Channels, FillTarget, FocusOffsetFields, Gradient, GradientLine, GradientShape,
    PenSample, Stroke, SurfaceHit, Symmetry, SymmetryImage, WORLD_AXES, draw_gradient, fill, fill_selected,
};
pub use recipe::{FocusRecipe, RecipeEntry};
pub use source::{Focus, FocusSource};
pub use spreading::{Likeness, Spread, SpreadField, SpreadLabels, SpreadSettings, SurfaceGraph};
pub use view_frame::ViewFrame;
