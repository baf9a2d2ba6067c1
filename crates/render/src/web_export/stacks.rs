//! Draws the stacks of a web page: bakes each aperture once, and sums its light field at each focus distance.

use crate::error::RenderError;
use crate::picture::{RenderOptions, new_splatter, to_screen};
use crate::web_export::options::WebPageOptions;
use crate::web_export::page_error::page_error;
use crate::web_export::report::StackReport;
use focus::Focus;
use lens::Camera;
use light::{LitScene, Steps};
use progress::Stage;
use salf::{BakeOptions, Salf};
use scene::SurfaceField;
use splat::Splatter;
use std::path::Path;
use std::sync::Arc;
use web_page::{
    DistanceRange, PlacedSlices, ScreenPicture, SliceSpacing, SliceStack, WebPageError, place_slices,
};

/// How the surfaces of a stack are focused.
pub struct Focusing<'a> {
    /// As painted, or by the ordinary lens.
    pub is_painted: bool,
    /// The focus.
    pub focus: &'a Focus,
    /// The reciprocal distances that make some surface sharp, ascending.
    pub sharp: Vec<f64>,
}

/// Draws stacks, one after the other.
pub struct StackDrawing<'a> {
    path: &'a Path,
    lit: &'a Arc<LitScene>,
    camera: &'a Camera,
    range: DistanceRange,
    options: &'a WebPageOptions,
    render: RenderOptions,
    steps: &'a dyn Steps,
    /// Index and picture of the slice at the camera's own focus distance, in the first stack.
    opening: Option<(usize, ScreenPicture)>,
    /// Bytes of the stacks that are drawn.
    used_bytes: u64,
}

impl<'a> StackDrawing<'a> {
    /// Draws what `camera` shows of a scene at the focus distances in `range`, for a page at `path`.
    pub fn new(
        path: &'a Path,
        lit: &'a Arc<LitScene>,
        camera: &'a Camera,
        range: DistanceRange,
        options: &'a WebPageOptions,
        steps: &'a dyn Steps,
    ) -> Self {
        let render = options.render_options(camera);
        Self { path, lit, camera, range, options, render, steps, opening: None, used_bytes: 0 }
    }

    /// Bakes the light field of an aperture, whose radius is the camera's by `divisor`, and draws a stack for each focusing. The field of
    /// the widest aperture would be at 47 dB from that at half of it, and at 43 dB at a quarter (the demo): no room for compression to 40.
    ///
    /// # Errors
    /// The stacks are too large, or the work was cancelled.
    pub fn draw_aperture(
        &mut self,
        divisor: f64,
        focusings: &[&Focusing],
    ) -> Result<Vec<(SliceStack, StackReport)>, RenderError> {
        let aperture_radius = self.camera.aperture_radius / divisor;
        let camera = Camera { aperture_radius, ..self.camera.clone() };
        let px_per_kappa = camera.optics().splat_radius_px(1.0);
        let spacings = focusings.iter().map(|focusing| self.spacing(&focusing.sharp, px_per_kappa));
        let spacings = spacings.collect::<Result<Vec<_>, _>>()?;
        let salf = Arc::new(self.bake(&camera, focusings)?);
        let mut splatter = new_splatter(salf, &self.render);
        let aperture = aperture_name(camera.f_number());
        let draw_stack = |(focusing, spacing): (&&Focusing, SliceSpacing)| {
            let Focusing { is_painted, focus, sharp } = focusing;
            let kind = if *is_painted { "painted" } else { "ordinary focus" };
            let label = format!("slices at {aperture}, {kind}");
            let placed = self.place(&mut splatter, &camera, focus, &spacing, &label)?;
            let report = StackReport::new(&aperture, *is_painted, &placed, sharp, px_per_kappa);
            self.used_bytes += placed.bytes();
            let stack =
                SliceStack { aperture: aperture.clone(), is_painted: *is_painted, slices: placed.slices };
            Ok((stack, report))
        };
        focusings.iter().zip(spacings).map(draw_stack).collect()
    }

    /// Index and picture of the slice at the camera's own focus distance, in the first stack.
    ///
    /// # Errors
    /// There is none, which is a bug.
    pub fn into_opening(self) -> Result<(usize, ScreenPicture), RenderError> {
        self.opening.ok_or_else(|| {
            let what = "no slice shows the camera's own focus distance (please report this)";
            RenderError::Internal(format!("{}: {what}", self.path.display()))
        })
    }

    /// Where slices are needed before any error is measured.
    fn spacing<'s>(&self, sharp: &'s [f64], px_per_kappa: f64) -> Result<SliceSpacing<'s>, RenderError> {
        let opening = self.camera.optics().inverse_focus_distance;
        let reach = WebPageOptions::LARGEST_BLUR_PX / px_per_kappa;
        let spacing = SliceSpacing { sharp, range: self.range, opening, reach };
        let most = self.options.most_slices();
        if spacing.least_slices(most).is_none() {
            let what = format!(
                "the picture is blurred so much that it needs more than {most} slices (use a smaller aperture or a smaller size)"
            );
            return Err(RenderError::bad_file(self.path, what));
        }
        Ok(spacing)
    }

    /// Bakes a light field that holds what every distance shows.
    fn bake(&self, camera: &Camera, focusings: &[&Focusing]) -> Result<Salf, RenderError> {
        let options = &self.render;
        let focuses: Vec<&Focus> = focusings.iter().map(|focusing| focusing.focus).collect();
        let needed = needed_for_range(self.lit, &options.finer(camera)?, self.range, &focuses);
        options.bake_as(self.lit, camera, needed, self.steps)
    }

    /// Draws the slices of a stack.
    fn place(
        &mut self,
        splatter: &mut Splatter,
        camera: &Camera,
        focus: &Focus,
        spacing: &SliceSpacing,
        label: &str,
    ) -> Result<PlacedSlices, RenderError> {
        let options = self.options;
        let cells_a_side = self.render.cells_a_side;
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
            let picture = splatter.picture().averaged(cells_a_side).with_common_coverage();
            let pixels = to_screen(&picture, options.tone).into_iter().map(|[r, g, b, _]| [r, g, b]);
            let picture = ScreenPicture::new([picture.width, picture.height], pixels.collect())?;
            if inverse_distance == opening {
                opening_picture = Some(picture.clone());
            }
            Ok(picture)
        };
        let most_bytes = (options.most_bytes() / 4 * 3).saturating_sub(self.used_bytes);
        let placed = place_slices(spacing, &WebPageOptions::placement(most_bytes), draw);
        let placed = placed.map_err(|error| match error {
            StackError::Drawing(error) => error,
            StackError::Page(error) => page_error(self.path, error),
        })?;
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

/// What the light field of a camera needs to hold, which is refocused over a range of distances.
pub fn needed_for_range(
    lit: &LitScene,
    camera: &Camera,
    range: DistanceRange,
    focuses: &[&Focus],
) -> BakeOptions {
    let ends = [range.farthest, range.nearest].map(|inverse| focused(camera, inverse));
    let shots =
        ends.iter().flat_map(|end| focuses.iter().map(move |&focus| (end, focus as &dyn SurfaceField<_>)));
    BakeOptions::for_all(lit.tracer(), shots)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apertures_are_named_with_three_digits() {
        assert_eq!([1.079, 9.996, 22.04, 128.0].map(aperture_name), ["f/1.08", "f/10.0", "f/22.0", "f/128"]);
    }
}
