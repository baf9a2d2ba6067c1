//! A picture and its disparities as a surface.
//!
//! All computation is in the picture's own space: columns, rows, and disparity, in which planes of the world are linear and which does not
//! depend on scale and offset of the disparities. Lengths are measured as *parallax*: the number of pixels by which a disparity moves a
//! point of the picture between the middle of the aperture and its rim.
//!
//! ```text
//! disparities ─▶ jumps ─▶ matte ─▶ hidden ─▶ corners ─▶ triangulation ─▶ Relief
//!  (per pixel)    │       │ ▲        │                                   ▲
//!                 │       │ │        └──────▶ texture (resampled from    ┘
//!                 │       │ └ snapping         other views, or invented)
//!                 │       └ pixels that show both sides separated (cut by an outline, or translucent)
//!                 └ cut where depth jumps, pixels between two depths assigned to one side
//! ```
//!
//! A pixel is a cell between four corners; adjacent cells share corners unless depth jumps between them. Behind an occluder a second layer
//! of cells continues as far as the aperture can see behind it. Triangles are merged while the surface stays within a tolerance
//! (`mesh::triangulation`). Where other views show another colour than the picture, that is `gloss`. Every layer has the whole picture's
//! area in the texture, one below the other: the texture is an atlas, and the picture is its upper part.
//!
//! ```
//! use progress::Unwatched;
//! use relief::{Relief, ReliefOptions};
//! use std::convert::Infallible;
//!
//! // A flat picture is two triangles.
//! let (disparity, picture) = (vec![0.0; 8 * 6], vec![[0.5; 3]; 8 * 6]);
//! let options = ReliefOptions::default();
//! let relief = Relief::build::<Infallible>([8, 6], &disparity, &picture, &[], &options, &Unwatched).unwrap();
//! assert!(relief.triangles.len() < 2 * 8 * 6 && relief.hidden_triangles() == 0);
//! ```

mod color_stats;
mod depth_map;
mod edges;
mod error;
mod frame;
mod gloss;
mod hidden;
mod mesh;
mod other_view;
mod relief;
mod resampling;
mod snapping;
mod texture;

pub use depth_map::filling::fill_unknown_disparity;
pub use depth_map::repair::{DepthRepair, DepthStroke, apply_depth_strokes};
pub use depth_map::roughness::measure_roughness;
pub use depth_map::upsampling::upsample;
pub use error::ReliefError;
pub use gloss::{GLOSS_TERMS, Gloss};
pub use other_view::OtherView;
pub use relief::{Relief, ReliefOptions, ReliefVertex, TEXTURE_LAYERS};
