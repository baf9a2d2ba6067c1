//! A pair of pictures for two eyes: the same light field through two small parts of the aperture.
//!
//! A thin lens shows what it is focused on at one place through every part of its aperture, so that an eye's picture is the lens's through a
//! small part of it, focused on the point that both eyes fixate: that has no disparity, and nothing is cut off at the frame's sides.

use crate::error::RenderError;
use crate::picture::render::{
    RenderCost, RenderOptions, Rendered, draw_baked, lit_scene_of, pixel_ray, render_input,
};
use crate::picture::renderer::Renderer;
use document::Input;
use focus::Focus;
use glam::DVec2;
use lens::{Aperture, Camera, Exposure, Picture, SUB_APERTURE_RADIUS};
use light::Steps;
use std::sync::Arc;
use std::time::Instant;
use trace::Tracer;

/// How the two pictures become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StereoForm {
    /// The left eye's on the left, the right eye's on the right.
    SideBySide,
    /// Red of the left eye's, green and blue of the right eye's, for glasses of red and cyan.
    Anaglyph,
}

/// What the eyes do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stereo {
    /// How the two pictures become one.
    pub form: StereoForm,
    /// How far the eyes are apart, as a share of the aperture's diameter, in (0, 15/16].
    pub eyes: f64,
    /// The place of the picture that both look at, px; none: what the camera is focused on.
    pub fixate: Option<DVec2>,
    /// How sums become pictures: each eye has its own coverage.
    pub exposure: Exposure,
}

impl Stereo {
    /// The farthest that eyes may be apart: a small part of the aperture is needed around each.
    pub const MAX_EYE_DISTANCE: f64 = 1.0 - SUB_APERTURE_RADIUS;
}

/// Renders a pair. AOVs are of one camera and have no place in it.
///
/// # Errors
/// Those of rendering; the camera has no aperture, the eyes no place in it, or the picture does not have the place.
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
        return bad("is seen through a pinhole: two eyes have no place in it (give --aperture-radius)");
    }
    if !(stereo.eyes > 0.0 && stereo.eyes <= Stereo::MAX_EYE_DISTANCE) {
        return bad(
            "two eyes have no place that far apart (give --eyes between 0 and 0.9375 of the aperture's diameter)",
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
        // One light field serves both.
        true => {
            let start = Instant::now();
            let salf = Arc::new(options.bake(&lit, &camera, focus, steps)?);
            let bake_seconds = start.elapsed().as_secs_f64();
            let drawn =
                render_pair(&camera, stereo, |eye| draw_baked(&salf, &lit, eye, focus, &options, steps))?;
            Rendered { cost: RenderCost { bake_seconds, ..drawn.cost }, ..drawn }
        }
        false => render_pair(&camera, stereo, |eye| render_input(input, eye, focus, &options, steps))?,
    };
    rendered.layers.clear();
    Ok(rendered)
}

/// The pair that a camera's aperture shows, its focus distance the fixated one: each eye's picture as `drawn`, what is told of it that of the
/// right eye's.
pub fn render_pair<E>(
    camera: &Camera,
    stereo: &Stereo,
    mut drawn: impl FnMut(&Camera) -> Result<Rendered, E>,
) -> Result<Rendered, E> {
    let eye = |side: f64| Camera {
        aperture: Aperture::sub_aperture(DVec2::new(side * stereo.eyes, 0.0)),
        ..camera.clone()
    };
    let (left, right) = (drawn(&eye(-1.0))?, drawn(&eye(1.0))?);
    let picture = combine(&left.picture, &right.picture, stereo);
    Ok(Rendered { picture, ..right })
}

/// How far ahead is what the picture shows at a place; at infinity where no surface is.
fn fixation_distance(
    tracer: &Tracer,
    input: &Input,
    camera: &Camera,
    place: DVec2,
) -> Result<f64, RenderError> {
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    if !(place.cmpge(DVec2::ZERO).all() && place.cmplt(size).all()) {
        let what = format!(
            "its picture of {} × {} px has no place {},{} to fixate",
            camera.width, camera.height, place.x, place.y
        );
        return Err(RenderError::bad_file(&input.path, what));
    }
    let number = place.y as u32 * camera.width + place.x as u32;
    let ray = pixel_ray(camera, number);
    let hit = tracer.first_hit(&ray);
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
            picture
        }
        StereoForm::Anaglyph => {
            let shown = |picture: &Picture, pixel: usize, channel: usize| match stereo.exposure {
                Exposure::Conserve => picture.radiance[pixel][channel],
                Exposure::Normalise if picture.coverage[pixel] > 0.0 => {
                    picture.radiance[pixel][channel] / picture.coverage[pixel]
                }
                Exposure::Normalise => 0.0,
            };
            let pixels = 0..width * height;
            let radiance =
                pixels.map(|pixel| [shown(left, pixel, 0), shown(right, pixel, 1), shown(right, pixel, 2)]);
            Picture {
                width: left.width,
                height: left.height,
                radiance: radiance.collect(),
                coverage: vec![1.0; width * height],
            }
        }
    }
}
