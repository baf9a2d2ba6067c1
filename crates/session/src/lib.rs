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

mod blur_histogram;
mod commands;
mod display;
mod error;
mod job_steps;
mod light_field;
mod preview;
mod reference;
mod session;
#[cfg(test)]
#[path = "../tests/tiny_glb/mod.rs"]
mod tiny_glb;
mod verification;

pub use blur_histogram::BlurHistogram;
pub use commands::{COMMANDS, Command, CommandId, CommandInfo, Event, KeyMap, Menu, Shortcut};
pub use display::{LivePicture, Screen, Thumbnail, ThumbnailResult, Thumbnails, enlarged};
pub use error::SessionError;
pub use light_field::{ApertureCell, ApertureImage, BakedVisibility};
pub use preview::{DrawingCosts, PictureTimes, Preview, PreviewActivity, PreviewKind, Quality};
pub use reference::{Reference, ReferenceKind};
pub use session::{FullSizeFieldState, Session, SessionOptions};
pub use verification::{Verification, VerifiedError};
