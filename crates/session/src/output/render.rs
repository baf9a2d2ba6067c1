//! A picture without a window: what the command line and the export of the window do.

use super::aov::{Aov, Known};
use super::coc_convention::CocConvention;
use super::mattes::{BlackBackground, Mattes, OfLightField, OfTruth, Shown, WantedMattes};
use super::renderer::Renderer;
use crate::document::Input;
use crate::error::SessionError;
use crate::jobs::Steps;
use crate::light_field::{
    LightQuality, bake_with, is_photographed, light, light_for_many_points, photograph_light, serves,
};
use baselines::{BaselineError, FirstHits, LayeredOptions, ScatterOptions, ViewsOptions};
use focus::Focus;
use glam::DVec2;
use lens::{Camera, FocusOffset, Picture};
use project::{Cryptomatte, Layer};
use rayon::prelude::*;
use salf::{BakeOptions, Salf, SalfStatistics};
use scene::SurfacePoint;
use serde::Serialize;
use slf::PhotographLight;
use splat::{Gpu, Splatter, Tolerance};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;
use trace::truth::{Estimate, TruthOptions};
use trace::{Radiance, Ray, Tracer};

impl From<BaselineError> for SessionError {
    fn from(error: BaselineError) -> Self {
        match error {
            BaselineError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// How to render.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// What draws it.
    pub renderer: Renderer,
    /// How the ray tracer samples. Its region must be the frame.
    pub truth: TruthOptions,
    /// How coarse the light field may be, px (see [`BakeOptions::tolerance_px`]).
    pub tolerance_px: f64,
    /// How well its light is found; the ground truth's is whole paths.
    pub light: LightQuality,
    /// How coarse its splat may be.
    pub splat_tolerance: Tolerance,
    /// A light field that is to be baked is sampled on a grid of n × n cells a pixel, n from 1 to [`MOST_CELLS_A_SIDE`],
    /// and a pixel is the mean of what these give. What a tolerance of 0 leaves of the error is how far apart samples lie.
    pub cells_a_side: u32,
    /// The graphics card that the splat is summed on; none for the processor. The picture is the same.
    pub gpu: Option<Gpu>,
    /// How [`Renderer::Layers`] cuts the picture.
    pub layered: LayeredOptions,
    /// What [`Renderer::Views`] captures.
    pub views: ViewsOptions,
    /// What [`Renderer::Scatter`] throws.
    pub scatter: ScatterOptions,
    /// The pictures that come along.
    pub aovs: Vec<Aov>,
    /// How the circle of confusion is told among them.
    pub coc: CocConvention,
    /// How many pixels on each side of the camera's picture lie around the frame ([`Camera::overscanned`]): what is told as a share of
    /// the frame's height is one of the frame's.
    pub overscan: u32,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            renderer: Renderer::Splat,
            truth: TruthOptions { samples_per_pixel: 64, ..TruthOptions::default() },
            tolerance_px: BakeOptions::TOLERANCE_PX,
            light: LightQuality::Fine,
            splat_tolerance: Tolerance::NONE,
            cells_a_side: 1,
            gpu: None,
            layered: LayeredOptions::default(),
            views: ViewsOptions::default(),
            scatter: ScatterOptions::default(),
            aovs: Vec::new(),
            coc: CocConvention::default(),
            overscan: 0,
        }
    }
}

/// The most of [`RenderOptions::cells_a_side`].
pub const MOST_CELLS_A_SIDE: u32 = 4;

impl RenderOptions {
    /// A light field and splat as coarse as `px` pixels. At 0 they are as fine as they are meant to get, with nine cells a
    /// pixel.
    pub fn at_tolerance(px: f64) -> Self {
        Self {
            tolerance_px: px,
            splat_tolerance: Tolerance::px(px),
            cells_a_side: if px == 0.0 { 3 } else { 1 },
            ..Self::default()
        }
    }

    fn asks_for(&self, aov: Aov) -> bool {
        self.aovs.contains(&aov)
    }

    /// Whether the picture is multiplied by alpha: the background is black.
    pub(crate) fn is_premultiplied(&self) -> bool {
        self.asks_for(Aov::Alpha)
    }

