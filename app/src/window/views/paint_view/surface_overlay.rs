//! A texture over the whole atlas that is shown instead of the materials: the light of the photographs, or
//! their number; for a surface reconstructed from a picture, its depth, or which parts were invented.

use crate::window::widgets::false_colour::nearness_color;
use atlas::TexelMap;
use document::Stage;
use egui::ecolor::gamma_u8_from_linear_f32;
use glam::{DVec3, Vec3};
use light::PhotographLight;
use rayon::prelude::*;
use scene::SurfacePoint;

/// What the surface shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OverlayKind {
    /// Its own materials.
    #[default]
    Materials,
    /// The light of its photographs.
    Photographs,
    /// The number of photographs in which each point is visible.
    PhotographCount,
    /// The depth from the camera of the picture it was made from.
    Depth,
    /// The picture, with the invented parts marked.
    Invented,
}

/// A texture over the atlas, sRGB-encoded.
pub struct SurfaceOverlay {
    /// Width, texels.
    pub width: u32,
    /// Height, texels.
    pub height: u32,
    /// Four bytes per texel, row by row.
    pub rgba: Vec<u8>,
}

/// Colour of points visible in no photograph, sRGB-encoded.
pub const UNOBSERVED_COLOR: [u8; 3] = [200, 40, 140];
/// Count at which the colour scale saturates.
pub const MAX_COUNTED: f32 = 32.0;

impl SurfaceOverlay {
    /// The overlay of a surface; `None` if its materials are to be shown. Light of photographs is shown
    /// without view dependence.
    pub fn build(stage: &Stage, light: Option<&PhotographLight>, kind: OverlayKind) -> Option<Self> {
        let scene = &stage.scene;
        match (kind, light) {
            (OverlayKind::Photographs, Some(light)) => {
                Some(Self::from_texel_colors(&stage.texels, |point| encoded(light.constant(point))))
            }
            (OverlayKind::PhotographCount, Some(light)) => {
                Some(Self::from_texel_colors(&stage.texels, |point| {
                    match light.observed_share(point) < 0.5 {
                        true => UNOBSERVED_COLOR,
                        false => color_of_count(light.observation_count(point)),
                    }
                }))
            }
            (OverlayKind::Depth, _) => {
                let camera_from_world = scene.cameras.first()?.camera_to_world.inverse();
                let nearness = |position: DVec3| -1.0 / camera_from_world.transform_point3(position).z;
                let [low, high] = scene
                    .positions
                    .iter()
                    .map(|&position| nearness(position))
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], nearness| {
                        [low.min(nearness), high.max(nearness)]
                    });
                let range = if high > low { high - low } else { 1.0 };
                let share = |point: SurfacePoint| (nearness(point.position(scene)) - low) / range;
                Some(Self::from_texel_colors(&stage.texels, |point| nearness_color(share(point) as f32)))
            }
            (OverlayKind::Invented, _) => {
                Some(Self::from_texel_colors(&stage.texels, |point| match scene.photographed_share(point) {
                    Some(0.0) => UNOBSERVED_COLOR,
                    _ => encoded(scene.base_color(point).truncate()),
                }))
            }
            _ => None,
        }
    }

    /// Colours each texel by the centroid of the surface it covers.
    fn from_texel_colors(map: &TexelMap, color: impl Fn(SurfacePoint) -> [u8; 3] + Sync) -> Self {
        let colors: Vec<[u8; 3]> = map.texels.par_iter().map(|texel| color(texel.centroid)).collect();
        let mut rgba = vec![255; 4 * map.width as usize * map.height as usize];
        let mut set = |place: usize, color: [u8; 3]| rgba[4 * place..4 * place + 3].copy_from_slice(&color);
        for (texel, &color) in map.texels.iter().zip(&colors) {
            set(texel.y as usize * map.width as usize + texel.x as usize, color);
        }
        for dilation in &map.dilations {
            let source = map.index[dilation.source as usize] as usize;
            if let Some(&color) = colors.get(source) {
                set(dilation.texel as usize, color);
            }
        }
        Self { width: map.width, height: map.height, rgba }
    }
}

/// sRGB encoding of linear light.
fn encoded(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(gamma_u8_from_linear_f32)
}

fn color_of_count(count: u16) -> [u8; 3] {
    nearness_color(share_of_count(count))
}

/// Position of a count on the colour scale, logarithmic because the first photographs matter most: 0 for one,
/// 1 for [`MAX_COUNTED`].
pub fn share_of_count(count: u16) -> f32 {
    (f32::from(count.max(1)).ln() / MAX_COUNTED.ln()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::luminance;

    #[test]
    fn more_photographs_are_lighter() {
        let lightness = |count: u16| luminance(color_of_count(count).map(f32::from));
        for count in 1..31 {
            assert!(lightness(count + 1) > lightness(count), "{count}");
        }
        assert_eq!(color_of_count(40), color_of_count(400));
    }
}
