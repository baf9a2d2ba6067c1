//! What the preview is doing.

use std::sync::atomic::{AtomicU8, Ordering};

/// What the preview is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewActivity {
    /// Nothing to do.
    Idle,
    /// Tracing a pinhole picture.
    Tracing,
    /// Baking a coarse light field.
    RoughBaking,
    /// Baking the light field.
    Baking,
    /// Summing the picture.
    Splatting,
}

impl PreviewActivity {
    /// Whether a light field is being made.
    pub fn is_baking(self) -> bool {
        matches!(self, Self::RoughBaking | Self::Baking)
    }

    pub(super) fn load(activity: &AtomicU8) -> Self {
        match activity.load(Ordering::Relaxed) {
            x if x == Self::Tracing as u8 => Self::Tracing,
            x if x == Self::RoughBaking as u8 => Self::RoughBaking,
            x if x == Self::Baking as u8 => Self::Baking,
            x if x == Self::Splatting as u8 => Self::Splatting,
            _ => Self::Idle,
        }
    }
}
