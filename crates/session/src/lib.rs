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
pub use carrying::{CarriedNode, CarriedPaint};
pub use commands::{COMMANDS, Command, CommandId, CommandInfo, Event, KeyMap, Menu, Shortcut};
pub use display::{
    Display, LivePicture, OcioViews, Screen, ScreenPixel, Thumbnail, ThumbnailResult, Thumbnails, Tone,
    ToneCurve, enlarged, to_screen,
};
pub use document::{
    Beginning, CameraChoice, CameraEdit, DisparityError, Document, HistoryStep, Input, InputKind,
    NearQuestion, Stage, SurfaceHit, VariantChoice, camera_between, camera_of, chief_ray, is_capture,
    load_scene, pick, view_ray,
};
pub use editing::{FillRegion, StrokePoint, StrokeTarget, rectangle, replay};
pub use error::SessionError;
pub use jobs::{JobId, JobProgress, JobStatus, Steps, Waker, guarded};
pub use kept_files::keep_work_in;
pub use light_field::{
    ApertureCell, ApertureImage, DENSE_SAMPLE_BYTES, KeptVisibility, LightErrors, LightFieldStore,
    LightQuality, Modelled, ModelledRow, TexelStatistics, bake, bake_unpacked, may_be_refined, write_salf,
};
pub use output::{
    Aov, BlurHistogram, CocConvention, LeftOut, LeftOutPicture, MOST_CELLS_A_SIDE, Reference, ReferenceKind,
    RenderCost, RenderOptions, Rendered, Renderer, Stereo, StereoForm, ToldBy, Verification, VerifiedError,
    render, render_input, render_stereo, thumbnail, write_unwrapped,
};
pub use preview::{DrawingCosts, PictureTimes, Preview, PreviewActivity, PreviewKind, Quality};
pub use relief::{DepthRepair, DepthStroke};
pub use sequence::{
    Baking, FrameFiles, FrameList, FrameReport, Outcome, SequenceOptions, SequenceReport, Shard, Take,
    TakeOptions, WritePicture, render_frames,
};
pub use session::{FullSize, Session, SessionOptions};
pub use slf::PhotographLight;
pub use tiles::{Merged, TileGrid, TileOptions, TileReport, TilesReport, merge_tiles, render_tiles};
pub use trace::truth::Region;
