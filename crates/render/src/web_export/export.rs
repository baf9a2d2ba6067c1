//! Draws a web page, and writes it.

use crate::error::RenderError;
use crate::web_export::first_surfaces::FirstSurfaces;
use crate::web_export::options::WebPageOptions;
use crate::web_export::page_error::page_error;
use crate::web_export::report::WebPageReport;
use crate::web_export::stacks::{Focusing, StackDrawing};
use focus::Focus;
use lens::{Camera, FocusOffset};
use light::{LitScene, Steps};
use rayon::prelude::*;
use scene::SurfaceField;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use web_page::{OpeningSlice, PublicAddress, ScreenPicture, WebPage, WebPageError};

/// Adjacent apertures differ at least by this factor, so that their names differ.
const LEAST_APERTURE_RATIO: f64 = 1.05;

/// Draws what `camera` shows of a scene, painted with `focus`, at all focus distances, and writes it as a page. The page opens with the
/// camera's own focus distance. An existing file is replaced once the new one is complete.
///
/// # Errors
/// The camera, the apertures or the address cannot be used, the page would be too large, the light cannot be solved, the file cannot be
/// written, or the work was cancelled.
pub fn export_web_page(
    path: &Path,
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &WebPageOptions,
    steps: &dyn Steps,
) -> Result<WebPageReport, RenderError> {
    check_camera(path, camera)?;
    check_apertures(path, camera, options)?;
    let address = public_address(path, options)?;
    let optics = camera.optics();
    let surfaces = FirstSurfaces::trace(lit.tracer(), camera, focus, &*steps.begin("first surfaces"))?;
    let range = surfaces.range(camera);

    let is_painted = is_painted(focus);
    let ordinary_focus = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
    let focusing = |is_painted: bool, focus| {
        let sharp = surfaces.all_sharp_distances(range, &optics, is_painted);
        Focusing { is_painted, focus, sharp }
    };
    let painted = is_painted.then(|| focusing(true, focus));
    let ordinary = focusing(false, &ordinary_focus);
    let mut drawing = StackDrawing::new(path, lit, camera, range, options, steps);
    let (mut stacks, mut reports) = (Vec::new(), Vec::new());
    for (index, &divisor) in options.aperture_divisors.iter().enumerate() {
        let has_ordinary = !is_painted || (index == 0 && options.has_ordinary_focus);
        let focusings: Vec<_> = painted.iter().chain(has_ordinary.then_some(&ordinary)).collect();
        for (stack, report) in drawing.draw_aperture(divisor, &focusings)? {
            stacks.push(stack);
            reports.push(report);
        }
    }

    let (slice, opening_picture) = drawing.into_opening()?;
    let page = WebPage {
        size: [camera.width, camera.height],
        caption: options.caption.clone(),
        opening: OpeningSlice { stack: 0, slice },
        opening_picture,
        stacks,
        range,
        sharp_distances: surfaces.sharp_distances(range),
        paint: is_painted.then(|| surfaces.paint_maps(range, &optics)),
        is_autoplaying: options.is_autoplaying,
        address,
    };
    let html = page.to_html().map_err(|error| page_error(path, error))?;
    let files = write_page(path, &html, &page.opening_picture, options)?;
    Ok(WebPageReport { files, bytes: html.len() as u64, stacks: reports })
}

/// Checks that `camera` has a picture that can be refocused and fits a page.
///
/// # Errors
/// The camera cannot be used, or is a pinhole.
pub fn check_camera(path: &Path, camera: &Camera) -> Result<(), RenderError> {
    camera.validate().map_err(|error| RenderError::bad_file(path, error))?;
    check_aperture(path, camera.aperture_radius)?;
    ScreenPicture::check_size([camera.width, camera.height]).map_err(|error| page_error(path, error))
}

fn check_aperture(path: &Path, radius: f64) -> Result<(), RenderError> {
    if radius.is_normal() {
        return Ok(());
    }
    let what = "a pinhole cannot be refocused (give the camera an aperture radius above 0)";
    Err(RenderError::bad_file(path, what))
}

fn check_apertures(path: &Path, camera: &Camera, options: &WebPageOptions) -> Result<(), RenderError> {
    let divisors = &options.aperture_divisors;
    let are_divisors = divisors.first().is_some_and(|&first| first >= 1.0)
        && divisors.iter().all(|divisor| divisor.is_finite())
        && divisors.windows(2).all(|pair| pair[1] >= pair[0] * LEAST_APERTURE_RATIO);
    if !are_divisors {
        let what = "apertures are divisors of the camera's: ascending, at least 5 % apart, the first at least 1 (such as 1,2,4)";
        return Err(RenderError::bad_file(path, what));
    }
    // Also of the smallest: a divisor may be as large as a number can be.
    check_aperture(path, camera.aperture_radius / divisors.last().copied().unwrap_or(1.0))
}

/// The public address of the page, with that of its poster; `None` if it is not going to be published.
///
/// # Errors
/// It is no address of a page.
pub fn public_address(path: &Path, options: &WebPageOptions) -> Result<Option<PublicAddress>, RenderError> {
    let Some(page) = &options.address else { return Ok(None) };
    let poster = poster_path(path);
    let name = poster.file_name().unwrap_or_default().to_string_lossy();
    PublicAddress::new(page, &name).map(Some).ok_or_else(|| {
        let what = format!("{page:?} is no address of a page (give it as https://example.org/page.html)");
        RenderError::bad_file(path, what)
    })
}

fn poster_path(page: &Path) -> PathBuf {
    page.with_extension("poster.png")
}

/// Writes a page and, if it is going to be published, its poster. Returns their files.
///
/// # Errors
/// The page is larger than it may be, or a file cannot be written.
pub fn write_page(
    path: &Path,
    html: &str,
    poster: &ScreenPicture,
    options: &WebPageOptions,
) -> Result<Vec<PathBuf>, RenderError> {
    if html.len() as u64 > options.most_bytes() {
        return Err(page_error(path, WebPageError::TooLarge));
    }
    let mut files = vec![write(path, html.as_bytes())?];
    if options.address.is_some() {
        files.push(write(&poster_path(path), &png(path, poster)?)?);
    }
    Ok(files)
}

/// Whether any surface, or the background, is not focused by the ordinary lens.
fn is_painted(focus: &Focus) -> bool {
    let is_standard = |triangle: u32| {
        focus.bounds(triangle).is_some_and(|bounds| bounds.iter().all(|bound| bound.is_standard()))
    };
    let triangles = focus.scene.triangles.len() as u32;
    !focus.background.is_standard() || !(0..triangles).into_par_iter().all(is_standard)
}

fn png(path: &Path, picture: &ScreenPicture) -> Result<Vec<u8>, RenderError> {
    let rgba: Vec<u8> = picture.pixels().iter().flat_map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
    let internal = |error| RenderError::Internal(format!("{}: {error} (please report this)", path.display()));
    project::texture_png(picture.size(), &rgba).map_err(internal)
}

fn write(path: &Path, bytes: &[u8]) -> Result<PathBuf, RenderError> {
    atomic_file::write(path, bytes).map_err(|error| RenderError::io(path, &error))?;
    Ok(path.to_owned())
}
