//! A picture over the whole atlas that the surface is shown in instead of its materials: what photographs show of it, or how many do.

use atlas::TexelMap;
use egui::ecolor::gamma_u8_from_linear_f32;
use rayon::prelude::*;
use scene::SurfacePoint;
use session::PhotographLight;

/// What the surface is shown in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coating {
    /// Its own materials.
    #[default]
    Materials,
    /// What its photographs show.
    Photographs,
    /// How many photographs see it.
    Seeing,
}

/// Texels of an atlas, sRGB-encoded.
pub struct Coat {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four bytes a texel, row by row.
    pub rgba: Vec<u8>,
}

/// What no photograph sees, and the colours from one photograph to [`MANY`]: sRGB-encoded, lightness rises.
const UNSEEN: [u8; 3] = [200, 40, 140];
const FEW: [f32; 3] = [30.0, 50.0, 110.0];
const SEVERAL: [f32; 3] = [40.0, 150.0, 140.0];
const ALL: [f32; 3] = [250.0, 230.0, 90.0];
/// From so many on it does not matter how many there are.
const MANY: f32 = 32.0;

impl Coat {
    /// What photographs show of a surface, toward all directions alike, or how many see it.
    pub fn of(map: &TexelMap, light: &PhotographLight, coating: Coating) -> Self {
        let color = |point: SurfacePoint| match coating {
            Coating::Seeing if light.seen(point) < 0.5 => UNSEEN,
            Coating::Seeing => color_of_count(light.seeing(point)),
            _ => light.constant(point).to_array().map(gamma_u8_from_linear_f32),
        };
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

/// By the logarithm of the count: the first photographs matter most.
fn color_of_count(count: u16) -> [u8; 3] {
    let at = 2.0 * (f32::from(count.max(1)).ln() / MANY.ln()).min(1.0);
    let (from, to, share) = if at < 1.0 { (FEW, SEVERAL, at) } else { (SEVERAL, ALL, at - 1.0) };
    std::array::from_fn(|k| (from[k] + (to[k] - from[k]) * share + 0.5) as u8)
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
