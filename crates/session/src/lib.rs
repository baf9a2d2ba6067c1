//! An open document without a window: commands, background work and the live preview.
//!
//! A [`Session`] takes [`Command`]s, carries them out or starts them in the background, and reports by [`Event`]s what happened. The
//! window polls it once per frame; [`Session::preview`] is always the last good picture.
//!
//! ```
//! use session::{Command, Event, Session, SessionOptions};
//!
//! let mut session = Session::new(SessionOptions::default())?;
//! assert!(session.apply(Command::Undo).is_err(), "nothing is open");
//! session.apply(Command::Open("no such scene.glb".into()))?; // in the background
//! while !session.poll().iter().any(|event| matches!(event, Event::Failed(_))) {}
//! # Ok::<(), session::SessionError>(())
//! ```

mod blur_histogram;
mod commands;
mod display;
mod error;
mod exported_picture;
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
pub use exported_picture::PictureExport;
pub use light_field::{ApertureCell, ApertureImage, BakedVisibility};
pub use preview::{DrawingCosts, PictureTimes, Preview, PreviewActivity, PreviewKind, Quality};
pub use reference::{Reference, ReferenceKind};
pub use session::{FullSizeFieldState, MemoryPart, Session, SessionOptions};
pub use verification::{Verification, VerifiedError};
