//! Writes a page whose visitors choose any lens, and paint: a light field with the program that draws it.

use crate::error::RenderError;
use crate::picture::{Display, Tone, ToneCurve, new_splatter, to_screen};
use crate::web_export::export::{check_camera, public_address, write_page};
use crate::web_export::first_surfaces::FirstSurfaces;
use crate::web_export::options::WebPageOptions;
use crate::web_export::page_error::page_error;
use crate::web_export::report::WebPageReport;
use crate::web_export::stacks::needed_for_range;
use focus::{Focus, ViewFrame};
use lens::{ApertureShape, Camera};
use light::{LitScene, Steps};
use salf::BakeOptions;
use std::path::Path;
use std::sync::Arc;
use web_engine::FieldOfPage;
use web_page::{EnginePage, ScreenPicture, USUAL_QUALITY, encode_picture};

/// The diameter of the largest blur that visitors can paint, in heights of the picture: `MOST_BLUR` of `brush_tool.js`.
const LARGEST_PAINTED_BLUR: f64 = 0.25;

/// Pixels of the picture of a page that is to open on phones.
const USUAL_PIXELS: f64 = 1280.0 * 720.0;

/// The camera with no more pixels than a page usually has.
pub fn usual_engine_camera(camera: &Camera) -> Camera {
    let pixels = f64::from(camera.width) * f64::from(camera.height);
    let scale = (USUAL_PIXELS / pixels).sqrt().min(1.0);
    let [width, height] =
        [camera.width, camera.height].map(|side| (f64::from(side) * scale).round().max(1.0) as u32);
    Camera { width, height, ..camera.clone() }
}

/// Bakes what `camera` shows of a scene, painted with `focus`, and writes the light field as a page with the program that draws it. The page
/// opens with the camera's own lens; its aperture is the widest. Tone mapping is not used. An existing file is replaced once the new one is complete.
///
/// # Errors
/// The camera or the address cannot be used, the page would be too large, the light cannot be solved, the file cannot be written, or the work
/// was cancelled.
pub fn export_engine_page(
    path: &Path,
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &WebPageOptions,
    steps: &dyn Steps,
) -> Result<WebPageReport, RenderError> {
    check_camera(path, camera)?;
    let address = public_address(path, options)?;
    let display = Display { curve: ToneCurve::Clip, ..options.tone.display };
    let tone = Tone { display, ..options.tone };
    let render = &options.render_options(camera);
    let surfaces = FirstSurfaces::trace(lit.tracer(), camera, focus, &*steps.begin("first surfaces"))?;
    let needed = needed_for_range(lit, camera, surfaces.range(camera), &[focus]);
    // Visitors may paint blur.
    let margin_px = needed.margin_px.max(LARGEST_PAINTED_BLUR / 2.0 * f64::from(camera.height));
    let needed = BakeOptions { margin_px, ..needed };
    let salf = Arc::new(render.bake_as(lit, camera, needed, steps)?);
    let mut splatter = new_splatter(salf.clone(), render);
    splatter.render(camera, focus, &*steps.begin("picture"))?;
    let picture = splatter.picture().clone().with_common_coverage();
    let in_page = |error| page_error(path, error);
    let pixels = to_screen(&picture, tone).into_iter().map(|[r, g, b, _]| [r, g, b]);
    let size = [picture.width, picture.height];
    let opening_picture = ScreenPicture::new(size, pixels.collect()).map_err(in_page)?;
    let poster =
        encode_picture(&opening_picture, WebPageOptions::REST_PSNR, USUAL_QUALITY).map_err(in_page)?;
    let gain = options.tone.display.stops.exp2();
    let field = FieldOfPage { gain, ..FieldOfPage::new(&salf, focus, options.tone.exposure) };
    let view = serde_json::to_value(ViewFrame::from_camera(camera)).map_err(|error| {
        RenderError::Internal(format!("{}: {error} (please report this)", path.display()))
    })?;
    let page = EnginePage {
        caption: options.caption.clone(),
        poster: poster.webp,
        opening_picture,
        field: field.to_bytes(),
        view,
        has_disc: camera.aperture.shape == ApertureShape::Disc && camera.aperture.ratio == 1.0,
        is_painted: field.focus.is_some(),
        is_autoplaying: options.is_autoplaying,
        address,
    };
    let html = page.to_html().map_err(in_page)?;
    let files = write_page(path, &html, &page.opening_picture, options)?;
    Ok(WebPageReport { files, bytes: html.len() as u64, stacks: Vec::new() })
}
