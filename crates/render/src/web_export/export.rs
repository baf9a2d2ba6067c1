//! Draws the slices of a web page, and writes it.

use crate::error::RenderError;
use crate::picture::{new_splatter, to_screen};
use crate::web_export::first_surfaces::FirstSurfaces;
use crate::web_export::options::WebPageOptions;
use crate::web_export::report::{StackReport, WebPageReport};
use focus::Focus;
use lens::{Camera, FocusOffset};
use light::{LitScene, Steps};
use progress::Stage;
use rayon::prelude::*;
use salf::{BakeOptions, Salf};
use scene::SurfaceField;
use splat::Splatter;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use web_page::{
    DistanceRange, OpeningSlice, PlacedSlices, PublicAddress, ScreenPicture, SliceStack, WebPage,
    WebPageError, place_slices, slice_distances,
};

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
    check(path, camera, options)?;
    let poster_path = path.with_extension("poster.png");
    let address = options.address.as_deref().map(|page| address(path, page, &poster_path)).transpose()?;
    let surfaces = FirstSurfaces::trace(lit.tracer(), camera, focus, &*steps.begin("first surfaces"))?;
    let range = surfaces.range(camera);
    let mut drawing = Drawing { path, lit, camera, options, range, steps, opening: None, used_bytes: 0 };

    let is_painted = is_painted(focus);
    let ordinary_focus = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
    let (mut stacks, mut reports) = (Vec::new(), Vec::new());
    for (index, &divisor) in options.aperture_divisors.iter().enumerate() {
        let has_ordinary = !is_painted || (index == 0 && options.has_ordinary_focus);
        let painted = is_painted.then_some((true, focus));
        let ordinary = has_ordinary.then_some((false, &ordinary_focus));
        let shown: Vec<_> = painted.into_iter().chain(ordinary).collect();
        for (stack, report) in drawing.draw_aperture(divisor, &shown)? {
            stacks.push(stack);
            reports.push(report);
        }
    }

    let (slice, opening_picture) = drawing.opening.ok_or_else(|| {
        let what = "no slice shows the camera's own focus distance (please report this)";
        RenderError::Internal(format!("{}: {what}", path.display()))
    })?;
    let page = WebPage {
        size: [camera.width, camera.height],
        caption: options.caption.clone(),
        opening: OpeningSlice { stack: 0, slice },
        opening_picture,
        stacks,
        range,
        sharp_distances: surfaces.sharp_distances(range),
        paint: is_painted.then(|| surfaces.paint_maps(range, &camera.optics())),
        is_autoplaying: options.is_autoplaying,
        address,
    };
    let html = page.to_html().map_err(|error| page_error(path, error))?;
    if html.len() as u64 > options.most_bytes() {
        return Err(page_error(path, WebPageError::TooLarge));
    }
    let mut files = vec![write(path, html.as_bytes())?];
    if page.address.is_some() {
        files.push(write(&poster_path, &png(path, &page.opening_picture)?)?);
    }
    Ok(WebPageReport { files, bytes: html.len() as u64, stacks: reports })
}

fn check(path: &Path, camera: &Camera, options: &WebPageOptions) -> Result<(), RenderError> {
    camera.validate().map_err(|error| RenderError::bad_file(path, error))?;
    ScreenPicture::check_size([camera.width, camera.height]).map_err(|error| page_error(path, error))?;
    let divisors = &options.aperture_divisors;
    let are_divisors = divisors.first().is_some_and(|&first| first >= 1.0)
        && divisors.iter().all(|divisor| divisor.is_finite())
        && divisors.windows(2).all(|pair| pair[1] >= pair[0] * LEAST_APERTURE_RATIO);
    if !are_divisors {
        let what = "apertures are divisors of the camera's: ascending, at least 5 % apart, the first at least 1 (such as 1,2,4)";
        return Err(RenderError::bad_file(path, what));
    }
    // Also of the smallest: a divisor may be as large as a number can be.
    let smallest = camera.aperture_radius / divisors.last().copied().unwrap_or(1.0);
    if !smallest.is_normal() {
        let what = "a pinhole cannot be refocused (give the camera an aperture radius above 0)";
        return Err(RenderError::bad_file(path, what));
    }
    Ok(())
}

