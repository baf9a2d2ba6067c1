//! Rendering a picture without a window, for the command line and the window's export.

use crate::bake::bake_with;
use crate::error::RenderError;
use crate::mattes::{BlackBackground, LightFieldMattes, MatteRequest, Mattes, SampleParts, TruthMattes};
use crate::picture::aov::{Aov, LayerInputs};
use crate::picture::coc_convention::CocConvention;
use crate::picture::photographed::{light_of_photographs, photographed_shares};
use crate::picture::renderer::Renderer;
use crate::picture::splat_truth::{Dilation, SplatTruth};
use baselines::{BaselineError, FirstHits, LayeredOptions, ScatterOptions, ViewsOptions};
use focus::Focus;
use graphics_card::Gpu;
use lens::{Camera, Character, FocusOffset, Picture};
use light::{LightQuality, LitScene, Steps};
use progress::{Cancelled, Progress};
use project::{Cryptomatte, Layer};
use salf::{BakeOptions, BakedOn, Salf, SalfStatistics};
use serde::Serialize;
use slf::MAX_BOUNCES;
use splat::{Splatter, Tolerance};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;
use trace::truth::{Estimate, TruthOptions};
use trace::{Radiance, Tracer};

impl From<BaselineError> for RenderError {
    fn from(error: BaselineError) -> Self {
        match error {
            BaselineError::Cancelled => Self::Cancelled,
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// How to render. The `Debug` form is hashed into plans: names must not change.
///
/// ```
/// let options = render::RenderOptions::at_tolerance(0.0);
/// assert_eq!(options.cells_a_side, 3);
/// ```
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// The renderer.
    pub renderer: Renderer,
    /// Sampling of the ground truth. Its region must be the frame.
    pub truth: TruthOptions,
    /// Tolerance of the light field, px (see [`BakeOptions::tolerance_px`]).
    pub tolerance_px: f64,
    /// Quality of the light. Does not apply to the ground truth, which traces whole paths.
    pub light: LightQuality,
    /// Tolerance of the splat.
    pub splat_tolerance: Tolerance,
    /// Cells per side of a pixel, from 1 to [`MAX_CELLS_A_SIDE`]: light fields are baked on a grid of n × n cells per pixel, and a pixel
    /// is their mean. At a tolerance of 0 the spacing of samples is the remaining source of error.
    pub cells_a_side: u32,
    /// The graphics card to sum the splat on; `None` for the processor. The picture is the same.
    pub gpu: Option<Gpu>,
    /// The graphics card to bake the light field on; `None` for the processor. The picture is the same to the precision of its floats.
    pub bake_on: Option<Gpu>,
    /// Options of [`Renderer::Layers`].
    pub layered: LayeredOptions,
    /// Options of [`Renderer::Views`].
    pub views: ViewsOptions,
    /// How far [`Renderer::Dilation`] makes splats grow: the standard deviation, in radii of the circle of confusion, > 0. A disc has ½,
    /// Spark takes 1, splat-transform 2.
    pub dilation_sigma_radii: f64,
    /// Options of [`Renderer::Scatter`].
    pub scatter: ScatterOptions,
    /// The AOVs to render.
    pub aovs: Vec<Aov>,
    /// Convention of [`Aov::CircleOfConfusion`].
    pub coc: CocConvention,
    /// Pixels of overscan that the camera includes on each side ([`Camera::overscanned`]). Values relative to the frame's height exclude
    /// them.
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
            bake_on: None,
            layered: LayeredOptions::default(),
            views: ViewsOptions::default(),
            dilation_sigma_radii: 1.0,
            scatter: ScatterOptions::default(),
            aovs: Vec::new(),
            coc: CocConvention::default(),
            overscan: 0,
        }
    }
}

/// Maximum of [`RenderOptions::cells_a_side`].
pub const MAX_CELLS_A_SIDE: u32 = 4;

impl RenderOptions {
    /// Options for a light field and splat with a tolerance of `px` pixels. At 0 they are as fine as possible, with nine cells per
    /// pixel.
    pub fn at_tolerance(px: f64) -> Self {
        Self {
            tolerance_px: px,
            splat_tolerance: Tolerance::px(px),
            cells_a_side: if px == 0.0 { 3 } else { 1 },
            ..Self::default()
        }
    }

    fn has_aov(&self, aov: Aov) -> bool {
        self.aovs.contains(&aov)
    }

