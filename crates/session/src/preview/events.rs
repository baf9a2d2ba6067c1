//! What the preview's thread has to show and to tell, until the session takes it.

use crate::display::Patch;
use crate::light_field::BakedField;
use crate::preview::picture::{PictureTimes, Preview};

/// The newest picture, and what happened.
#[derive(Default)]
pub(crate) struct Published {
    pub latest: Option<Preview>,
    pub events: PreviewEvents,
}

/// What happened since it was taken last.
#[derive(Default)]
pub(crate) struct PreviewEvents {
    /// What is new on screen, oldest first, and of which of the session's documents.
    pub patches: Vec<(u64, Patch)>,
    /// When the pictures were made that were finished, at their full size.
    pub finished: Vec<PictureTimes>,
    /// Another light field of full size, and of which of the session's documents.
    pub field: Option<(u64, BakedField)>,
    /// By how many stops a scene must be shown darker, as its first pictures tell, and of which of the session's documents.
    pub glare: Option<(u64, f32)>,
    pub failures: Vec<String>,
    pub notices: Vec<String>,
}