/// The public address of the page, with that of its poster.
fn address(path: &Path, page: &str, poster: &Path) -> Result<PublicAddress, RenderError> {
    let name = poster.file_name().unwrap_or_default().to_string_lossy();
    PublicAddress::new(page, &name).ok_or_else(|| {
        let what = format!("{page:?} is no address of a page (give it as https://example.org/page.html)");
        RenderError::bad_file(path, what)
    })
}

/// Whether any surface, or the background, is not focused by the ordinary lens.
fn is_painted(focus: &Focus) -> bool {
    let is_standard = |triangle: u32| {
        focus.bounds(triangle).is_some_and(|bounds| bounds.iter().all(|bound| bound.is_standard()))
    };
    let triangles = focus.scene.triangles.len() as u32;
    !focus.background.is_standard() || !(0..triangles).into_par_iter().all(is_standard)
}

/// What all stacks have in common.
struct Drawing<'a> {
    path: &'a Path,
    lit: &'a Arc<LitScene>,
    camera: &'a Camera,
    options: &'a WebPageOptions,
    range: DistanceRange,
    steps: &'a dyn Steps,
    /// Index and picture of the slice at the camera's own focus distance, in the first stack.
    opening: Option<(usize, ScreenPicture)>,
    /// Bytes of the stacks that are drawn.
    used_bytes: u64,
}

impl Drawing<'_> {
    /// Bakes the light field of an aperture, and draws a stack for each focus, painted or not. The field of the widest aperture would be at
    /// 47 dB from that at half of it, and at 43 dB at a quarter (the demo): no room for compression to 40.
    fn draw_aperture(
        &mut self,
        divisor: f64,
        shown: &[(bool, &Focus)],
    ) -> Result<Vec<(SliceStack, StackReport)>, RenderError> {
        let aperture_radius = self.camera.aperture_radius / divisor;
        let camera = Camera { aperture_radius, ..self.camera.clone() };
        let px_per_kappa = camera.optics().splat_radius_px(1.0);
        let distances = self.distances(px_per_kappa)?;
        let salf = Arc::new(self.bake(&camera, shown)?);
        let mut splatter = new_splatter(salf, &self.options.render);
        let draw_stack = |&(is_painted, focus): &(bool, &Focus)| {
            let aperture = aperture_name(camera.f_number());
            let focusing = if is_painted { "painted" } else { "ordinary focus" };
            let label = format!("slices at {aperture}, {focusing}");
            let placed = self.place(&mut splatter, &camera, focus, &distances, &label)?;
            let report = StackReport::new(&aperture, is_painted, &placed, px_per_kappa);
            self.used_bytes += placed.bytes();
            Ok((SliceStack { aperture, is_painted, slices: placed.slices }, report))
        };
        shown.iter().map(draw_stack).collect()
    }

    /// The distances of the slices before any error is measured.
    fn distances(&self, px_per_kappa: f64) -> Result<Vec<f64>, RenderError> {
        let most = match self.options.is_large_allowed {
            true => WebPageOptions::MOST_SLICES,
            false => WebPageOptions::USUAL_SLICES,
        };
        let step = WebPageOptions::LARGEST_STEP_PX / px_per_kappa;
        let opening = self.camera.optics().inverse_focus_distance;
        slice_distances(self.range, opening, step, most).ok_or_else(|| {
            let what = format!(
                "the picture is blurred so much that it needs more than {most} slices (use a smaller aperture or a smaller size)"
            );
            RenderError::bad_file(self.path, what)
        })
    }

    /// Bakes a light field that holds what every distance shows.
    fn bake(&self, camera: &Camera, shown: &[(bool, &Focus)]) -> Result<Salf, RenderError> {
        let options = &self.options.render;
        let finer = options.finer(camera)?;
        let ends = [self.range.farthest, self.range.nearest].map(|inverse| focused(&finer, inverse));
        let shots = ends.iter().flat_map(|end| {
            shown.iter().map(move |&(_, focus)| (end, focus as &dyn SurfaceField<FocusOffset>))
        });
        let needed = BakeOptions::for_all(self.lit.tracer(), shots);
        options.bake_as(self.lit, camera, needed, self.steps)
    }

    /// Draws a stack.
    fn place(
        &mut self,
        splatter: &mut Splatter,
        camera: &Camera,
        focus: &Focus,
        distances: &[f64],
        label: &str,
    ) -> Result<PlacedSlices, RenderError> {
        let options = self.options;
        let cells_a_side = options.render.cells_a_side;
        let progress = self.steps.begin(label);
        let mut is_summed = false;
        let mut opening_picture = None;
        let opening = camera.optics().inverse_focus_distance;
        let draw = |inverse_distance: f64| -> Result<ScreenPicture, StackError> {
            let share = self.share_done(inverse_distance);
            progress.check()?;
            progress.report(share);
            let camera = focused(&camera.finer(cells_a_side), inverse_distance);
            let watched = Stage::new(&*progress, share, share);
            match is_summed {
                true => splatter.refocus(&camera, &watched)?,
                false => splatter.render(&camera, focus, &watched)?,
            }
            is_summed = true;
            let picture = splatter.picture().averaged(cells_a_side);
            let pixels = to_screen(&picture, options.tone).into_iter().map(|[r, g, b, _]| [r, g, b]);
            let picture = ScreenPicture::new([picture.width, picture.height], pixels.collect())?;
            if inverse_distance == opening {
                opening_picture = Some(picture.clone());
            }
            Ok(picture)
        };
        let most_bytes = (options.most_bytes() / 4 * 3).saturating_sub(self.used_bytes);
        let placed = place_slices(distances, &WebPageOptions::placement(most_bytes), draw).map_err(
            |error| match error {
                StackError::Drawing(error) => error,
                StackError::Page(error) => page_error(self.path, error),
            },
        )?;
        if self.opening.is_none() {
            let slice = placed.slices.iter().position(|slice| slice.inverse_distance == opening);
            self.opening = slice.zip(opening_picture);
        }
        Ok(placed)
    }

    /// How much of a stack is drawn once it has come to a distance.
    fn share_done(&self, inverse_distance: f64) -> f32 {
        let DistanceRange { farthest, nearest } = self.range;
        if nearest > farthest { ((inverse_distance - farthest) / (nearest - farthest)) as f32 } else { 0.0 }
    }
}

