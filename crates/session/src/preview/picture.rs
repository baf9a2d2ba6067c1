//! A picture of the preview, how it was made and what it cost.

use crate::display::LivePicture;
use lens::Camera;
use render::Modelled;
use std::time::Instant;

/// A picture of the preview.
#[derive(Clone, Debug)]
pub struct Preview {
    /// Counts up: a newer picture has a greater id.
    pub id: u64,
    /// The picture, radiance and coverage.
    pub picture: LivePicture,
    /// The size that the screen shows it in, [enlarged](crate::enlarged), where that is not its own.
    pub enlarged_to: Option<[u32; 2]>,
    /// How it was made.
    pub kind: PreviewKind,
    /// How good it is.
    pub quality: Quality,
    /// What pictures of its light field cost.
    pub costs: DrawingCosts,
    /// The camera it was made with, at its own size.
    pub camera: Camera,
    /// Seconds that making it took.
    pub seconds: f64,
    /// What the light field holds; nothing for a picture without one.
    pub modelled: Modelled,
    /// How many changes of the map it has seen, as [`crate::Session::map_serial`] counts them.
    pub map_serial: u64,
    /// Which of the session's documents it shows.
    pub(crate) generation: u64,
}

/// How a preview was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewKind {
    /// Without blur, while the camera moves.
    Pinhole,
    /// One without blur, blurred by itself, while the light field is being baked.
    Defocused,
    /// From the light field, whole.
    Splat,
    /// From the light field, only what paint moved.
    Update,
}

/// How good a preview is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// The quick picture of few pixels, or one without a light field, that a finer one is about to replace.
    Coarse,
    /// Of full size, summed within the tolerance, at least where it changed since it was exact.
    Viewing,
    /// Summed without tolerance.
    Exact,
}

/// What pictures within the tolerance and exact ones cost, as far as that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawingCosts {
    /// Seconds to draw all of a picture of [`Quality::Viewing`].
    pub viewing_seconds: Option<f64>,
    /// PSNR, dB, of the last one against the exact picture, for the lens and the tolerance as they are.
    pub viewing_psnr: Option<f64>,
    /// Seconds to draw all of the exact picture.
    pub exact_seconds: Option<f64>,
    /// Passes that its light was refined by; 0: it is that at once.
    pub light_passes: u32,
    /// PSNR, dB, of the light at once against light that is refined for ever, as far as passes have told it.
    pub light_psnr: Option<f64>,
}

/// When a finished picture was made.
#[derive(Clone, Copy, Debug)]
pub struct PictureTimes {
    /// How many changes of the map it has seen, as [`crate::Session::map_serial`] counts them.
    pub map_serial: u64,
    /// When work on it began: with all that was wished until then.
    pub begun: Instant,
    /// When its sum was up to date.
    pub summed: Instant,
    /// When its pixels stood ready to be shown.
    pub finished: Instant,
}
