//! What is open: files in, and the state that is saved and undone.
//!
//! ```text
//! file ─▶ Input (input: as read) ─▶ Stage (unwrapped, ready for rays and dabs) ─▶ Document (open_document: saved and undone)
//!                                                                                   ▲ editing: strokes, fills, layers
//!                                                                                   │ paint_transfer: paint on a changed surface
//! ```
//!
//! A new kind of file to open is a kind of [`InputKind`], here and nowhere else. Nothing here starts a thread or knows of pictures.

mod adjustment_view;
mod camera_edit;
mod camera_path;
mod editing;
mod error;
mod input;
mod open_document;
mod paint_transfer;
mod picking;
mod scene_camera;
mod scene_reload;
mod stage;
#[cfg(test)]
#[path = "../../session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
mod undo;

pub use adjustment_view::AdjustmentView;
pub use camera_edit::CameraEdit;
pub use camera_path::camera_between;
pub use editing::{
    ActiveEdit, ActiveGradient, FillRegion, Painter, StrokePoint, StrokeTarget, apply_recorded_step,
    rectangle_outline, replay,
};
pub use error::{DocumentError, IoFault, file_name};
pub use input::{
    CameraChoice, DepthPolarityRequest, DisparityError, Input, InputKind, VariantChoice,
    camera_from_photograph, find_photograph, is_capture,
};
pub use open_document::{Document, NewDocumentOptions};
pub use paint_transfer::{TransferredPaint, UnmatchedNode};
pub use picking::{SurfaceHit, chief_ray, depth_in_direction, pick, view_ray};
pub use relief::{DepthRepair, DepthStroke};
pub use scene_camera::shot_camera_from;
pub use stage::{Stage, atlas_error, build_canvas, load_scene};
pub use undo::{HistoryStep, StepEffect, UndoHistory, UndoState};