    /// Whether the picture is multiplied by alpha: the background is black.
    pub(crate) fn is_premultiplied(&self) -> bool {
        self.has_aov(Aov::Alpha)
    }

    /// The mattes that the AOVs need.
    pub(crate) fn matte_request(&self) -> Option<MatteRequest> {
        let crypto = self.has_aov(Aov::Crypto);
        (crypto || self.has_aov(Aov::Alpha)).then_some(MatteRequest { crypto })
    }

    /// Bakes the light field for `camera`. Its own camera is finer by [`Self::cells_a_side`].
    ///
    /// # Errors
    /// The finer camera is invalid, the light cannot be solved, or the work was cancelled.
    pub fn bake(
        &self,
        lit: &Arc<LitScene>,
        camera: &Camera,
        focus: &Focus,
        steps: &dyn Steps,
    ) -> Result<Salf, RenderError> {
        let needed = BakeOptions::for_focus(lit.tracer(), &self.finer(camera)?, focus);
        self.bake_as(lit, camera, needed, steps)
    }

    /// Renders a light field for a compatible `camera`, one sample grid cell per pixel.
    ///
    /// # Errors
    /// As [`render`].
    pub fn sum_light_field(
        &self,
        salf: Arc<Salf>,
        lit: &Arc<LitScene>,
        camera: &Camera,
        focus: &Focus,
        steps: &dyn Steps,
    ) -> Result<Rendered, RenderError> {
        let shot = Shot { lit, camera, focus };
        finish(shot, self, draw_light_field(salf, shot, 1, self, steps)?, steps)
    }

    /// [`Self::bake`] with the margin and carried light that `needed` gives for the finer camera.
    pub(crate) fn bake_as(
        &self,
        lit: &Arc<LitScene>,
        camera: &Camera,
        needed: BakeOptions,
        steps: &dyn Steps,
    ) -> Result<Salf, RenderError> {
        let tolerance_px = self.tolerance_px * f64::from(self.cells_a_side);
        let bake = BakeOptions { tolerance_px, pixel_px: f64::from(self.cells_a_side), ..needed };
        bake_with(lit, &self.finer(camera)?, &bake, self.light, self.bake_on.as_ref(), steps)
    }

    /// The camera of the light field that is baked for `camera`.
    pub(crate) fn finer(&self, camera: &Camera) -> Result<Camera, RenderError> {
        let finer = camera.finer(self.cells_a_side);
        let describe = |error| {
            let n = self.cells_a_side;
            RenderError::BadInput(format!(
                "with {n} × {n} cells per pixel the {error} (use fewer cells, or a smaller picture)"
            ))
        };
        finer.validate().map_err(describe)?;
        Ok(finer)
    }
}

/// A rendered picture with its layers and cost.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture, radiance and coverage.
    pub picture: Picture,
    /// The layers of the AOVs, in the requested order.
    pub layers: Vec<Layer>,
    /// Metadata of the layers, for the file's attributes.
    pub attributes: BTreeMap<String, String>,
    /// Time and memory that it took.
    pub cost: RenderCost,
    /// What the picture lacks, one sentence each.
    pub warnings: Vec<String>,
}

/// Time and memory that a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RenderCost {
    /// Time for building the ray tree, s.
    pub prepare_seconds: f64,
    /// Time for the light field, s.
    pub bake_seconds: f64,
    /// Time for the picture itself, s.
    pub picture_seconds: f64,
    /// Samples from which the whole aperture is visible.
    pub open_samples: usize,
    /// Samples from which part of the aperture is visible.
    pub partial_samples: usize,
    /// Samples of the background, included in the other counts.
    pub background_samples: usize,
    /// Bytes of all samples.
    pub salf_bytes: usize,
    /// Width of the baked margin around the frame, px.
    pub margin_px: u32,
    /// What the light field was baked on.
    pub baked_on: BakedOn,
    /// Whether the picture was summed on a graphics card.
    pub is_on_gpu: bool,
}

impl RenderCost {
    /// The counts of a light field, with all times 0.
    fn from_salf(salf: &Salf) -> Self {
        let SalfStatistics { open, partial, background, bytes, .. } = salf.statistics();
        Self {
            baked_on: salf.baked_on,
            open_samples: open,
            partial_samples: partial,
            background_samples: background,
            salf_bytes: bytes,
            margin_px: salf.margin_px,
            ..Self::default()
        }
    }
}

