//! The renderers that are measured, each with its quality parameter (knob).

use super::stopwatch::{Timed, measure_time};
use baselines::scatter_rays;
use focus::Focus;
use lens::{Camera, Picture};
use light::LitScene;
use light::Steps;
use render::RenderError;
use render::{RenderOptions, Renderer, render};
use salf::Salf;
use session::SessionError;
use splat::Splatter;
use std::sync::Arc;

/// A renderer and the value of its knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contender {
    /// The light field, baked and splatted.
    Splat {
        /// How coarse light field and splat may be, px: see [`RenderOptions::at_tolerance`].
        tolerance_px: f64,
    },
    /// Distributed ray tracing.
    Truth {
        /// Rays per pixel.
        samples_per_pixel: u32,
    },
    /// A blur of the pinhole picture by depth.
    Blur,
    /// The pinhole picture in layers, each blurred.
    Layers {
        /// Depth slices.
        layers: u32,
    },
    /// Pinhole views over the aperture, shifted and added.
    Views {
        /// Views per side of the aperture's square.
        views_a_side: u32,
    },
    /// Gaussian splats, each made larger.
    Dilation {
        /// The standard deviation by which a splat grows, in radii of its circle of confusion.
        sigma_radii: f64,
    },
    /// The light field, baked and scattered ray by ray.
    Scatter {
        /// Rays per sample.
        rays_a_sample: u32,
    },
}

/// What a contender draws.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    /// The scene.
    pub lit: &'a Arc<LitScene>,
    /// The camera.
    pub camera: &'a Camera,
    /// The focus.
    pub focus: &'a Focus,
}

/// The picture drawn by a contender, and its cost.
pub struct DrawnPicture {
    /// The picture.
    pub picture: Picture,
    /// Seconds of the bake, where there is one.
    pub bake_seconds: Option<f64>,
    /// Seconds of everything but the bake; the median of the repeats.
    pub picture_seconds: f64,
    /// How often the picture was drawn.
    pub repeats: u32,
    /// Memory kept for the next picture, bytes.
    pub bytes: usize,
    /// Samples of the light field.
    pub samples: Option<usize>,
}

/// Seed of the measured ray tracer; differs from the seeds of the references.
const MEASURED_SEED: u32 = 1;

impl Contender {
    /// The splat with the default tolerance.
    pub fn default_splat() -> Self {
        Self::Splat { tolerance_px: RenderOptions::default().tolerance_px }
    }

    fn kind(&self) -> Renderer {
        match self {
            Self::Splat { .. } => Renderer::Splat,
            Self::Truth { .. } => Renderer::Truth,
            Self::Blur => Renderer::Blur,
            Self::Layers { .. } => Renderer::Layers,
            Self::Views { .. } => Renderer::Views,
            Self::Dilation { .. } => Renderer::Dilation,
            Self::Scatter { .. } => Renderer::Scatter,
        }
    }

