//! Open documents: files are read, and their state is edited, undone and saved.
//!
//! ```text
//! file ─▶ Input (as read) ─▶ Stage (unwrapped, ready for rays and dabs) ─▶ Document (saved and undone)
//!                                                                            ▲ editing: strokes, fills, layers
//!                                                                            │ paint_transfer: paint on a changed surface
//! ```
//!
//! | module | content |
//! | --- | --- |
//! | `input`, `scene_file` | scenes, projects, light fields and captures, as read from files |
//! | `splat_focus` | focus maps of Gaussian splats as tables |
//! | `stage` | a scene that can be painted on |
//! | `spread_task` | strokes to be solved for before they can be spread |
//! | `open_document`, `undo` | the document and its undo history |
//! | `editing` | edits of paint, as undo steps that can be recorded and replayed |
//! | `scene_reload`, `paint_transfer` | paint on a scene whose file has changed |
//! | `picking`, `camera_path`, `scene_camera`, `camera_edit`, `focus_hold`, `bookmarks` | rays and cameras |
//!
//! To support another kind of file, add a variant to [`InputKind`]. Nothing here starts a thread of its own or knows of rendered pictures.
//!
//! ```
//! use atlas::UnwrapOptions;
//! use document::{Document, FillRegion};
//! use lens::FocusOffset;
//! use light::Resources;
//! use progress::Unwatched;
//!
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("triangle.gltf");
//! # let values = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
//! # std::fs::write(folder.path().join("triangle.bin"), bytemuck::cast_slice::<f32, u8>(&values))?;
//! # let gltf = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "triangle.bin", "byteLength": 36}],
//! #     "bufferViews": [{"buffer": 0, "byteLength": 36}],
//! #     "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
//! #         "min": [0, 0, 0], "max": [1, 1, 0]}],
//! #     "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}],
//! #     "scenes": [{"nodes": [0]}], "scene": 0}"#;
//! # std::fs::write(&file, gltf)?;
//! // `file` is a glTF file.
//! let unwrap = UnwrapOptions::default();
//! let mut document = Document::open(&file, &unwrap, &Resources::default(), &Unwatched)?;
//!
//! // Fill everything with a focus offset: an undo step, and unsaved work.
//! let changed = document.fill(document.fill_targets(FillRegion::All), FocusOffset::new(1.2, 1.0))?;
//! document.recomposite(Some(&changed));
//! assert_eq!(document.undo_name(), Some("Fill everything"));
//! assert!(document.is_unsaved());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adjustment_view;
mod bookmarks;
mod camera_edit;
mod camera_path;
mod editing;
mod error;
mod first_view;
mod focus_hold;
mod input;
mod open_document;
mod paint_transfer;
mod picking;
mod scene_camera;
mod scene_file;
mod scene_reload;
mod splat_focus;
mod spread_task;
mod stage;
mod undo;

pub use adjustment_view::AdjustmentView;
pub use bookmarks::BookmarkEdit;
pub use camera_edit::CameraEdit;
pub use camera_path::camera_between;
pub use editing::{
    ActiveEdit, ActiveGradient, FillRegion, Painter, SelectionMatches, SelectionTask, StrokePoint,
    StrokeTarget, apply_recorded_step, rectangle_outline, replay,
};
pub use error::{DocumentError, IoFault, file_name};
pub use focus_hold::HeldCamera;
pub use input::{
    CameraChoice, DepthPolarityRequest, DisparityError, Input, InputKind, VariantChoice,
    camera_from_photograph, find_photograph, is_capture,
};
pub use open_document::{Document, NewDocumentOptions, SavedState};
pub use paint_transfer::{TransferredPaint, UnmatchedNode};
pub use picking::{SurfaceHit, chief_ray, depth_in_direction, pick, texels_in_mask, view_ray};
pub use relief::{DepthRepair, DepthStroke};
pub use scene_camera::shot_camera_from;
pub use scene_file::{atlas_error, load_scene};
pub use splat_focus::{is_focus_table, write_splat_focus};
pub use spread_task::{SolvedSpread, SpreadTask};
pub use stage::{Stage, build_canvas};
pub use undo::{HistoryStep, KeyedLens, StepEffect, UndoHistory, UndoState};
