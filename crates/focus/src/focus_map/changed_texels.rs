//! Which texels an edit changed.

use crate::TILE_SIDE;
use std::collections::BTreeMap;
use std::ops::Range;

/// The texels that an edit changed, gutters included, each once and in row order.
///
/// The map is sampled bilinearly, so anything within one texel of these has changed as well.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChangedTexels {
    /// Column and row of each.
    pub texels: Vec<[u32; 2]>,
}

impl ChangedTexels {
    /// Sorts the texels and removes duplicates.
    pub(crate) fn new(mut texels: Vec<[u32; 2]>) -> Self {
        texels.sort_unstable_by_key(|[x, y]| (*y, *x));
        texels.dedup();
        Self { texels }
    }

    /// Whether nothing changed.
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// Rectangles (columns, rows) that contain them all: the tightest one for each square of [`TILE_SIDE`] texels,
    /// keyed by the square's column and row. Texels far apart in the atlas thus stay in separate rectangles.
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

    /// Adds the texels that another edit changed.
    pub fn extend(&mut self, other: ChangedTexels) {
        let mut texels = std::mem::take(&mut self.texels);
        texels.extend(other.texels);
        *self = Self::new(texels);
    }
}

/// The smallest rectangle that contains two rectangles of texels (columns, rows).
pub fn rectangle_union(a: &[Range<u32>; 2], b: &[Range<u32>; 2]) -> [Range<u32>; 2] {
    [0, 1].map(|axis| a[axis].start.min(b[axis].start)..a[axis].end.max(b[axis].end))
}