    /// Name of the renderer.
    pub fn renderer(&self) -> &'static str {
        self.kind().name()
    }

    /// A short description of a renderer, by its name, for the page.
    pub fn description(renderer: &str) -> &'static str {
        match Renderer::named(renderer) {
            Some(Renderer::Splat) => "the light field, splatted",
            Some(Renderer::Truth) => "ray tracing",
            Some(Renderer::Blur) => "pinhole picture, blurred by depth",
            Some(Renderer::Layers) => "pinhole picture in layers",
            Some(Renderer::Views) => "pinhole views, shifted and added",
            Some(Renderer::Dilation) => "splats made larger, as other programs do",
            Some(Renderer::Scatter) => "the light field, ray by ray",
            None => "",
        }
    }

    /// Name of its knob; empty if it has none.
    pub fn knob_name(&self) -> &'static str {
        match self {
            Self::Splat { .. } => "tolerance_px",
            Self::Truth { .. } => "spp",
            Self::Blur => "",
            Self::Layers { .. } => "layers",
            Self::Views { .. } => "views_a_side",
            Self::Dilation { .. } => "sigma_radii",
            Self::Scatter { .. } => "rays_a_sample",
        }
    }

    /// The value of the setting by which it trades error for time; 0 if it has none.
    pub fn knob_value(&self) -> f64 {
        match *self {
            Self::Splat { tolerance_px } => tolerance_px,
            Self::Dilation { sigma_radii } => sigma_radii,
            Self::Truth { samples_per_pixel: count }
            | Self::Layers { layers: count }
            | Self::Views { views_a_side: count }
            | Self::Scatter { rays_a_sample: count } => f64::from(count),
            Self::Blur => 0.0,
        }
    }

    fn options(&self) -> RenderOptions {
        let mut options = match *self {
            Self::Splat { tolerance_px } => RenderOptions::at_tolerance(tolerance_px),
            _ => RenderOptions { renderer: self.kind(), ..RenderOptions::default() },
        };
        match *self {
            Self::Splat { .. } => {}
            Self::Truth { samples_per_pixel } => {
                options.truth.samples_per_pixel = samples_per_pixel;
                options.truth.seed = MEASURED_SEED;
            }
            Self::Blur => {}
            Self::Layers { layers } => options.layered.layers = layers,
            Self::Views { views_a_side } => options.views.views_a_side = views_a_side,
            Self::Dilation { sigma_radii } => options.dilation_sigma_radii = sigma_radii,
            Self::Scatter { rays_a_sample } => options.scatter.rays_a_sample = rays_a_sample,
        }
        options
    }

    /// Draws the picture, repeatedly if that is quick, and times it.
    ///
    /// # Errors
    /// Rendering fails or is cancelled.
    pub fn draw(&self, shot: Shot<'_>, steps: &dyn Steps) -> Result<DrawnPicture, SessionError> {
        let pixels = shot.camera.width as usize * shot.camera.height as usize;
        let colour = size_of::<[f32; 3]>();
        let options = self.options();
        match *self {
            Self::Splat { .. } => draw_splat(shot, &options, steps),
            Self::Scatter { .. } => {
                let (baked, salf) = bake_light_field(shot, &options, steps)?;
                let drawn = measure_time(|| {
                    let progress = steps.begin("scattering");
                    let picture = scatter_rays(&salf, shot.camera, shot.focus, &options.scatter, &*progress);
                    Ok(picture.map_err(RenderError::from)?)
                })?;
                Ok(drawn_from_light_field(&salf, baked, drawn, salf.statistics().bytes))
            }
            Self::Truth { .. } => draw_from_scratch(shot, &options, shot.lit.tracer().bytes(), steps),
            // A colour and a defocus per pixel.
            Self::Blur | Self::Layers { .. } => {
                draw_from_scratch(shot, &options, pixels * (colour + size_of::<f64>()), steps)
            }
            Self::Dilation { .. } => draw_from_scratch(shot, &options, pixels * colour, steps),
            // A colour and a depth per pixel of each view.
            Self::Views { views_a_side } => {
                let views = (views_a_side as usize).pow(2);
                draw_from_scratch(shot, &options, views * pixels * (colour + size_of::<f32>()), steps)
            }
        }
    }
}

/// Measures a renderer that keeps nothing between pictures.
fn draw_from_scratch(
    shot: Shot<'_>,
    options: &RenderOptions,
    bytes: usize,
    steps: &dyn Steps,
) -> Result<DrawnPicture, SessionError> {
    let drawn =
        measure_time(|| Ok::<_, SessionError>(render(shot.lit, shot.camera, shot.focus, options, steps)?))?;
    Ok(DrawnPicture {
        picture: drawn.value.picture,
        bake_seconds: None,
        picture_seconds: drawn.seconds,
        repeats: drawn.repeats,
        bytes,
        samples: None,
    })
}

/// Measures the splat: preparing the light field counts as baking, each further lens as a picture.
fn draw_splat(
    shot: Shot<'_>,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<DrawnPicture, SessionError> {
    let (baked, salf) = bake_light_field(shot, options, steps)?;
    let camera = &salf.camera;
    let prepared = measure_time(|| {
        let mut splatter = Splatter::new(salf.clone());
        splatter.set_tolerance(options.splat_tolerance);
        splatter.render(camera, shot.focus, &*steps.begin("splatting"))?;
        Ok(splatter)
    })?;
    let mut splatter = prepared.value;
    // A slightly different focus distance each time, so that data cached for a lens cannot be reused.
    let mut nudges = (1..).map(|k| 1.0 + 1e-9 * f64::from(k));
    let drawn = measure_time(|| {
        let focus_distance = camera.focus_distance * nudges.next().unwrap_or(1.0);
        splatter.refocus(&Camera { focus_distance, ..camera.clone() }, &*steps.begin("splatting"))?;
        Ok(splatter.picture().averaged(options.cells_a_side))
    })?;
    let first = (prepared.seconds - drawn.seconds).max(0.0);
    let bytes = salf.statistics().bytes + splatter.bytes().iter().sum::<usize>();
    Ok(drawn_from_light_field(&salf, baked + first, drawn, bytes))
}

/// Bakes the light field; returns the time taken, s.
fn bake_light_field(
    shot: Shot<'_>,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<(f64, Arc<Salf>), SessionError> {
    let baked =
        measure_time(|| Ok::<_, SessionError>(options.bake(shot.lit, shot.camera, shot.focus, steps)?))?;
    Ok((baked.seconds, Arc::new(baked.value)))
}

/// The result of a renderer that draws from a baked light field.
fn drawn_from_light_field(
    salf: &Salf,
    bake_seconds: f64,
    drawn: Timed<Picture>,
    bytes: usize,
) -> DrawnPicture {
    DrawnPicture {
        picture: drawn.value,
        bake_seconds: Some(bake_seconds),
        picture_seconds: drawn.seconds,
        repeats: drawn.repeats,
        bytes,
        samples: Some(salf.samples.len()),
    }
}
