//! A small picture of what an edit changed in the focus map, or of what a layer holds.

use crate::FocusMap;
use crate::focus_map::tile_grid::{TILE_TEXELS, is_blank};
use crate::focus_map::to_texel;
use lens::FocusOffset;
use std::sync::Arc;

/// Rows and columns of cells.
const SIDE: u32 = 24;

/// What changed between two maps of one size, or what a layer holds, as a few cells over the atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct EditThumbnail {
    /// Row by row, the top one first.
    cells: Box<[ThumbnailCell]>,
}

/// A cell of an [`EditThumbnail`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThumbnailCell {
    /// The fraction of its texels that changed, in [0, 1].
    pub changed: f32,
    /// The mean focus offset of the changed texels afterwards.
    pub t: f32,
}

impl EditThumbnail {
    /// Rows and columns of cells.
    pub const SIDE: usize = SIDE as usize;

    /// What changed from `before` to `after`. Only tiles that were written are compared.
    pub fn from_difference(before: &FocusMap, after: &FocusMap) -> Self {
        debug_assert_eq!(before.size(), after.size());
        let mut sums = CellSums::new(after.size());
        for tile in 0..after.texels.tiles().len() {
            let [old, new] = [before, after].map(|map| &map.texels.tiles()[tile]);
            let [old_gloss, new_gloss] = [before, after].map(|map| &map.gloss.tiles()[tile]);
            if Arc::ptr_eq(old, new) && Arc::ptr_eq(old_gloss, new_gloss) {
                continue;
            }
            for k in (0..TILE_TEXELS).filter(|&k| old[k] != new[k] || old_gloss[k] != new_gloss[k]) {
                sums.add(after.texels.position(tile, k), new[k]);
            }
        }
        sums.thumbnail()
    }

    /// What a layer with this map puts over those below: the texels that have weight and are not of the ordinary lens.
    pub fn from_layer(map: &FocusMap) -> Self {
        let standard = to_texel(FocusOffset::STANDARD);
        let mut sums = CellSums::new(map.size());
        // Tiles that were never painted are one and the same.
        let mut unpainted = None;
        for (tile, texels) in map.texels.tiles().iter().enumerate() {
            let (gloss, mask) = (&map.gloss.tiles()[tile], map.mask.as_ref().map(|mask| &mask.tiles()[tile]));
            let is_unpainted = unpainted.is_some_and(|before| Arc::ptr_eq(before, texels))
                || texels.iter().all(|texel| *texel == standard);
            if is_unpainted {
                unpainted = Some(texels);
            }
            if is_unpainted && is_blank(gloss) {
                continue;
            }
            let counts = |k: usize| mask.is_none_or(|mask| mask[k] > 0.0);
            for k in (0..TILE_TEXELS).filter(|&k| (texels[k] != standard || gloss[k] != 0.0) && counts(k)) {
                sums.add(map.texels.position(tile, k), texels[k]);
            }
        }
        sums.thumbnail()
    }

    /// The cells, row by row from the top.
    pub fn cells(&self) -> &[ThumbnailCell] {
        &self.cells
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.cells)
    }
}

/// Texels a cell, and the sum of their t.
struct CellSums {
    size: [u32; 2],
    cells: Vec<[f64; 2]>,
}

impl CellSums {
    fn new(size: [u32; 2]) -> Self {
        Self { size, cells: vec![[0.0; 2]; (SIDE * SIDE) as usize] }
    }

    /// Adds a texel, [t, anchor], at its place in the map; none for what lies beyond.
    fn add(&mut self, place: Option<[u32; 2]>, texel: [f32; 2]) {
        let Some([x, y]) = place else { return };
        let [width, height] = self.size;
        let [count, sum] = &mut self.cells[(y * SIDE / height * SIDE + x * SIDE / width) as usize];
        *count += 1.0;
        *sum += f64::from(texel[0]);
    }

    fn thumbnail(self) -> EditThumbnail {
        let [width, height] = self.size.map(|side| f64::from(side) / f64::from(SIDE));
        let cell = |[count, sum]: [f64; 2]| ThumbnailCell {
            changed: (count / (width * height)).min(1.0) as f32,
            t: if count > 0.0 { (sum / count) as f32 } else { 0.0 },
        };
        EditThumbnail { cells: self.cells.into_iter().map(cell).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_shows_where_it_is_with_what_it_became() {
        let before = FocusMap::new(240, 120, FocusOffset::STANDARD);
        let mut after = before.clone();
        for y in 0..60 {
            for x in 0..120 {
                after.set(x, y, [1.5, 1.0]);
            }
        }
        let picture = EditThumbnail::from_difference(&before, &after);
        for (k, cell) in picture.cells().iter().enumerate() {
            let [x, y] = [k % EditThumbnail::SIDE, k / EditThumbnail::SIDE];
            let expected = if x < 12 && y < 12 { (1.0, 1.5) } else { (0.0, 0.0) };
            assert_eq!((cell.changed, cell.t), expected, "{x} {y}");
        }
        assert_eq!(EditThumbnail::from_layer(&after), picture);
        after.add_mask();
        after.invert_mask();
        assert!(EditThumbnail::from_layer(&after).cells().iter().all(|cell| cell.changed == 0.0));
        let nothing = EditThumbnail::from_difference(&after, &after.clone());
        assert!(nothing.cells().iter().all(|cell| cell.changed == 0.0));
    }
}
