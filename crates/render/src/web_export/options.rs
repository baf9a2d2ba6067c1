//! What a web page shows, and how large it may be.

use crate::picture::{RenderOptions, Tone};
use web_page::Caption;

/// What a web page shows, and how large it may be.
#[derive(Clone, Debug)]
pub struct WebPageOptions {
    /// Texts below the picture.
    pub caption: Caption,
    /// The aperture radii, as divisors (≥ 1, ascending) of the camera's.
    pub aperture_divisors: Vec<f64>,
    /// Whether a painted picture is also shown without paint, at the widest aperture.
    pub has_ordinary_focus: bool,
    /// Whether the focus moves by itself until somebody touches the page.
    pub is_autoplaying: bool,
    /// How the pictures are shown.
    pub tone: Tone,
    /// How the pictures are drawn. Renderer, AOVs and overscan are not used.
    pub render: RenderOptions,
    /// Where the page is going to be published. A poster is then written beside the page.
    pub address: Option<String>,
    /// Whether the page may have more than [`Self::USUAL_BYTES`].
    pub is_large_allowed: bool,
}

impl WebPageOptions {
    /// The bytes that a page may have unless larger ones are allowed: phones run out of memory on more.
    pub const USUAL_BYTES: u64 = 30_000_000;
    /// The slices that a stack may have unless larger pages are allowed.
    pub(crate) const USUAL_SLICES: usize = 1000;
    /// The slices that a stack may have at all.
    pub(crate) const MOST_SLICES: usize = 100_000;
    /// The radius by which the blur of anything unpainted may differ between two slices, px.
    pub(crate) const LARGEST_STEP_PX: f64 = 2.0;

    pub(crate) fn most_bytes(&self) -> u64 {
        if self.is_large_allowed { u64::MAX } else { Self::USUAL_BYTES }
    }
}

impl Default for WebPageOptions {
    fn default() -> Self {
        Self {
            caption: Caption::default(),
            aperture_divisors: vec![1.0, 2.0, 4.0],
            has_ordinary_focus: true,
            is_autoplaying: false,
            tone: Tone::default(),
            render: RenderOptions::default(),
            address: None,
            is_large_allowed: false,
        }
    }
}