    /// Of whom a pixel is, as far as the AOVs tell it.
    pub(crate) fn wanted_mattes(&self) -> Option<WantedMattes> {
        let crypto = self.asks_for(Aov::Crypto);
        (crypto || self.asks_for(Aov::Alpha)).then_some(WantedMattes { crypto })
    }

    /// Bakes the light field for `camera`: its own camera is as much finer as [`Self::cells_a_side`] says.
    pub fn bake(
        &self,
        tracer: &Arc<Tracer>,
        camera: &Camera,
        focus: &Focus,
        steps: &dyn Steps,
    ) -> Result<Salf, SessionError> {
        let needed = BakeOptions::for_focus(tracer, &self.finer(camera)?, focus);
        self.bake_as(tracer, camera, needed, steps)
    }

    /// The same for a margin, and light carried as finely, as `needed` says of the finer camera.
    pub(crate) fn bake_as(
        &self,
        tracer: &Arc<Tracer>,
        camera: &Camera,
        needed: BakeOptions,
        steps: &dyn Steps,
    ) -> Result<Salf, SessionError> {
        let tolerance_px = self.tolerance_px * f64::from(self.cells_a_side);
        bake_with(tracer, &self.finer(camera)?, &BakeOptions { tolerance_px, ..needed }, self.light, steps)
    }

    /// The camera whose light field is baked for `camera`.
    pub(crate) fn finer(&self, camera: &Camera) -> Result<Camera, SessionError> {
        let finer = camera.finer(self.cells_a_side);
        let tell = |error| {
            let n = self.cells_a_side;
            SessionError::BadInput(format!(
                "with {n} × {n} cells a pixel the {error} (take fewer, or a smaller picture)"
            ))
        };
        finer.validate().map_err(tell)?;
        Ok(finer)
    }
}

/// A rendered picture, what came along and what it cost.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture, radiance and coverage.
    pub picture: Picture,
    /// The layers of the AOVs, in the order in which they were asked for.
    pub layers: Vec<Layer>,
    /// What a file that holds the layers has to say of them, as attributes.
    pub attributes: BTreeMap<String, String>,
    /// What it cost.
    pub cost: RenderCost,
    /// What the picture lacks, a sentence each.
    pub warnings: Vec<String>,
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
    /// Whether the picture was summed on a graphics card.
    pub is_on_gpu: bool,
}

impl RenderCost {
    /// What is told of a light field; no time was spent yet.
    fn of(salf: &Salf) -> Self {
        let SalfStatistics { open, partial, background, bytes, .. } = salf.statistics();
        Self {
            open_samples: open,
            partial_samples: partial,
            background_samples: background,
            salf_bytes: bytes,
            margin_px: salf.margin_px,
            ..Self::default()
        }
    }
}

/// Renders a scene.
pub fn render(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let start = Instant::now();
    let mut cost = RenderCost::default();
    let (mut estimate, mut mattes) = (None, None);
    let picture = match options.renderer {
        Renderer::Splat | Renderer::Scatter => {
            let salf = Arc::new(options.bake(tracer, camera, focus, steps)?);
            let bake_seconds = start.elapsed().as_secs_f64();
            let drawn = draw_baked(&salf, tracer, camera, focus, options, steps)?;
            return Ok(Rendered { cost: RenderCost { bake_seconds, ..drawn.cost }, ..drawn });
        }
        Renderer::Truth => {
            let light = light_for_many_points(tracer, camera, &*steps.begin("light"))?;
            let premultiplied = BlackBackground(&*light);
            let radiance: &dyn Radiance = if options.asks_for(Aov::Alpha) { &premultiplied } else { &*light };
            let progress = steps.begin("tracing");
            let found = trace::truth::render(tracer, radiance, focus, camera, &options.truth, &*progress)?;
            if let Some(wanted) = options.wanted_mattes() {
                let truth = TruthOptions { surveys_light: false, ..options.truth };
                let source = OfTruth { tracer, radiance: &*light, focus, camera, options: truth };
                mattes = Some(Mattes::of(tracer.scene(), source, wanted, steps)?);
            }
            estimate.insert(found).picture.clone()
        }
        Renderer::Blur => {
            let hits = first_hits(tracer, camera, focus, options.light, steps)?;
            baselines::gather(&hits, camera, &*steps.begin("blurring"))?
        }
        Renderer::Layers => {
            let hits = first_hits(tracer, camera, focus, options.light, steps)?;
            baselines::layered(&hits, camera, &options.layered, &*steps.begin("blurring"))?
        }
        Renderer::Views => {
            let radiance = light(tracer, camera, options.light, &*steps.begin("light"))?;
            let progress = steps.begin("views");
            baselines::shift_and_add(tracer, &*radiance, focus, camera, &options.views, &*progress)?
        }
    };
    cost.picture_seconds = start.elapsed().as_secs_f64();
    let shot = Shot { tracer, camera, focus };
    finish(shot, options, Drawn { picture, estimate, mattes, cost }, steps)
}