/// Why a stack could not be drawn.
enum StackError {
    Drawing(RenderError),
    Page(WebPageError),
}

impl From<WebPageError> for StackError {
    fn from(error: WebPageError) -> Self {
        Self::Page(error)
    }
}

impl<E: Into<RenderError>> From<E> for StackError {
    fn from(error: E) -> Self {
        Self::Drawing(error.into())
    }
}

/// The camera, focused on a reciprocal distance.
fn focused(camera: &Camera, inverse_distance: f64) -> Camera {
    Camera { focus_distance: 1.0 / inverse_distance, ..camera.clone() }
}

/// An f-number with three digits.
fn aperture_name(f_number: f64) -> String {
    let decimals = match f_number {
        ..9.995 => 2,
        ..99.95 => 1,
        _ => 0,
    };
    format!("f/{f_number:.decimals$}")
}

fn page_error(path: &Path, error: WebPageError) -> RenderError {
    match error {
        WebPageError::TooLarge => {
            let megabytes = WebPageOptions::USUAL_BYTES / 1_000_000;
            let what = format!(
                "the page would be larger than {megabytes} MB, more than phones can open (use fewer apertures, a smaller size, or --large)"
            );
            RenderError::bad_file(path, what)
        }
        WebPageError::Template(_) | WebPageError::Inconsistent(_) => {
            RenderError::Internal(format!("{}: {error}", path.display()))
        }
        WebPageError::Size(..) | WebPageError::Encoder(_) => RenderError::bad_file(path, error),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apertures_are_named_with_three_digits() {
        assert_eq!([1.079, 9.996, 22.04, 128.0].map(aperture_name), ["f/1.08", "f/10.0", "f/22.0", "f/128"]);
    }

    #[test]
    fn a_page_that_is_too_large_names_the_cures() {
        let RenderError::BadInput(text) = page_error(Path::new("page.html"), WebPageError::TooLarge) else {
            panic!("it is the input's fault")
        };
        assert!(
            text.starts_with("page.html: ") && text.contains("30 MB") && text.contains("--large"),
            "{text}"
        );
    }
}
