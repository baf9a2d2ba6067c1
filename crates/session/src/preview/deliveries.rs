//! What the helpers of the preview's thread hand over to it.

use crate::error::SessionError;
use crate::light_field::LightField;
use lens::Camera;
use light::LightErrors;

/// The share of making a light field that the bake is; the rest is the first sum.
pub(crate) const BAKE_SHARE: f32 = 0.95;

/// How far solving the light takes it.
pub(crate) const LIGHT_SHARE: f32 = 0.35;

/// How far the light field between the coarse one and the fine one takes it, where there is one.
pub(crate) const INTERIM_SHARE: f32 = 0.45;

/// What the maker of light fields hands over.
pub(crate) struct FieldDelivery {
    /// The light field, summed; or why there is none.
    pub result: Result<LightField, SessionError>,
    /// The epoch in which it was asked for.
    pub epoch: u64,
}

/// A light field of fewer pixels that the maker hands over while it bakes the one of full size.
pub(crate) struct InterimField {
    /// Of what it was asked for, not summed.
    pub field: LightField,
    /// The epoch in which it was asked for.
    pub epoch: u64,
}

/// What becomes of the exact picture.
pub(crate) struct ExactDelivery {
    /// The sum; none after a panic.
    pub field: Option<LightField>,
    pub outcome: Result<ExactPicture, SessionError>,
}

/// What becomes of light that was to be refined.
pub(crate) struct RefinedLightDelivery {
    /// What was made; or why there is nothing.
    pub result: Result<FinerField, SessionError>,
    /// The epoch in which it was asked for.
    pub epoch: u64,
}

/// A light field of refined light, summed.
pub(crate) struct FinerField {
    pub field: LightField,
    /// How far it and the light at once are from the truth, if that is known.
    pub errors: Option<LightErrors>,
    /// Seconds that the bake took.
    pub seconds: f64,
}

/// An exact picture, beside the field that holds it.
pub(crate) struct ExactPicture {
    pub map_serial: u64,
    pub camera: Camera,
    /// Seconds that it took.
    pub seconds: f64,
    /// PSNR, dB, of the picture that was worked with.
    pub viewing_psnr: f64,
}