/// Draws what [`RenderOptions::bake`] baked, for a camera that it serves.
pub(super) fn draw_baked(
    salf: &Arc<Salf>,
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let shot = Shot { tracer, camera, focus };
    let drawn = draw_light_field(salf.clone(), shot, options.cells_a_side, options, steps)?;
    finish(shot, options, drawn, steps)
}

/// Renders what was opened: a scene, a project, or (where the renderer draws one) a light field.
pub fn render_input(
    input: &Input,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let start = Instant::now();
    let tracer = tracer_of(input, camera)?;
    let prepare_seconds = start.elapsed().as_secs_f64();
    let mut rendered = match input.salf.as_ref().filter(|_| options.renderer.draws_light_field()) {
        None => render(&tracer, camera, focus, options, steps)?,
        Some(salf) => {
            if let Some(difference) = unlike(&salf.camera, camera) {
                let what = format!("it was baked {difference} (bake it again for this camera)");
                return Err(SessionError::bad(&input.path, what));
            }
            let mut rendered = sum_light_field(salf.clone(), &tracer, camera, focus, options, steps)?;
            let needed = BakeOptions::for_focus(&tracer, camera, focus).margin_px;
            if needed > salf.margin_px as f64 {
                rendered.warnings.push(format!(
                    "{}: paint spreads light from {needed:.0} px outside the frame, {} px were baked (bake it with --focus)",
                    input.path.display(),
                    salf.margin_px
                ));
            }
            rendered
        }
    };
    rendered.cost.prepare_seconds = prepare_seconds;
    Ok(rendered)
}

/// What answers the rays of a camera that can be used.
pub(crate) fn tracer_of(input: &Input, camera: &Camera) -> Result<Arc<Tracer>, SessionError> {
    camera.validate().map_err(|error| SessionError::bad(&input.path, error))?;
    let tracer = Arc::new(Tracer::new(input.scene.clone()));
    input.tell_atlas(&tracer)?;
    Ok(tracer)
}

/// What keeps a light field of `baked` from serving `camera`.
fn unlike(baked: &Camera, camera: &Camera) -> Option<String> {
    if serves(baked, camera) {
        return None;
    }
    Some(if (baked.width, baked.height) != (camera.width, camera.height) {
        format!("for {} × {} px, not {} × {}", baked.width, baked.height, camera.width, camera.height)
    } else if camera.aperture_radius > baked.aperture_radius {
        format!("for an aperture radius of {}, not {}", baked.aperture_radius, camera.aperture_radius)
    } else {
        "for another pose, angle of view, sensor or background".into()
    })
}

/// Renders a light field.
pub(crate) fn sum_light_field(
    salf: Arc<Salf>,
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let shot = Shot { tracer, camera, focus };
    finish(shot, options, draw_light_field(salf, shot, 1, options, steps)?, steps)
}

