//! A picture without a window: what the command line and the export of the window do.

use crate::depth_blur::depth_blur;
use crate::first_hits::FirstHits;
use crate::{Aov, SessionError, Steps};
use focus::Focus;
use glam::DVec3;
use lens::{Camera, Picture};
use project::Layer;
use salf::{BakeOptions, Salf, SalfStatistics};
use serde::Serialize;
use slf::DirectLight;
use splat::Splatter;
use std::sync::Arc;
use std::time::Instant;
use trace::Tracer;
use trace::truth::TruthOptions;

/// What draws the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Renderer {
    /// The light field, splatted.
    #[default]
    Splat,
    /// Distributed ray tracing.
    Truth,
    /// A blur of the pinhole picture by depth: the baseline.
    Blur,
}

/// How to render.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// What draws it.
    pub renderer: Renderer,
    /// Rays a pixel of the ray tracer.
    pub samples_per_pixel: u32,
    /// Seed of the ray tracer's scramble.
    pub seed: u32,
    /// The pictures that come along.
    pub aovs: Vec<Aov>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self { renderer: Renderer::Splat, samples_per_pixel: 64, seed: 0, aovs: Vec::new() }
    }
}

/// A rendered picture, what came along and what it cost.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture, radiance and coverage.
    pub picture: Picture,
    /// The layers of the AOVs, in the order in which they were asked for.
    pub layers: Vec<Layer>,
    /// What it cost.
    pub cost: RenderCost,
}

/// What a picture cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RenderCost {
    /// Seconds for the hierarchy over the triangles.
    pub prepare_seconds: f64,
    /// Seconds for the light field.
    pub bake_seconds: f64,
    /// Seconds for the picture itself.
    pub picture_seconds: f64,
    /// Samples that see the whole aperture.
    pub open_samples: usize,
    /// Samples that see part of it.
    pub partial_samples: usize,
    /// Samples of the background, which are among the others.
    pub background_samples: usize,
    /// Bytes of all samples.
    pub salf_bytes: usize,
    /// How far outside the frame was sampled, px.
    pub margin_px: u32,
}

impl RenderCost {
    fn count(&mut self, salf: &Salf) {
        let SalfStatistics { open, partial, background, bytes, .. } = salf.statistics();
        (self.open_samples, self.partial_samples) = (open, partial);
        (self.background_samples, self.salf_bytes) = (background, bytes);
        self.margin_px = salf.margin_px;
    }
}

/// The light that leaves the scene in `tracer`, for a camera.
pub(crate) fn light(tracer: &Arc<Tracer>, camera: &Camera) -> DirectLight {
    DirectLight::new(tracer.clone(), DVec3::from_array(camera.background).as_vec3())
}

/// Bakes the light field that `camera` needs to show `focus`.
pub fn bake(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    steps: &dyn Steps,
) -> Result<Salf, SessionError> {
    let options = BakeOptions::for_focus(tracer, camera, focus);
    Ok(salf::bake(tracer, &light(tracer, camera), camera, &options, &*steps.begin("baking"))?)
}

/// Renders a scene.
pub fn render(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let mut cost = RenderCost::default();
    let start = Instant::now();
    let picture = match options.renderer {
        Renderer::Splat => {
            let salf = bake(tracer, camera, focus, steps)?;
            cost.bake_seconds = start.elapsed().as_secs_f64();
            return render_salf(Arc::new(salf), Some(tracer), camera, focus, options, cost, steps);
        }
        Renderer::Truth => {
            let samples_per_pixel = options.samples_per_pixel;
            let truth = TruthOptions { samples_per_pixel, seed: options.seed };
            let progress = steps.begin("tracing");
            trace::truth::render(tracer, &light(tracer, camera), focus, camera, &truth, &*progress)?
        }
        Renderer::Blur => {
            let hits = first_hits(tracer, camera, focus, steps)?;
            let picture = depth_blur(&hits, camera, &*steps.begin("blurring"))?;
            cost.picture_seconds = start.elapsed().as_secs_f64();
            let layers = layers(&options.aovs, &picture, Some(&hits), camera);
            return Ok(Rendered { picture, layers, cost });
        }
    };
    cost.picture_seconds = start.elapsed().as_secs_f64();
    finish(picture, Some(tracer), camera, focus, options, cost, steps)
}

/// Renders a light field. Without a tracer, only the AOV of coverage can come along.
pub fn render_salf(
    salf: Arc<Salf>,
    tracer: Option<&Arc<Tracer>>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    mut cost: RenderCost,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    cost.count(&salf);
    let start = Instant::now();
    let mut splatter = Splatter::new(salf);
    splatter.render(camera, focus, &*steps.begin("splatting"))?;
    let picture = splatter.picture().clone();
    cost.picture_seconds = start.elapsed().as_secs_f64();
    finish(picture, tracer, camera, focus, options, cost, steps)
}

fn finish(
    picture: Picture,
    tracer: Option<&Arc<Tracer>>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    cost: RenderCost,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let hits = match tracer {
        Some(tracer) if options.aovs.iter().any(|aov| aov.needs_first_hits()) => {
            Some(first_hits(tracer, camera, focus, steps)?)
        }
        _ => None,
    };
    let layers = layers(&options.aovs, &picture, hits.as_ref(), camera);
    Ok(Rendered { picture, layers, cost })
}

fn layers(aovs: &[Aov], picture: &Picture, hits: Option<&FirstHits>, camera: &Camera) -> Vec<Layer> {
    aovs.iter().flat_map(|aov| aov.layers(picture, hits, camera)).collect()
}

fn first_hits(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    steps: &dyn Steps,
) -> Result<FirstHits, SessionError> {
    Ok(FirstHits::trace(tracer, &light(tracer, camera), focus, camera, &*steps.begin("first hits"))?)
}
