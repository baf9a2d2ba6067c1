//! The live preview: a thread that owns the light field and keeps its picture up to date.
//!
//! The session posts requests (scene, camera, changed texels) to a mailbox. Newer requests replace older ones or are merged with them, so
//! that the thread does the least work that leads to the newest state. It uses two light fields:
//!
//! ```text
//!                  coarse (a fifth of the size)           fine (the preview's size)
//! scene, pose …    baked at once, after a pinhole        baked on a helper thread; if it is large,
//!                  picture and, if large, a rougher one  an interim one replaces the coarse one first
//! lens             summed at once                        summed on a helper thread if it takes long
//! paint            updated until the fine one is ready   updated
//! ```
//!
//! When nothing has changed for a while, the fine light field is summed again without tolerance (`exact_refinement.rs`), and then its
//! light is refined (`light_refinement.rs`). A change therefore shows at once and sharpens afterwards, however large the scene. The thread
//! works on snapshots of the focus map (tiles are copied on write), so session and thread never wait for each other. Work that a newer
//! request makes useless is stopped. The last good picture always stays.

mod activity;
mod deliveries;
mod events;
mod exact_refinement;
mod helper_thread;
mod light_field_maker;
mod light_refinement;
mod mailbox;
mod picture;
mod picture_sizes;
mod pinhole;
mod presenter;
mod relighting;
mod request;
mod spare_field;
mod thread;
mod waiting;
mod worker;

pub use activity::PreviewActivity;
pub use picture::{DrawingCosts, PictureTimes, Preview, PreviewKind, Quality};

pub(crate) use mailbox::Shared;
pub(crate) use thread::PreviewThread;
pub(crate) use waiting::Exporting;
