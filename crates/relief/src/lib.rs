//! A picture and its disparities as a surface.
//!
//! All is thought in the picture's own space: columns, rows, and disparity, in which a plane of the world is linear and which no scale or
//! offset of the disparities changes. Lengths are told as *parallax*: by how many pixels a disparity moves what the picture shows between
//! the middle of the aperture and its rim.
//!
//! ```text
//! disparities ─▶ jumps ─▶ matte ─▶ hidden ─▶ corners ─▶ triangulation ─▶ Relief
//!  (a pixel each)  │       │ ▲        │                                   ▲
//!                  │       │ │        └──────▶ texture (from other_views, ┘
//!                  │       │ └ snapping                 or invented)
//!                  │       └ pixels that show both sides told apart (cut by an outline, or there in part)
//!                  └ cut where depth jumps, pixels between put on one side
//! ```
//!
//! A pixel is a cell between four corners; cells beside each other share corners unless depth jumps between them. Behind what stands before
//! something, a second layer of cells goes on as far as the aperture may look. Triangles are joined while the surface stays within a
//! tolerance (`triangulation`). What the picture shows and other views show otherwise is `gloss`. Every layer has the whole picture's place in the texture, one below the other: the texture is an atlas, and
//! the picture is its upper part.

mod cells;
mod corners;
mod covers;
mod error;
mod fading;
mod filling;
mod frame;
mod gloss;
mod hidden;
mod jumps;
mod look;
mod matte;
mod other_view;
mod other_views;
mod outline;
mod relief;
mod repair;
mod roughness;
mod snapping;
mod steps;
mod texture;
mod triangulation;
mod upsampling;

pub use error::ReliefError;
pub use filling::fill_unknown_disparity;
pub use gloss::{GLOSS_TERMS, Gloss};
pub use other_view::OtherView;
pub use relief::{Relief, ReliefOptions, ReliefVertex, TEXTURE_LAYERS};
pub use repair::{DepthRepair, DepthStroke, apply_depth_strokes};
pub use roughness::measure_roughness;
pub use upsampling::upsample;
