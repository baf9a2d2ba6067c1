//! How large a web page is going to be, before anything is drawn.

use crate::web_export::first_surfaces::FirstSurfaces;
use crate::web_export::options::WebPageOptions;
use lens::{Camera, FocusOffset};
use light::LitScene;
use progress::Unwatched;
use scene::SurfaceField;

/// Bytes of a page per pixel of its slices: measured for the demo at 1280 × 720.
const BYTES_PER_PIXEL: f64 = 0.045;
/// The largest side of the picture whose surfaces are looked up, px.
const LARGEST_SIDE_PX: u32 = 160;

/// How large a web page is going to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WebPageEstimate {
    /// The number of slices, unless their errors ask for more.
    pub slices: u64,
    /// Bytes of the page, roughly.
    pub bytes: u64,
}

/// Estimates the page that [`crate::export_web_page`] would write. Quick enough to wait for.
pub fn estimate_web_page(
    lit: &LitScene,
    camera: &Camera,
    focus: &dyn SurfaceField<FocusOffset>,
    options: &WebPageOptions,
) -> WebPageEstimate {
    let factor = camera.width.max(camera.height).div_ceil(LARGEST_SIDE_PX).max(1);
    let [width, height] = [camera.width, camera.height].map(|side| (side / factor).max(1));
    let coarse = Camera { width, height, ..camera.clone() };
    let Ok(surfaces) = FirstSurfaces::trace(lit.tracer(), &coarse, focus, &Unwatched) else {
        return WebPageEstimate { slices: 0, bytes: 0 };
    };
    let range = surfaces.range(camera);
    let blur_px = camera.optics().splat_radius_px(range.nearest - range.farthest);
    let slices_at = |divisor: &f64| (blur_px / divisor / WebPageOptions::LARGEST_STEP_PX).ceil() + 1.0;
    let all: f64 = options.aperture_divisors.iter().map(slices_at).sum();
    let has_ordinary = surfaces.is_painted() && options.has_ordinary_focus;
    let ordinary = options.aperture_divisors.first().filter(|_| has_ordinary).map_or(0.0, slices_at);
    let slices = all + ordinary;
    let pixels = f64::from(camera.width) * f64::from(camera.height);
    WebPageEstimate { slices: slices as u64, bytes: (slices * pixels * BYTES_PER_PIXEL) as u64 }
}
