//! From texels to the surface.

use crate::texels::dilation::{Dilation, dilations};
use crate::{Atlas, AtlasTexel};
use scene::Scene;

/// The index of texels that cover no surface.
pub const NO_TEXEL: u32 = u32::MAX;

/// What every texel of an atlas covers, and how the gutter is filled.
#[derive(Clone, Debug, PartialEq)]
pub struct TexelMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The covered texels in row order.
    pub texels: Vec<AtlasTexel>,
    /// For each texel of the atlas, row by row, its index in `texels`, or [`NO_TEXEL`].
    pub index: Vec<u32>,
    /// Gutter texels and their sources, sorted by source.
    pub dilations: Vec<Dilation>,
}

impl TexelMap {
    /// The texel in column `x` and row `y`; `None` if it is not covered.
    pub fn texel_at(&self, x: u32, y: u32) -> Option<&AtlasTexel> {
        if x >= self.width || y >= self.height {
            return None;
        }
        self.texels.get(self.index[y as usize * self.width as usize + x as usize] as usize)
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.texels) + size_of_val(&*self.index) + size_of_val(&*self.dilations)
    }

    /// The gutter texels that copy a covered texel (`y · width + x`): what to update after painting it.
    pub fn gutter_of(&self, source: u32) -> &[Dilation] {
        let start = self.dilations.partition_point(|d| d.source < source);
        let len = self.dilations[start..].partition_point(|d| d.source == source);
        &self.dilations[start..start + len]
    }
}

impl Atlas {
    /// The map from every texel back to the surface. Takes a fraction of a second for 2048².
    pub fn texel_map(&self, scene: &Scene) -> TexelMap {
        let (width, height) = (self.width, self.height);
        let texels = self.texels(scene);
        let mut index = vec![NO_TEXEL; width as usize * height as usize];
        for (i, texel) in texels.iter().enumerate() {
            index[texel.y as usize * width as usize + texel.x as usize] = i as u32;
        }
        let dilations = dilations(width, height, |at| index[at] != NO_TEXEL);
        TexelMap { width, height, texels, index, dilations }
    }

    /// Copies to every gutter texel within [`crate::DILATION_RADIUS`] of a chart the value of the nearest covered
    /// texel. `data` holds one value per texel, row by row; texels beyond its end are ignored.
    pub fn dilate<T: Copy>(&self, covered: &TexelMap, data: &mut [T]) {
        for &Dilation { texel, source } in &covered.dilations {
            if let Some(&value) = data.get(source as usize)
                && let Some(place) = data.get_mut(texel as usize)
            {
                *place = value;
            }
        }
    }
}
