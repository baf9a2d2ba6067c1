//! An open document: commands, caches and background work, without a window.
//!
//! The window and the command line are both thin over this crate. [`Session`] is the window's: it takes a
//! [`Command`], does it or starts it in the background, and tells by [`Event`]s what happened.
//!
//! ```text
//! let mut session = Session::new(SessionOptions { waker, ..Default::default() })?;
//! session.apply(Command::Open("garden.glb".into()))?;          // in the background
//! for event in session.poll() { … }                             // once a frame
//! if let Some(ray) = session.picture_ray(position) {            // either view paints with rays
//!     session.apply(Command::BeginStroke(StrokePoint::ray(ray)))?;
//! }
//! session.preview()                                             // the last good picture, always
//! ```

mod carrying;
mod commands;
mod display;
mod document;
mod editing;
mod error;
mod jobs;
mod kept_files;
mod light_field;
mod output;
mod preview;
mod sequence;
mod session;
mod tiles;
#[cfg(test)]
#[path = "../tests/tiny_glb/mod.rs"]
mod tiny_glb;

pub use baselines::{FirstHits, LayeredOptions, ScatterOptions, ViewsOptions};
pub use carrying::{TransferredPaint, UnmatchedNode};
pub use commands::{COMMANDS, Command, CommandId, CommandInfo, Event, KeyMap, Menu, Shortcut};
pub use display::{
    Display, LivePicture, OcioViews, Screen, ScreenPixel, Thumbnail, ThumbnailResult, Thumbnails, Tone,
    ToneCurve, enlarged, to_screen,
};
pub use document::{
    CameraChoice, CameraEdit, DepthPolarityRequest, DisparityError, Document, HistoryStep, Input, InputKind,
    NewDocumentOptions, Stage, SurfaceHit, VariantChoice, camera_between, chief_ray, is_capture, load_scene,
    pick, shot_camera_from, view_ray,
};
pub use editing::{FillRegion, StrokePoint, StrokeTarget, rectangle_outline, replay};
pub use error::SessionError;
pub use jobs::{JobId, JobProgress, JobStatus, Steps, Waker, catch_panics};
pub use kept_files::set_cache_folder;
pub use light_field::{
    ApertureCell, ApertureImage, BakedVisibility, DENSE_SAMPLE_BYTES, LightErrors, LightFieldStore,
    LightQuality, Modelled, ModelledRow, TexelStatistics, bake, bake_unpacked, can_refine_light, write_salf,
};
pub use output::{
    Aov, BlurHistogram, CocConvention, LeftOut, LeftOutPicture, LeftOutPrediction, MAX_CELLS_A_SIDE,
    Reference, ReferenceKind, RenderCost, RenderOptions, Rendered, Renderer, Stereo, StereoForm,
    Verification, VerifiedError, read_thumbnail, render, render_input, render_stereo, write_unwrapped,
};
pub use preview::{DrawingCosts, PictureTimes, Preview, PreviewActivity, PreviewKind, Quality};
pub use relief::{DepthRepair, DepthStroke};
pub use sequence::{
    Baking, FrameFiles, FrameList, FrameReport, Outcome, SequenceOptions, SequenceReport, Shard, Take,
    TakeOptions, WritePicture, render_frames,
};
pub use session::{FullSizeFieldState, Session, SessionOptions};
pub use slf::PhotographLight;
pub use tiles::{Merged, TileGrid, TileOptions, TileReport, TilesReport, merge_tiles, render_tiles};
pub use trace::truth::Region;
