//! Requests to the preview, merged until its thread takes them.

use crate::light_field::Changes;
use crate::preview::deliveries::{ExactDelivery, FieldDelivery, InterimField, RefinedLightDelivery};
use document::Stage;
use focus::FocusMap;
use lens::Camera;
use render::Tone;
use splat::Tolerance;
use std::sync::Arc;

/// Everything that was requested or delivered since the thread last took a request.
#[derive(Default)]
pub(crate) struct PreviewRequest {
    /// A new scene, and the generation of its document.
    pub stage: Option<(Arc<Stage>, u64)>,
    pub camera: Option<Camera>,
    /// A snapshot of the map and its number of changes; `changed` says what is new in it.
    pub map: Option<(FocusMap, u64)>,
    pub changed: Changes,
    /// New tone settings.
    pub tone: Option<Tone>,
    /// New tolerance of pictures while the user works.
    pub tolerance: Option<Tolerance>,
    /// Nothing was requested for a while.
    pub is_idle: bool,
    /// Bake the light field again.
    pub bake: bool,
    /// What is shown was on a card that is lost.
    pub is_card_lost: bool,
    /// An edit is complete, so there is time for longer work.
    pub edit_done: bool,
    /// Pause all work.
    pub pause: bool,
    /// The finished light field.
    pub delivery: Option<FieldDelivery>,
    /// An interim light field of fewer pixels.
    pub interim: Option<InterimField>,
    /// The result of the exact picture.
    pub refined: Option<ExactDelivery>,
    /// The result of refining light.
    pub refined_light: Option<RefinedLightDelivery>,
    /// The finished spare.
    pub spare: Option<FieldDelivery>,
    /// Pause what is done while nothing changes.
    pub pause_background: bool,
    /// Current work was cancelled by this request.
    pub is_stopping: bool,
    pub is_posted: bool,
    pub quit: bool,
}

/// Which current work a request makes useless.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum StopScope {
    Nothing,
    /// The exact picture.
    Refining,
    /// That, and what is baked for a smaller aperture.
    Aperture,
    /// All but a picture without blur, which is soon there: a camera that moves on is followed by pictures of where it just was.
    View,
    Everything,
}
