//! What a web page shows, and how large it may be.

use crate::picture::{RenderOptions, Tone};
use lens::Camera;
use splat::Tolerance;
use web_page::{Caption, PlacementOptions};

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
    /// How the pictures are drawn. Renderer, tolerance of the splat, AOVs and overscan are not used.
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
    const USUAL_SLICES: usize = 1000;
    /// The slices that a stack may have at all.
    const MOST_SLICES: usize = 100_000;
    /// The radius of the blur that may remain at the slice that shows a surface best, px: neighbouring slices are two of it apart, where
    /// anything is sharp between them.
    pub(crate) const LARGEST_BLUR_PX: f64 = 1.0;
    /// The tolerance of the sums, px, of pictures that are at least so high, px: many times as fast as exact ones, from which they are at 51 to
    /// 57 dB (the demo, 1280 × 720). Smaller pictures have smaller blur, and so a smaller tolerance: with the same they would be as far as
    /// 37 dB from the exact ones (192 × 108).
    const TOLERANCE_PX: f64 = 3.0;
    const TOLERANT_HEIGHT_PX: f64 = 720.0;
    /// PSNR, as `compare` measures it, of slices at rest against exact pictures, and of cross-fades half way, dB.
    pub(crate) const REST_PSNR: f64 = 40.0;
    pub(crate) const MIDWAY_PSNR: f64 = 38.0;
    /// What the tolerance may take from it, dB.
    const MARGIN_OF_TOLERANCE: f64 = 0.12;

    /// How the pictures of a camera are drawn.
    pub(crate) fn render_options(&self, camera: &Camera) -> RenderOptions {
        let share = (f64::from(camera.height) / Self::TOLERANT_HEIGHT_PX).min(1.0);
        let splat_tolerance = Tolerance::px(Self::TOLERANCE_PX * share);
        RenderOptions { splat_tolerance, ..self.render.clone() }
    }

    /// How good the slices are to be; together they may take `most_bytes`.
    pub(crate) fn placement(most_bytes: u64) -> PlacementOptions {
        PlacementOptions {
            rest_psnr: Self::REST_PSNR + Self::MARGIN_OF_TOLERANCE,
            midway_psnr: Self::MIDWAY_PSNR + Self::MARGIN_OF_TOLERANCE,
            shortest_step: 1.0 / 32.0,
            most_bytes,
        }
    }

    pub(crate) fn most_slices(&self) -> usize {
        if self.is_large_allowed { Self::MOST_SLICES } else { Self::USUAL_SLICES }
    }

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
