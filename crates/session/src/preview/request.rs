//! What is wanted of the preview, joined until its thread looks.

use crate::light_field::Changes;
use crate::preview::deliveries::{ExactDelivery, FieldDelivery, InterimField, RefinedLightDelivery};
use document::Stage;
use focus::FocusMap;
use lens::Camera;
use render::Tone;
use splat::Tolerance;
use std::sync::Arc;

/// Everything that changed since the thread last looked.
#[derive(Default)]
pub(crate) struct PreviewRequest {
    /// Another scene, and which of the session's documents it is.
    pub stage: Option<(Arc<Stage>, u64)>,
    pub camera: Option<Camera>,
    /// A snapshot of the map and how many changes it holds; `changed` is what is new in it.
    pub map: Option<(FocusMap, u64)>,
    pub changed: Changes,
    /// Another way to put pictures on screen.
    pub tone: Option<Tone>,
    /// How coarse pictures may be while one works.
    pub tolerance: Option<Tolerance>,
    /// Nothing was wished for a while.
    pub is_idle: bool,
    /// The light field is to be made anew.
    pub bake: bool,
    /// An edit is complete: room for what takes longer.
    pub edit_done: bool,
    /// The user wants no more work for now.
    pub pause: bool,
    /// The light field that was made.
    pub delivery: Option<FieldDelivery>,
    /// One of fewer pixels that was made first.
    pub interim: Option<InterimField>,
    /// What became of the exact picture.
    pub refined: Option<ExactDelivery>,
    /// What became of light that was to be refined.
    pub refined_light: Option<RefinedLightDelivery>,
    /// The user wants no light refined for now.
    pub pause_light: bool,
    /// Work under way was told to stop when these were posted.
    pub is_stopping: bool,
    pub is_posted: bool,
    pub quit: bool,
}

/// What of the work under way a wish makes useless.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum StopScope {
    Nothing,
    /// The exact picture.
    Refining,
    Everything,
}
