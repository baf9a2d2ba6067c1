//! Which texels an edit touched.

use crate::TILE_SIDE;
use std::collections::BTreeMap;
use std::ops::Range;

/// The texels that an edit changed, gutters included, each once and in row order.
///
/// The map is sampled bilinearly, so what lies within one texel of these has changed too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChangedTexels {
    /// Column and row of each.
    pub texels: Vec<[u32; 2]>,
}

impl ChangedTexels {
    /// The given texels, put in order.
    pub(crate) fn new(mut texels: Vec<[u32; 2]>) -> Self {
        texels.sort_unstable_by_key(|[x, y]| (*y, *x));
        texels.dedup();
        Self { texels }
    }

    /// Whether nothing changed.
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// Rectangles, columns and rows, that hold them all: the narrowest of each square of [`TILE_SIDE`] texels, by the
    /// square's column and row. So what lies far apart in the atlas stays apart.
    pub fn rectangles(&self) -> BTreeMap<[u32; 2], [Range<u32>; 2]> {
        let mut rectangles = BTreeMap::new();
        for &[x, y] in &self.texels {
            let texel_rectangle = [x..x + 1, y..y + 1];
            let rectangle =
                rectangles.entry([x / TILE_SIDE, y / TILE_SIDE]).or_insert_with(|| texel_rectangle.clone());
            *rectangle = rectangle_union(rectangle, &texel_rectangle);
        }
        rectangles
    }

    /// Adds the texels of another edit.
    pub fn extend(&mut self, other: ChangedTexels) {
        let mut texels = std::mem::take(&mut self.texels);
        texels.extend(other.texels);
        *self = Self::new(texels);
    }
}

/// The least rectangle around two, columns and rows.
pub fn rectangle_union(a: &[Range<u32>; 2], b: &[Range<u32>; 2]) -> [Range<u32>; 2] {
    [0, 1].map(|axis| a[axis].start.min(b[axis].start)..a[axis].end.max(b[axis].end))
}