/// The picture of a light field of so many cells a pixel's side, what it shows, and what it cost.
fn draw_light_field(
    salf: Arc<Salf>,
    Shot { tracer, camera, focus }: Shot,
    cells_a_side: u32,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Drawn, SessionError> {
    let camera = &camera.finer(cells_a_side);
    let start = Instant::now();
    let mut mattes = None;
    let (picture, cost) = if options.renderer == Renderer::Scatter {
        let scattering = steps.begin("scattering");
        let picture = baselines::scatter(&salf, camera, focus, &options.scatter, &*scattering)?;
        (picture, RenderCost::of(&salf))
    } else {
        let scene = tracer.scene();
        let wanted = options.wanted_mattes().map(|wanted| (wanted, Shown::of(&salf, scene)));
        let mut splatter = splatter(salf, options);
        if let Some((_, shown)) = wanted.as_ref().filter(|_| options.asks_for(Aov::Alpha)) {
            splatter.blacken(|sample| shown.part(sample).is_none());
        }
        let cost = splatted(&mut splatter, camera, focus, steps)?;
        let picture = splatter.picture().clone();
        if let Some((wanted, shown)) = wanted {
            let source = OfLightField { mattes: splatter.into_mattes(), shown, cells_a_side };
            mattes = Some(Mattes::of(scene, source, wanted, steps)?);
        }
        (picture, cost)
    };
    let cost = RenderCost { picture_seconds: start.elapsed().as_secs_f64(), ..cost };
    Ok(Drawn { picture: picture.averaged(cells_a_side), estimate: None, mattes, cost })
}

/// What sums a light field.
pub(crate) fn splatter(salf: Arc<Salf>, options: &RenderOptions) -> Splatter {
    let mut splatter = Splatter::new(salf);
    splatter.set_tolerance(options.splat_tolerance);
    splatter.use_gpu(options.gpu.clone());
    splatter
}

/// Has a splatter draw; what it cost.
fn splatted(
    splatter: &mut Splatter,
    camera: &Camera,
    focus: &Focus,
    steps: &dyn Steps,
) -> Result<RenderCost, SessionError> {
    let start = Instant::now();
    splatter.render(camera, focus, &*steps.begin("splatting"))?;
    let (is_on_gpu, picture_seconds) = (splatter.gpu().is_some(), start.elapsed().as_secs_f64());
    Ok(RenderCost { is_on_gpu, picture_seconds, ..RenderCost::of(splatter.salf()) })
}

/// Sums what [`RenderOptions::bake`] baked, for a camera that it serves, as often as one likes.
pub(crate) fn sum_baked(
    splatter: &mut Splatter,
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let (shot, cells) = (Shot { tracer, camera, focus }, options.cells_a_side);
    if options.wanted_mattes().is_some() {
        // Of whom light is, is told by a sum of its own.
        let drawn = draw_light_field(splatter.salf().clone(), shot, cells, options, steps)?;
        return finish(shot, options, drawn, steps);
    }
    let cost = splatted(splatter, &camera.finer(cells), focus, steps)?;
    let picture = splatter.picture().averaged(cells);
    finish(shot, options, Drawn { picture, estimate: None, mattes: None, cost }, steps)
}

/// What is rendered.
#[derive(Clone, Copy)]
struct Shot<'a> {
    tracer: &'a Arc<Tracer>,
    camera: &'a Camera,
    focus: &'a Focus,
}

/// A picture, before what comes along.
struct Drawn {
    picture: Picture,
    /// What the ground truth knows of its error.
    estimate: Option<Estimate>,
    /// Of whom its pixels are, if that was asked for.
    mattes: Option<Mattes>,
    cost: RenderCost,
}

fn finish(
    Shot { tracer, camera, focus }: Shot,
    options: &RenderOptions,
    Drawn { picture, estimate, mattes, cost }: Drawn,
    steps: &dyn Steps,
) -> Result<Rendered, SessionError> {
    let asks = options.aovs.iter().any(|aov| aov.needs_first_hits());
    let hits = asks.then(|| first_hits(tracer, camera, focus, options.light, steps)).transpose()?;
    let is_captured = is_photographed(tracer) || tracer.scene().picture.is_some();
    let is_seen_asked = options.aovs.contains(&Aov::Seen) && is_captured;
    let seen = is_seen_asked.then(|| {
        let light = light_of_photographs(tracer, steps)?;
        Ok::<_, SessionError>(seen(tracer, camera, light.as_deref()))
    });
    let seen = seen.transpose()?;
    let asks_for_pinhole = options.asks_for(Aov::Pinhole) && options.renderer.tells_paths();
    let pinhole = asks_for_pinhole.then(|| pinhole(tracer, camera, options, steps)).transpose()?;
    let known = Known {
        picture: &picture,
        hits: hits.as_ref(),
        estimate: estimate.as_ref(),
        seen: seen.as_deref(),
        mattes: mattes.as_ref(),
        pinhole: pinhole.as_ref(),
        camera,
        coc: options.coc,
        overscan: options.overscan,
    };
    let layers = options.aovs.iter().flat_map(|aov| aov.layers(&known)).collect();
    let crypto = mattes.iter().flat_map(|mattes| &mattes.crypto);
    let mut attributes: BTreeMap<_, _> = crypto.flat_map(Cryptomatte::attributes).collect();
    if options.asks_for(Aov::CircleOfConfusion) {
        attributes.insert("focusBrush.cocConvention".into(), options.coc.name().into());
    }
    let warnings = mattes.map_or_else(Vec::new, |mattes| mattes.warnings);
    Ok(Rendered { picture, layers, attributes, cost, warnings })
}