/// Renders a scene; bakes a light field if the renderer needs one.
///
/// # Errors
/// The options do not fit the camera, the light cannot be solved, the sums overflow, or the work was cancelled.
pub fn render(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let start = Instant::now();
    let mut cost = RenderCost::default();
    let (mut estimate, mut mattes) = (None, None);
    let picture = match options.renderer {
        Renderer::Splat | Renderer::Scatter => {
            let salf = Arc::new(options.bake(lit, camera, focus, steps)?);
            let bake_seconds = start.elapsed().as_secs_f64();
            let drawn = draw_baked(&salf, lit, camera, focus, options, steps)?;
            return Ok(Rendered { cost: RenderCost { bake_seconds, ..drawn.cost }, ..drawn });
        }
        Renderer::Truth => {
            let light = lit.ground_truth(camera, &*steps.begin("light"))?;
            let premultiplied = BlackBackground(&*light);
            let radiance: &dyn Radiance = if options.has_aov(Aov::Alpha) { &premultiplied } else { &*light };
            if let Some(splats) = &lit.scene().splats {
                let truth = SplatTruth {
                    samples_per_pixel: options.truth.samples_per_pixel,
                    ..SplatTruth::new(lit.tracer(), splats, radiance, focus, camera)
                };
                let picture = truth.render(&*steps.begin("tracing"))?.picture;
                if let Some(request) = options.matte_request() {
                    mattes = Some(Mattes::render(lit.scene(), truth, request, steps)?);
                }
                cost.picture_seconds = start.elapsed().as_secs_f64();
                let shot = Shot { lit, camera, focus };
                return finish(shot, options, Drawn { picture, estimate, mattes, cost }, steps);
            }
            let progress = steps.begin("tracing");
            let traced =
                trace::truth::render(lit.tracer(), radiance, focus, camera, &options.truth, &*progress)?;
            if let Some(request) = options.matte_request() {
                let truth = TruthOptions { surveys_light: false, ..options.truth };
                let source =
                    TruthMattes { tracer: lit.tracer(), radiance: &*light, focus, camera, options: truth };
                mattes = Some(Mattes::render(lit.scene(), source, request, steps)?);
            }
            estimate.insert(traced).picture.clone()
        }
        Renderer::Blur => {
            let hits = first_hits(lit, camera, focus, options.light, steps)?;
            baselines::gather_blur(&hits, camera, &*steps.begin("blurring"))?
        }
        Renderer::Layers => {
            let hits = first_hits(lit, camera, focus, options.light, steps)?;
            baselines::layered_blur(&hits, camera, &options.layered, &*steps.begin("blurring"))?
        }
        Renderer::Dilation => {
            let Some(splats) = &lit.scene().splats else {
                let what = "the dilation renderer draws Gaussian splats, but the scene has none (use splat or truth)";
                return Err(RenderError::BadInput(what.into()));
            };
            let light = lit.solve(camera, options.light, &*steps.begin("light"))?;
            let pinhole = without_aperture(camera);
            let dilated = SplatTruth {
                dilation: Some(Dilation { lens: camera, sigma_radii: options.dilation_sigma_radii }),
                ..SplatTruth::new(lit.tracer(), splats, &*light, focus, &pinhole)
            };
            dilated.render(&*steps.begin("dilating"))?.picture
        }
        Renderer::Views if lit.tracer().has_splats() => {
            let what = "the views renderer does not draw Gaussian splats (use splat, truth, blur or layers)";
            return Err(RenderError::BadInput(what.into()));
        }
        Renderer::Views => {
            let radiance = lit.solve(camera, options.light, &*steps.begin("light"))?;
            let progress = steps.begin("views");
            baselines::shift_and_add(lit.tracer(), &*radiance, focus, camera, &options.views, &*progress)?
        }
    };
    cost.picture_seconds = start.elapsed().as_secs_f64();
    let shot = Shot { lit, camera, focus };
    finish(shot, options, Drawn { picture, estimate, mattes, cost }, steps)
}

/// Draws a light field from [`RenderOptions::bake`] for a compatible camera.
pub(crate) fn draw_baked(
    salf: &Arc<Salf>,
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let shot = Shot { lit, camera, focus };
    let drawn = draw_light_field(salf.clone(), shot, options.cells_a_side, options, steps)?;
    finish(shot, options, drawn, steps)
}

