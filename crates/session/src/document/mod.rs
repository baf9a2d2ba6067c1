//! What is open: files in, and the state that is saved and undone.
//!
//! An [`Input`] is a file as read; with its scene unwrapped and ready for rays (the [`Stage`]) it becomes a [`Document`]. A new
//! kind of file to open is a kind of [`InputKind`], here and nowhere else.

mod adjusted_view;
mod camera_edit;
mod camera_path;
mod capture_scene;
mod depth_scene;
mod disparity_error;
mod followed;
mod found_disparity;
mod input;
mod kept_atlas;
mod light_field_scene;
mod near_question;
mod of_picture;
mod open_document;
mod picking;
mod picture_regions;
mod picture_scene;
mod picture_views;
mod scene_camera;
mod scene_hashes;
mod stage;
mod undo;
mod variant_choice;

pub use camera_edit::CameraEdit;
pub use camera_path::camera_between;
pub use capture_scene::{camera_from_photograph, is_capture};
pub use disparity_error::DisparityError;
pub use input::{CameraChoice, Input, InputKind};
pub use near_question::DepthPolarityRequest;
pub use open_document::{Document, NewDocumentOptions};
pub(crate) use picking::depth_in_direction;
pub use picking::{SurfaceHit, chief_ray, pick, view_ray};
pub use scene_camera::shot_camera_from;
pub use stage::{Stage, load_scene};
pub use undo::HistoryStep;
pub use variant_choice::VariantChoice;

pub(crate) use adjusted_view::AdjustmentView;
pub(crate) use capture_scene::find_photograph;
pub(crate) use kept_atlas::load_or_unwrap_atlas;
pub(crate) use scene_hashes::{content_hash, light_hash, photographs_hash};
pub(crate) use stage::{atlas_error, build_canvas};
pub(crate) use undo::{StepEffect, UndoState};
