//! AOVs: extra channels for compositing and measuring.

use crate::mattes::Mattes;
use crate::picture::coc_convention::CocConvention;
use baselines::FirstHits;
use glam::DVec2;
use lens::{Camera, Exposure, FocusOffset, Picture};
use project::{Cryptomatte, Layer};
use trace::truth::Estimate;

/// An extra channel of a rendered picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// The picture of a scene of radiance 1. It is 1 without paint.
    Coverage,
    /// The share of the pixel's light paths that end on a surface, in [0, 1]. If requested, the picture is premultiplied by it: the
    /// background is black. Only the splat and the ground truth provide it; other renderers leave it out.
    Alpha,
    /// Cryptomatte of objects and materials, whose shares sum to alpha. Provided by the renderers that provide alpha.
    Crypto,
    /// The pinhole picture, to be blurred in compositing. Provided by the renderers that provide alpha, and premultiplied by its own
    /// alpha if alpha is requested too.
    Pinhole,
    /// The circle of confusion, by a [`CocConvention`]. As with `Depth`, `Focus` and `Seen`, the value is that of the first surface along
    /// the chief ray of the pixel's centre.
    CircleOfConfusion,
    /// Axial depth in scene units; infinite where there is no surface.
    Depth,
    /// The focus offset t and the anchor a; also gloss, if any surface has it.
    Focus,
    /// For captures: 1 where the surface was photographed, 0 where its light is filled in from neighbours or there is no surface. Left
    /// out for other scenes.
    Seen,
    /// The standard error of conserved radiance, luminance and coverage, and of their ratios. Only the ground truth provides it;
    /// other renderers leave it out.
    StandardError,
}

/// The inputs that layers are computed from.
pub(crate) struct LayerInputs<'a> {
    pub picture: &'a Picture,
    pub hits: Option<&'a FirstHits>,
    pub estimate: Option<&'a Estimate>,
    /// The values of [`Aov::Seen`].
    pub photographed: Option<&'a [f32]>,
    pub mattes: Option<&'a Mattes>,
    /// The pinhole picture, and its alpha if requested.
    pub pinhole: Option<&'a (Picture, Option<Layer>)>,
    pub camera: &'a Camera,
    pub coc: CocConvention,
    /// Extra pixels around the frame, on each side.
    pub overscan: u32,
}

impl Aov {
    /// All AOVs with their names on the command line.
    pub const ALL: [(&'static str, Aov); 9] = [
        ("alpha", Aov::Alpha),
        ("crypto", Aov::Crypto),
        ("pinhole", Aov::Pinhole),
        ("coverage", Aov::Coverage),
        ("coc", Aov::CircleOfConfusion),
        ("depth", Aov::Depth),
        ("t", Aov::Focus),
        ("seen", Aov::Seen),
        ("stderr", Aov::StandardError),
    ];

    /// The AOV's entry, with its name, in [`Self::ALL`]; `None` if it has none.
    pub fn entry(&self) -> Option<(&'static str, Aov)> {
        Self::ALL.into_iter().find(|(_, aov)| aov == self)
    }

    /// The AOV with this name on the command line; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(entry_name, _)| *entry_name == name).map(|(_, aov)| *aov)
    }

    /// Whether it is computed from first hits.
    pub(crate) fn needs_first_hits(self) -> bool {
        matches!(self, Self::CircleOfConfusion | Self::Depth | Self::Focus)
    }

    /// Whether it depends on where light paths end, which only some renderers can determine ([`Renderer::resolves_paths`]).
    ///
    /// [`Renderer::resolves_paths`]: crate::Renderer::resolves_paths
    pub fn needs_paths(self) -> bool {
        matches!(self, Self::Alpha | Self::Crypto | Self::Pinhole)
    }

    /// Its layers; empty if their inputs are missing.
    pub(crate) fn layers(self, inputs: &LayerInputs) -> Vec<Layer> {
        let layer = |name: &str, values| Layer { name: name.into(), values };
        match (self, inputs.hits, inputs.estimate) {
            (Self::Coverage, ..) => {
                let mut coverage = Layer::coverage(inputs.picture);
                if let Some(falloff) = inputs.camera.falloff() {
                    // A picture's coverage is over the falloff.
                    let width = inputs.camera.width as usize;
                    for (k, value) in coverage.values.iter_mut().enumerate() {
                        let pixel = DVec2::new((k % width) as f64, (k / width) as f64) + 0.5;
                        *value *= falloff.at(inputs.camera.q_from_pixel(pixel));
                    }
                }
                vec![coverage]
            }
            (Self::CircleOfConfusion, Some(hits), _) => {
                let frame_height = inputs.camera.height.saturating_sub(2 * inputs.overscan);
                let diameters = hits.circle_of_confusion_px(inputs.camera).into_iter();
                vec![layer("coc", diameters.map(|d| inputs.coc.encode(d, frame_height)).collect())]
            }
            (Self::Alpha, ..) => {
                let alpha = inputs.mattes.map(|mattes| layer(Layer::ALPHA, mattes.alpha.clone()));
                alpha.into_iter().collect()
            }
            (Self::Crypto, ..) => inputs
                .mattes
                .into_iter()
                .flat_map(|mattes| &mattes.crypto)
                .flat_map(Cryptomatte::layers)
                .collect(),
            (Self::Pinhole, ..) => inputs.pinhole.map_or_else(Vec::new, |(picture, alpha)| {
                let colors = Layer::from_colors(Layer::PINHOLE, &picture.exposed(Exposure::Normalise));
                let alpha =
                    alpha.iter().map(|alpha| layer(&format!("{}.A", Layer::PINHOLE), alpha.values.clone()));
                colors.into_iter().chain(alpha).collect()
            }),
            (Self::Seen, ..) => inputs
                .photographed
                .map(|photographed| layer("seen", photographed.to_vec()))
                .into_iter()
                .collect(),
            (Self::Depth, Some(hits), _) => vec![layer("depth.Z", hits.depth.clone())],
            (Self::Focus, Some(hits), _) => {
                let layer_of = |name: &str, number: fn(&FocusOffset) -> f64| {
                    layer(name, hits.focus.iter().map(|focus| number(focus) as f32).collect())
                };
                let has_gloss = hits.focus.iter().any(|focus| focus.gloss != 0.0);
                let gloss = has_gloss.then(|| layer_of("gloss", |focus| focus.gloss));
                [layer_of("t", |focus| focus.t), layer_of("anchor", |focus| focus.anchor)]
                    .into_iter()
                    .chain(gloss)
                    .collect()
            }
            (Self::StandardError, _, Some(estimate)) => {
                let rgb = |group: &str, errors: &[[f32; 3]]| {
                    ["R", "G", "B"]
                        .into_iter()
                        .enumerate()
                        .map(|(c, channel)| {
                            layer(&format!("{group}.{channel}"), errors.iter().map(|rgb| rgb[c]).collect())
                        })
                        .collect::<Vec<_>>()
                };
                let mut layers = rgb("stderr", &estimate.standard_error.radiance);
                layers.push(layer("stderr.Y", estimate.luminance_error.clone()));
                layers.push(layer("stderr.coverage", estimate.standard_error.coverage.clone()));
                layers.extend(rgb("stderr.normalised", &estimate.normalised_error));
                layers.push(layer("stderr.normalised.Y", estimate.normalised_luminance_error.clone()));
                layers
            }
            _ => Vec::new(),
        }
    }
}
