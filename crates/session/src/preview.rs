//! The live preview: a thread that owns the light field and keeps its picture up to date.
//!
//! The session posts what is wanted (scene, camera, changed texels) into one mailbox; newer wishes replace or
//! join older ones there, so that the thread, whenever it looks, does the least that leads to the newest state.
//! Two light fields serve it:
//!
//! ```text
//!                  coarse (a fifth of the size)           fine (the preview's size)
//! scene, pose …    baked at once, after a pinhole and,   baked on a helper thread, if large
//!                  if large, a rough one                 after one between in the coarse one's place
//! lens             summed at once                        summed on a helper thread, if it takes long
//! paint            updated until the fine one is there   updated
//! ```
//!
//! When nothing has changed for a while, the fine one is summed once more without tolerance (`exact_refinement.rs`), and then its light is
//! refined (`light_refinement.rs`).
//! So a dab or a turned ring shows at once and sharpens by itself, however large the scene. The thread works on
//! snapshots of the focus map (tiles are shared until one is painted on): neither ever waits for the other. What
//! a newer wish makes useless is stopped. The last good picture is never taken away.

mod activity;
mod deliveries;
mod events;
mod exact_refinement;
mod light_field_maker;
mod light_refinement;
mod mailbox;
mod picture;
mod picture_sizes;
mod presenter;
mod request;
mod thread;
mod waiting;
mod worker;

pub use activity::PreviewActivity;
pub use picture::{DrawingCosts, PictureTimes, Preview, PreviewKind, Quality};

pub(crate) use mailbox::Shared;
pub(crate) use thread::PreviewThread;
pub(crate) use waiting::Exporting;
