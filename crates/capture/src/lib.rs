//! Captures: the results of other programs about a place, as views and a surface or depth.
//!
//! A capture is a folder of photographs, of the cameras that a reconstruction program computed for them, and a mesh of what they show.
//! [`open`] detects its format ([`CameraFormat`]), reads it, and reports in [`Remark`]s what was incomplete; [`recognise`] only detects. Two
//! more kinds ([`detect_capture_kind`]) have readers of their own: light fields ([`open_light_field`], described in `light_field`) and
//! pictures with depth ([`open_depth_picture`], described in `depth_picture`).
//!
//! Files come from anywhere, so no reader trusts them. A count in a file is checked against the file's size before memory is allocated;
//! there is no recursion whose depth a file controls; names in files are looked up among the files in the capture's folder and never
//! opened as paths, so that nothing outside is read unless the caller names it.
//!
//! The stages for photographs: `cameras::layout` (which cameras lie where) → `cameras` (`colmap`, `nerfstudio`, `bundler`, `nvm`,
//! `metashape`; each yields `shot`s: name, lens, pose) → `pictures::picture_folder`, `picture_names` (which file is whose) → `pictures`,
//! `files::picture_header` (size, EXIF, masks: views) → `mesh` (`ply`, `obj`: the surface) → `mesh_fit` (whether it fits the photographs),
//! `mesh_place` (whether it has to be moved first) → `open`. The up direction of COLMAP's world is
//! estimated from the cameras (`upright`) and reported, not applied.
//!
//! ```
//! use capture::{DepthMeaning, DepthQuantity, read_depth_map};
//! use scene::LoadOptions;
//!
//! let folder = tempfile::tempdir().unwrap();
//! let file = folder.path().join("depth.pfm");
//! let pixels: Vec<u8> = [2.0f32, 0.0].into_iter().flat_map(f32::to_le_bytes).collect();
//! std::fs::write(&file, [&b"Pf 2 1 -1\n"[..], &pixels].concat()).unwrap();
//! let map = read_depth_map(&file, Some(DepthQuantity::Depth), None, &LoadOptions::default()).unwrap();
//! assert_eq!((map.meaning, map.values[0], map.unknown_share()), (DepthMeaning::Distance, 2.0, 0.5));
//! ```

mod cameras;
mod capture_kind;
mod depth_map;
mod depth_picture;
mod error;
mod files;
mod light_field;
mod mesh;
mod mesh_fit;
mod mesh_place;
mod mosaic;
mod open;
mod pictures;
mod remark;
mod unsupported_format;

pub use cameras::camera_format::CameraFormat;
pub use cameras::layout::recognise;
pub use capture_kind::{CaptureKind, detect_capture_kind, may_be_picture};
pub use depth_map::{DepthMap, DepthMeaning, DepthQuantity, NearEnd, read_depth_map};
pub use depth_picture::{DepthContainer, DepthPicture, DepthPictureOptions, open_depth_picture};
pub use error::CaptureError;
pub use light_field::{
    GridTurn, GridTurnEstimate, LightField, LightFieldOptions, Optics, SubAperture, ViewDisparity,
    ViewLayout, estimate_grid_turn, open_light_field,
};
pub use mesh_fit::MeshFit;
pub use mosaic::{Mosaic, micro_images};
pub use open::{Capture, CaptureOptions, open};
pub use pictures::picture_source::PictureSource;
pub use remark::Remark;
