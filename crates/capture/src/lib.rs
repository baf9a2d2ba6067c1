//! Captures: what other programs found out about a place, as views and a surface or depth.
//!
//! A capture is a folder of photographs, of the cameras that a reconstruction program found for them, and a mesh of what they show.
//! [`open`] finds out whose it is ([`Kind`]), reads it, and says in [`Remark`]s what was incomplete; [`recognise`] only looks. Two more kinds
//! ([`capture_kind`]) have roads of their own: light fields ([`open_light_field`], told in `light_field`) and pictures with depth
//! ([`open_depth_picture`], told in `depth_picture`).
//!
//! Files come from anywhere, so the readers trust none. What a file counts is checked against its size before room is made; nothing
//! recurses by what a file says; names in files are looked up among the files that lie in the capture's folder and never opened as
//! paths, so that nothing outside is read unless the caller names it.
//!
//! The road of photographs: `layout` (whose cameras lie where) → `colmap`, `nerfstudio`, `bundler`, `nvm`, `metashape` (each to
//! `shot`s: name, lens, pose) → `picture_place`, `picture_names` (which file is whose) →
//! `pictures`, `picture_header` (size, EXIF, masks: views) → `mesh_file`,
//! `ply`, `obj` (the surface) → `open`. What COLMAP's world calls up is guessed from the cameras (`upright`) and told, not applied.

mod binary;
mod bundler;
mod capture_kind;
mod colmap;
mod depth_map;
mod depth_picture;
mod error;
mod exif;
mod exr_channels;
mod fan;
mod folder;
mod foreign;
mod kind;
mod layout;
mod light_field;
mod mesh_file;
mod metashape;
mod mosaic;
mod nerfstudio;
mod nvm;
mod obj;
mod open;
mod picture_header;
mod picture_names;
mod picture_place;
mod picture_source;
mod pictures;
mod ply;
mod pose;
mod remark;
mod shot;
mod text;
mod upright;
mod whole_file;

pub use capture_kind::{CaptureKind, detect_capture_kind, may_be_picture};
pub use depth_map::{DepthMap, DepthMeaning, DepthQuantity, NearEnd, read_depth_map};
pub use depth_picture::{DepthContainer, DepthPicture, DepthPictureOptions, open_depth_picture};
pub use error::CaptureError;
pub use kind::CameraFormat;
pub use layout::recognise;
pub use light_field::{
    GridTurn, GridTurnEstimate, LightField, LightFieldOptions, Optics, SubAperture, ViewDisparity,
    ViewLayout, estimate_grid_turn, open_light_field,
};
pub use mosaic::{Mosaic, micro_images};
pub use open::{Capture, CaptureOptions, open};
pub use picture_source::PictureSource;
pub use remark::Remark;
