//! Stereo pairs: the same light field through two small parts of the aperture.
//!
//! Through every part of its aperture, a thin lens shows the plane in focus at the same place. Each eye's picture is therefore that of a
//! sub-aperture, focused on the point that both eyes fixate: that point has no disparity, and nothing is cut off at the sides of the frame.

use crate::error::RenderError;
use crate::picture::input_picture::{lit_scene_of, render_input};
use crate::picture::pixel_ray::pixel_ray;
use crate::picture::render::{RenderCost, RenderOptions, Rendered, draw_baked};
use crate::picture::renderer::Renderer;
use document::Input;
use focus::Focus;
use glam::DVec2;
use lens::{Aperture, Camera, Exposure, Picture, SUB_APERTURE_RADIUS};
use light::Steps;
use std::sync::Arc;
use std::time::Instant;
use trace::Tracer;

/// How the two pictures are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StereoForm {
    /// The left eye's picture on the left, the right eye's on the right.
    SideBySide,
    /// Red from the left eye, green and blue from the right eye, for red-cyan glasses.
    Anaglyph,
}

/// Options of a stereo pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// How the two pictures are combined.
    pub form: StereoForm,
    /// Distance between the eyes, as a share of the aperture's diameter, in (0, 15/16].
    pub eyes: f64,
    /// The pixel position that both eyes fixate; `None`: what the camera is focused on.
    pub fixate: Option<DVec2>,
    /// Exposure of the pictures. Each eye has its own coverage.
    pub exposure: Exposure,
}

impl Stereo {
    /// Maximum of [`Self::eyes`]: each eye needs a sub-aperture around it.
    pub const MAX_EYE_DISTANCE: f64 = 1.0 - SUB_APERTURE_RADIUS;

    /// Combines a pair for a `camera` that is focused on the fixated point. `draw` renders the picture of one eye's camera. Everything but
    /// the picture is that of the right eye.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn render_pair<E>(
        &self,
        camera: &Camera,
        mut draw: impl FnMut(&Camera) -> Result<Rendered, E>,
    ) -> Result<Rendered, E> {
        let eye = |side: f64| Camera {
            aperture: Aperture::sub_aperture(DVec2::new(side * self.eyes, 0.0)),
            ..camera.clone()
        };
        let (left, right) = (draw(&eye(-1.0))?, draw(&eye(1.0))?);
        let picture = combine(&left.picture, &right.picture, self);
        Ok(Rendered { picture, ..right })
    }
}

/// Renders a stereo pair. AOVs are ignored: they belong to a single camera.
///
/// # Errors
/// As [`render_input`]; or the camera is a pinhole, the eyes do not fit into its aperture, or the fixated position is outside the
/// picture.
pub fn render_stereo(
    input: &Input,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    stereo: &Stereo,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let bad = |what: &str| Err(RenderError::bad_file(&input.path, what));
    if camera.aperture_radius <= 0.0 {
        return bad("its camera is a pinhole, which has no room for two eyes (give --aperture-radius)");
    }
    if !(stereo.eyes > 0.0 && stereo.eyes <= Stereo::MAX_EYE_DISTANCE) {
        return bad(
            "the eyes do not fit into the aperture (give --eyes between 0 and 0.9375 of the aperture's diameter)",
        );
    }
    let lit = lit_scene_of(input, camera)?;
    let focus_distance = match stereo.fixate {
        Some(place) => fixation_distance(lit.tracer(), input, camera, place)?,
        None => camera.focus_distance,
    };
    let camera = Camera { focus_distance, ..camera.clone() };
    let options = RenderOptions { aovs: Vec::new(), ..options.clone() };
    let mut rendered = match input.salf.is_none() && options.renderer == Renderer::Splat {
        // Both eyes share one light field.
        true => {
            let start = Instant::now();
            let salf = Arc::new(options.bake(&lit, &camera, focus, steps)?);
            let bake_seconds = start.elapsed().as_secs_f64();
            let drawn =
                stereo.render_pair(&camera, |eye| draw_baked(&salf, &lit, eye, focus, &options, steps))?;
            Rendered { cost: RenderCost { bake_seconds, ..drawn.cost }, ..drawn }
        }
        false => stereo.render_pair(&camera, |eye| render_input(input, eye, focus, &options, steps))?,
    };
    rendered.layers.clear();
    Ok(rendered)
}

/// Axial depth of the surface at a pixel position; infinite where there is none.
fn fixation_distance(
    tracer: &Tracer,
    input: &Input,
    camera: &Camera,
    place: DVec2,
) -> Result<f64, RenderError> {
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    if !(place.cmpge(DVec2::ZERO).all() && place.cmplt(size).all()) {
        let what = format!(
            "its picture of {} × {} px has no pixel {},{} to fixate",
            camera.width, camera.height, place.x, place.y
        );
        return Err(RenderError::bad_file(&input.path, what));
    }
    let number = place.y as u32 * camera.width + place.x as u32;
    let ray = pixel_ray(camera, number);
    let hit = tracer.visible_surface(&ray);
    let depth = hit.map(|hit| camera.camera_from_world(hit.point.position(&input.scene)).z);
    Ok(depth.unwrap_or(f64::INFINITY))
}

fn combine(left: &Picture, right: &Picture, stereo: &Stereo) -> Picture {
    let (width, height) = (left.width as usize, left.height as usize);
    match stereo.form {
        StereoForm::SideBySide => {
            let mut picture = Picture::black(2 * left.width, left.height);
            for row in 0..height {
                for (eye, from) in [left, right].into_iter().enumerate() {
                    let to = (2 * row + eye) * width..(2 * row + eye + 1) * width;
                    let of = row * width..(row + 1) * width;
                    picture.radiance[to.clone()].copy_from_slice(&from.radiance[of.clone()]);
                    picture.coverage[to].copy_from_slice(&from.coverage[of]);
                }
            }
            picture.colour_coverage =
                left.colour_coverage.as_ref().zip(right.colour_coverage.as_ref()).map(|eyes| {
                    let rows = eyes.0.chunks(width).zip(eyes.1.chunks(width));
                    rows.flat_map(|(left, right)| [left, right]).flatten().copied().collect()
                });
            picture
        }
        StereoForm::Anaglyph => {
            let shown = |picture: &Picture, pixel: usize, channel: usize| match stereo.exposure {
                Exposure::Conserve => picture.radiance[pixel][channel],
                Exposure::Normalise => match picture.coverage_of_colours(pixel)[channel] {
                    covered if covered > 0.0 => picture.radiance[pixel][channel] / covered,
                    _ => 0.0,
                },
            };
            let pixels = 0..width * height;
            let radiance =
                pixels.map(|pixel| [shown(left, pixel, 0), shown(right, pixel, 1), shown(right, pixel, 2)]);
            Picture {
                width: left.width,
                height: left.height,
                radiance: radiance.collect(),
                coverage: vec![1.0; width * height],
                colour_coverage: None,
            }
        }
    }
}
