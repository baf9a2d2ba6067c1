//! An open document and the work on it: commands in, events out.
//!
//! [`Session`] holds the state; each file beside it does one kind of work on that state, in the background where it takes
//! long. The window sees nothing below.

mod apply;
mod asking;
mod comparing;
mod exporting;
mod files;
mod first_look;
mod following;
mod history;
mod outcome;
mod painting;
mod polling;
mod recovery;
mod restaged;
mod restaging;
mod showing;
mod state;
mod timeline;
mod verifying;
mod watched;

pub use exporting::FullSizeFieldState;
pub use state::{Session, SessionOptions};
