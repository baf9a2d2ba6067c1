//! How large a web page is going to be, before anything is drawn.

use crate::web_export::first_surfaces::FirstSurfaces;
use crate::web_export::options::WebPageOptions;
use lens::{Camera, FocusOffset};
use light::LitScene;
use progress::Unwatched;
use scene::SurfaceField;
use web_page::SliceSpacing;

/// Bytes of a page per pixel of its slices: measured for the demo at 1280 × 720.
const BYTES_PER_PIXEL: f64 = 0.035;
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
    let optics = camera.optics();
    let slices = |is_painted: bool, divisor: f64| {
        let sharp = surfaces.all_sharp_distances(range, &optics, is_painted);
        let reach = WebPageOptions::LARGEST_BLUR_PX * divisor / optics.splat_radius_px(1.0);
        let most = options.most_slices();
        let opening = optics.inverse_focus_distance;
        let spacing = SliceSpacing { sharp: &sharp, range, opening, reach };
        spacing.least_slices(most).unwrap_or(most) as u64
    };
    let is_painted = surfaces.is_painted();
    let divisors = &options.aperture_divisors;
    let all: u64 = divisors.iter().map(|&divisor| slices(is_painted, divisor)).sum();
    let widest = divisors.first().filter(|_| is_painted && options.has_ordinary_focus);
    let slices = all + widest.map_or(0, |&divisor| slices(false, divisor));
    let pixels = f64::from(camera.width) * f64::from(camera.height);
    WebPageEstimate { slices, bytes: (slices as f64 * pixels * BYTES_PER_PIXEL) as u64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::web_export::export_web_page;
    use document::load_scene;
    use focus::{Focus, FocusSource};
    use light::{LightOptions, Resources};
    use std::sync::Arc;
    use trace::Tracer;

    #[test]
    fn the_estimate_counts_the_slices_that_are_drawn_at_least() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("quads.glb");
        crate::tiny_glb::write(&file);
        let scene = load_scene(&file, &Unwatched).unwrap();
        let tracer = Arc::new(Tracer::new(scene.clone()));
        let lit = LitScene::new(tracer, LightOptions::default(), &Resources::default());
        let camera =
            Camera { width: 96, height: 64, focus_distance: 3.0, aperture_radius: 0.3, ..Camera::default() };
        let mut focus = Focus::constant(scene, FocusOffset::STANDARD);
        let options = WebPageOptions { aperture_divisors: vec![1.0, 2.0], ..WebPageOptions::default() };
        let plain = estimate_web_page(&lit, &camera, &focus, &options);
        focus.parts[1] = FocusSource::Constant(FocusOffset::SHARP);
        let painted = estimate_web_page(&lit, &camera, &focus, &options);
        assert!(painted.slices > plain.slices && painted.bytes > plain.bytes, "{plain:?} {painted:?}");

        let page = folder.path().join("page.html");
        let report = export_web_page(&page, &lit, &camera, &focus, &options, &Unwatched).unwrap();
        let slices: usize = report.stacks.iter().map(|stack| stack.slices).sum();
        assert!(slices as u64 + 3 >= painted.slices, "{slices}, about {}", painted.slices);
        assert_eq!(report.bytes, page.metadata().unwrap().len());
        assert!(
            report.stacks.iter().all(|stack| stack.largest_blur_px <= 1.0 && stack.at_rest.lowest >= 40.0)
        );
        let [widest, half] = [0, 2].map(|k| &report.stacks[k]);
        assert!(widest.aperture != half.aperture && widest.slices >= half.slices, "{report:?}");
        assert!(widest.to_string().contains("painted") && report.stacks[1].to_string().contains("ordinary"));
    }
}
