//! Bakes any focus into a map that can be painted on.

use crate::focus_map::to_texel;
use crate::{Focus, FocusMap};
use atlas::TexelMap;
use lens::FocusOffset;
use rayon::prelude::*;
use scene::SurfaceField;

impl Focus {
    /// Samples the focus at the centroid of every covered texel, fills the gutters and keeps the background's focus,
    /// so that a recipe can be painted on. Texels that cover no surface hold the standard lens.
    pub fn bake(&self, texels: &TexelMap) -> FocusMap {
        let (width, height) = (texels.width, texels.height);
        let values: Vec<FocusOffset> =
            texels.texels.par_iter().map(|texel| self.at(texel.centroid)).collect();
        let mut map = FocusMap::new(width, height, FocusOffset::STANDARD);
        map.background = self.background;
        for (texel, value) in texels.texels.iter().zip(values) {
            map.set(texel.x, texel.y, to_texel(value));
            map.set_gloss(texel.x, texel.y, value.gloss as f32);
        }
        map.fill_gutters(texels);
        map
    }
}

impl FocusMap {
    /// Gives the texels in the gutters of charts the values of the covered texels beside them, as interpolation needs. `texels` must be
    /// those of an atlas of this size.
    pub fn fill_gutters(&mut self, texels: &TexelMap) {
        for gutter in &texels.dilations {
            let [from, to] =
                [gutter.source, gutter.texel].map(|index| [index % texels.width, index / texels.width]);
            let (value, gloss) = (self.texel(from[0], from[1]), self.gloss_at(from[0], from[1]));
            // Tiles stay shared where nothing changes.
            if self.texel(to[0], to[1]) != value {
                self.set(to[0], to[1], value);
            }
            if self.gloss_at(to[0], to[1]) != gloss {
                self.set_gloss(to[0], to[1], gloss);
            }
        }
    }
}