/// Draws a light field with `cells_a_side` cells per side of a pixel.
fn draw_light_field(
    salf: Arc<Salf>,
    Shot { lit, camera, focus }: Shot,
    cells_a_side: u32,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Drawn, RenderError> {
    let camera = &camera.finer(cells_a_side);
    let start = Instant::now();
    let mut mattes = None;
    let (picture, cost) = if options.renderer == Renderer::Scatter {
        let scattering = steps.begin("scattering");
        let picture = baselines::scatter_rays(&salf, camera, focus, &options.scatter, &*scattering)?;
        (picture, RenderCost::from_salf(&salf))
    } else {
        let scene = lit.scene();
        let matte_request = options.matte_request().map(|request| (request, SampleParts::new(&salf, scene)));
        let mut splatter = new_splatter(salf, options);
        if let Some((_, sample_parts)) = matte_request.as_ref().filter(|_| options.has_aov(Aov::Alpha)) {
            splatter.blacken(|sample| sample_parts.part(sample).is_none());
        }
        let cost = run_splatter(&mut splatter, camera, focus, steps)?;
        let picture = splatter.picture().clone();
        if let Some((request, sample_parts)) = matte_request {
            let source = LightFieldMattes { mattes: splatter.into_mattes(), sample_parts, cells_a_side };
            mattes = Some(Mattes::render(scene, source, request, steps)?);
        }
        (picture, cost)
    };
    let cost = RenderCost { picture_seconds: start.elapsed().as_secs_f64(), ..cost };
    Ok(Drawn { picture: picture.averaged(cells_a_side), estimate: None, mattes, cost })
}

/// A splatter for a light field, configured by the options.
pub(crate) fn new_splatter(salf: Arc<Salf>, options: &RenderOptions) -> Splatter {
    let mut splatter = Splatter::new(salf);
    splatter.set_tolerance(options.splat_tolerance);
    splatter.use_gpu(options.gpu.clone());
    splatter
}

/// Runs a splatter. Returns the cost.
fn run_splatter(
    splatter: &mut Splatter,
    camera: &Camera,
    focus: &Focus,
    steps: &dyn Steps,
) -> Result<RenderCost, RenderError> {
    let start = Instant::now();
    splatter.render(camera, focus, &*steps.begin("splatting"))?;
    let (is_on_gpu, picture_seconds) = (splatter.gpu().is_some(), start.elapsed().as_secs_f64());
    Ok(RenderCost { is_on_gpu, picture_seconds, ..RenderCost::from_salf(splatter.salf()) })
}

/// Sums a light field from [`RenderOptions::bake`] for a compatible camera. The splatter can be reused.
pub(crate) fn sum_baked(
    splatter: &mut Splatter,
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let (shot, cells) = (Shot { lit, camera, focus }, options.cells_a_side);
    if options.matte_request().is_some() {
        // Mattes need their own sums.
        let drawn = draw_light_field(splatter.salf().clone(), shot, cells, options, steps)?;
        return finish(shot, options, drawn, steps);
    }
    let cost = run_splatter(splatter, &camera.finer(cells), focus, steps)?;
    let picture = splatter.picture().averaged(cells);
    finish(shot, options, Drawn { picture, estimate: None, mattes: None, cost }, steps)
}

/// The subject of a picture.
#[derive(Clone, Copy)]
struct Shot<'a> {
    lit: &'a Arc<LitScene>,
    camera: &'a Camera,
    focus: &'a Focus,
}

/// A picture before its layers are made.
struct Drawn {
    picture: Picture,
    /// The ground truth's estimate, with its errors.
    estimate: Option<Estimate>,
    /// Its mattes, if requested.
    mattes: Option<Mattes>,
    cost: RenderCost,
}

