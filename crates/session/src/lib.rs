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

mod aov;
mod aperture_image;
mod blur_histogram;
mod camera_edit;
mod command;
mod command_table;
mod document;
mod editing;
mod error;
mod field_watch;
mod input;
mod job;
mod key_map;
mod light_field;
mod light_field_maker;
mod light_field_store;
mod live_picture;
mod modelled;
mod object_axes;
mod painter;
mod picking;
mod picture_ring;
mod presenter;
mod preview;
mod preview_worker;
mod reach;
mod reference;
mod refinement;
mod render;
mod salf_file;
mod sample_index;
mod screen;
mod selecting;
mod session;
mod stage;
mod steps;
mod tone;
mod tone_curve;
mod undo;
mod unwrapped;
mod verification;

pub use aov::Aov;
pub use aperture_image::{ApertureCell, ApertureImage, KeptVisibility};
pub use baselines::{FirstHits, LayeredOptions, ScatterOptions, ViewsOptions};
pub use blur_histogram::BlurHistogram;
pub use camera_edit::CameraEdit;
pub use command::{Command, Event, FillRegion, StrokePoint, StrokeTarget};
pub use command_table::{COMMANDS, CommandId, CommandInfo, Menu, Shortcut};
pub use document::{Document, camera_of};
pub use error::SessionError;
pub use input::{CameraChoice, Input, InputKind};
pub use job::{JobId, JobProgress, JobStatus, Waker, guarded};
pub use key_map::KeyMap;
pub use light_field_store::LightFieldStore;
pub use live_picture::LivePicture;
pub use modelled::{DENSE_SAMPLE_BYTES, Modelled, ModelledRow, TexelStatistics};
pub use painter::replay;
pub use picking::{SurfaceHit, chief_ray, pick, view_ray};
pub use preview::{DrawingCosts, PictureTimes, Preview, PreviewActivity, PreviewKind, Quality};
pub use reference::{Reference, ReferenceKind};
pub use render::{
    MOST_CELLS_A_SIDE, RenderCost, RenderOptions, Rendered, Renderer, bake, bake_unpacked, render,
    render_input,
};
pub use salf_file::write_salf;
pub use screen::Screen;
pub use selecting::rectangle;
pub use session::{FullSize, Session, SessionOptions};
pub use stage::{Stage, load_scene};
pub use steps::Steps;
pub use tone::{Display, ScreenPixel, Tone, to_screen};
pub use tone_curve::ToneCurve;
pub use trace::truth::Region;
pub use undo::HistoryStep;
pub use unwrapped::write_unwrapped;
pub use verification::{Verification, VerifiedError};
