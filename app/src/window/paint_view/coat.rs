//! A picture over the whole atlas that the surface is shown in instead of its materials: what photographs show of it, or how many do; of a
//! surface that was made from a picture, how far it is, or what of it was invented.

use crate::window::false_colour::nearness_color;
use atlas::TexelMap;
use egui::ecolor::gamma_u8_from_linear_f32;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use scene::SurfacePoint;
use session::{PhotographLight, Stage};

/// What the surface is shown in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OverlayKind {
    /// Its own materials.
    #[default]
    Materials,
    /// What its photographs show.
    Photographs,
    /// How many photographs see it.
    PhotographCount,
    /// How far it is from the camera that took the picture it was made from.
    Depth,
    /// Its picture, and what no picture showed.
    Invented,
}

/// Texels of an atlas, sRGB-encoded.
pub struct SurfaceOverlay {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four bytes a texel, row by row.
    pub rgba: Vec<u8>,
}

/// What no photograph sees, sRGB-encoded.
pub const UNOBSERVED_COLOR: [u8; 3] = [200, 40, 140];
/// From so many on it does not matter how many there are.
pub const MAX_COUNTED: f32 = 32.0;

impl SurfaceOverlay {
    /// A surface's coat; none where it is to be shown in its materials. What photographs show of it they show toward all directions alike.
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

    /// A colour a texel, by the middle of what it covers.
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

/// Linear light as a screen shows it.
fn encoded(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(gamma_u8_from_linear_f32)
}

fn color_of_count(count: u16) -> [u8; 3] {
    nearness_color(share_of_count(count))
}

/// By the logarithm of the count: the first photographs matter most. 0 for one, 1 for [`MANY`].
pub fn share_of_count(count: u16) -> f32 {
    (f32::from(count.max(1)).ln() / MAX_COUNTED.ln()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_photographs_are_lighter() {
        let lightness = |count: u16| {
            let [r, g, b] = color_of_count(count).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for count in 1..31 {
            assert!(lightness(count + 1) > lightness(count), "{count}");
        }
        assert_eq!(color_of_count(40), color_of_count(400));
    }
}