fn finish(
    Shot { lit, camera, focus }: Shot,
    options: &RenderOptions,
    Drawn { picture, estimate, mattes, cost }: Drawn,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let needs_hits = options.aovs.iter().any(|aov| aov.needs_first_hits());
    let hits = needs_hits.then(|| first_hits(lit, camera, focus, options.light, steps)).transpose()?;
    let is_captured = lit.is_photographed() || lit.scene().picture.is_some();
    let needs_photographed = options.aovs.contains(&Aov::Seen) && is_captured;
    let photographed = needs_photographed.then(|| {
        let light = light_of_photographs(lit, steps)?;
        Ok::<_, RenderError>(photographed_shares(lit.tracer(), camera, light.as_deref()))
    });
    let photographed = photographed.transpose()?;
    let needs_pinhole = options.has_aov(Aov::Pinhole) && options.renderer.resolves_paths();
    let pinhole = needs_pinhole.then(|| render_pinhole(lit, camera, options, steps)).transpose()?;
    let inputs = LayerInputs {
        picture: &picture,
        hits: hits.as_ref(),
        estimate: estimate.as_ref(),
        photographed: photographed.as_deref(),
        mattes: mattes.as_ref(),
        pinhole: pinhole.as_ref(),
        camera,
        coc: options.coc,
        overscan: options.overscan,
    };
    let layers = options.aovs.iter().flat_map(|aov| aov.layers(&inputs)).collect();
    let crypto = mattes.iter().flat_map(|mattes| &mattes.crypto);
    let mut attributes: BTreeMap<_, _> = crypto.flat_map(Cryptomatte::attributes).collect();
    if options.has_aov(Aov::CircleOfConfusion) {
        attributes.insert("focusBrush.cocConvention".into(), options.coc.name().into());
    }
    let mut warnings = mattes.map_or_else(Vec::new, |mattes| mattes.warnings);
    warnings.extend(cut_off_warning(lit));
    warnings.extend(character_warning(camera, options));
    Ok(Rendered { picture, layers, attributes, cost, warnings })
}

/// A warning if the renderer draws the plain lens in place of one with a character, or the processor in place of the card.
fn character_warning(camera: &Camera, options: &RenderOptions) -> Option<String> {
    if camera.character.is_neutral() {
        return None;
    }
    match options.renderer {
        Renderer::Splat => options.gpu.is_some().then(|| {
            "pictures of a lens with a character are summed on the processor, not on the GPU".to_string()
        }),
        Renderer::Truth => None,
        Renderer::Blur | Renderer::Layers | Renderer::Views | Renderer::Dilation | Renderer::Scatter => Some(
            "this renderer draws the plain lens, without its character (use the renderers splat or truth)"
                .to_string(),
        ),
    }
}

/// A warning if light was cut off before it had died away.
pub(crate) fn cut_off_warning(lit: &LitScene) -> Option<String> {
    lit.is_cut_off().then(|| {
        format!(
            "light was cut off after {MAX_BOUNCES} bounces: it cannot get out of a closed white room (use an albedo below 1, or `bounces` in the world)"
        )
    })
}

/// The unpainted pinhole picture by the same renderer, with its alpha if requested.
fn render_pinhole(
    lit: &Arc<LitScene>,
    camera: &Camera,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<(Picture, Option<Layer>), RenderError> {
    let camera = Camera { aperture_radius: 0.0, character: Character::default(), ..camera.clone() };
    let unpainted = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
    let aovs = options.aovs.iter().copied().filter(|aov| *aov == Aov::Alpha).collect();
    let options = RenderOptions { aovs, ..options.clone() };
    let mut rendered = render(lit, &camera, &unpainted, &options, steps)?;
    Ok((rendered.picture, rendered.layers.pop()))
}

fn without_aperture(camera: &Camera) -> Camera {
    Camera { aperture_radius: 0.0, ..camera.clone() }
}

fn first_hits(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    quality: LightQuality,
    steps: &dyn Steps,
) -> Result<FirstHits, RenderError> {
    let light = lit.solve(camera, quality, &*steps.begin("light"))?;
    let mut hits = FirstHits::trace(lit.tracer(), &*light, focus, camera, &*steps.begin("first hits"))?;
    if let Some(radiance) = sharp_splats(lit.tracer(), &*light, focus, camera, &*steps.begin("pinhole"))? {
        hits.radiance = radiance;
    }
    Ok(hits)
}

/// The radiance of each pixel of a scene with Gaussian splats without blur, for first hits: what a ray through splats brings is no light of
/// one surface. `None` for scenes without.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn sharp_splats(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    focus: &Focus,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<Option<Vec<[f32; 3]>>, Cancelled> {
    let Some(splats) = &tracer.scene().splats else { return Ok(None) };
    let pinhole = without_aperture(camera);
    let truth = SplatTruth::new(tracer, splats, radiance, focus, &pinhole);
    Ok(Some(truth.render(progress)?.picture.radiance))
}
