//! What colour each texel of a surface has, for edges: base colour and emission, or what its photographs show.

use atlas::TexelMap;
use focus::Canvas;
use glam::Vec3;
use numerics::{luminance, quantile, srgb_from_linear};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};
use slf::PhotographLight;

/// Photographed light is scaled so that this share of the texels is no brighter than white.
const WHITE_SHARE: f64 = 0.98;

/// The colour of each texel, in the canvas's order, encoded by sRGB's curve: equal differences look equal.
pub(crate) fn surface_colors(
    scene: &Scene,
    texels: &TexelMap,
    canvas: &Canvas,
    light: Option<&PhotographLight>,
) -> Vec<[f32; 3]> {
    let linear_color = |point: SurfacePoint| match light {
        Some(light) => light.constant(point),
        None if scene.material_of(point.triangle).unlit => scene.base_color(point).truncate(),
        None => scene.base_color(point).truncate() + scene.emitted_radiance(point),
    };
    let at = |index: usize| {
        let texel = canvas.texel(index);
        texels.texel_at(texel.x, texel.y).map_or(Vec3::ZERO, |texel| linear_color(texel.centroid))
    };
    let linear: Vec<Vec3> = (0..canvas.texels().len()).into_par_iter().map(at).collect();
    let white = light.map_or(1.0, |_| white_level(&linear));
    let encode =
        |color: &Vec3| (*color / white).clamp(Vec3::ZERO, Vec3::ONE).to_array().map(srgb_from_linear);
    linear.par_iter().map(encode).collect()
}

/// The luminance that counts as white; 1 where all is black.
fn white_level(linear: &[Vec3]) -> f32 {
    let mut levels: Vec<f32> = linear.iter().map(|color| luminance(color.to_array())).collect();
    quantile(&mut levels, WHITE_SHARE).filter(|level| *level > 0.0 && level.is_finite()).unwrap_or(1.0)
}