/// What a pinhole sees, unpainted, by the same renderer; with its alpha where that is asked for.
fn pinhole(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<(Picture, Option<Layer>), SessionError> {
    let camera = Camera { aperture_radius: 0.0, ..camera.clone() };
    let unpainted = Focus::constant(tracer.scene().clone(), FocusOffset::STANDARD);
    let aovs = options.aovs.iter().copied().filter(|aov| *aov == Aov::Alpha).collect();
    let options = RenderOptions { aovs, ..options.clone() };
    let mut rendered = render(tracer, &camera, &unpainted, &options, steps)?;
    Ok((rendered.picture, rendered.layers.pop()))
}

/// The chief ray of a pixel's middle; pixels are numbered row by row.
pub(super) fn pixel_ray(camera: &Camera, number: u32) -> Ray {
    let pixel = DVec2::new(f64::from(number % camera.width), f64::from(number / camera.width));
    Ray::of_pinhole(camera, DVec2::ZERO, pixel + 0.5)
}

/// The light of a capture's photographs; none of a surface that was made from a picture, whose texture has it.
pub(crate) fn light_of_photographs(
    tracer: &Arc<Tracer>,
    steps: &dyn Steps,
) -> Result<Option<Arc<PhotographLight>>, SessionError> {
    if tracer.scene().picture.is_some() {
        return Ok(None);
    }
    let light = photograph_light(tracer, &*steps.begin("light"))?;
    if let Some(sentence) = told_moved(&light.moved_px()) {
        steps.tell(&sentence);
    }
    Ok(Some(light))
}

/// How many photographs were aligned, if any, and by how much.
fn told_moved(moved_px: &[f64]) -> Option<String> {
    let count = moved_px.iter().filter(|&&px| px > 0.0).count();
    let most = moved_px.iter().copied().fold(0.0, f64::max);
    let all = moved_px.len();
    (count > 0).then(|| {
        format!("{count} of {all} photographs are off, by up to {most:.1} px: aligned with the others")
    })
}

/// How far the surface along each pixel's chief ray was photographed, in the photographs of `light`, or else in the picture that it was
/// made from.
pub(super) fn seen(tracer: &Tracer, camera: &Camera, light: Option<&PhotographLight>) -> Vec<f32> {
    seen_in(tracer, camera, light, (0..camera.width * camera.height).collect())
}

/// The same in some pixels.
pub(crate) fn seen_in(
    tracer: &Tracer,
    camera: &Camera,
    light: Option<&PhotographLight>,
    pixels: Vec<u32>,
) -> Vec<f32> {
    let told = |point: SurfacePoint| match light {
        Some(light) => light.seen(point),
        None => tracer.scene().photographed(point).unwrap_or(0.0),
    };
    let of_pixel = |number: u32| {
        let hit = tracer.first_hit(&pixel_ray(camera, number));
        hit.map_or(0.0, |hit| told(hit.point))
    };
    pixels.into_par_iter().map(of_pixel).collect()
}

fn first_hits(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    focus: &Focus,
    quality: LightQuality,
    steps: &dyn Steps,
) -> Result<FirstHits, SessionError> {
    let light = light(tracer, camera, quality, &*steps.begin("light"))?;
    Ok(FirstHits::trace(tracer, &*light, focus, camera, &*steps.begin("first hits"))?)
}
