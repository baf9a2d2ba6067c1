//! A small picture of what an edit changed in the focus map.

use crate::FocusMap;
use crate::focus_map::tile_grid::TILE_TEXELS;
use std::sync::Arc;

/// Rows and columns of cells.
const SIDE: u32 = 24;

/// What changed between two maps of one size, as a few cells over the atlas.
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
        let [width, height] = after.size();
        let mut sums = vec![[0.0f64; 2]; (SIDE * SIDE) as usize];
        for tile in 0..after.texels.tiles().len() {
            let [old, new] = [before, after].map(|map| &map.texels.tiles()[tile]);
            let [old_gloss, new_gloss] = [before, after].map(|map| &map.gloss.tiles()[tile]);
            if Arc::ptr_eq(old, new) && Arc::ptr_eq(old_gloss, new_gloss) {
                continue;
            }
            for k in (0..TILE_TEXELS).filter(|&k| old[k] != new[k] || old_gloss[k] != new_gloss[k]) {
                if let Some([x, y]) = after.texels.position(tile, k) {
                    let cell = y * SIDE / height * SIDE + x * SIDE / width;
                    let [count, sum] = &mut sums[cell as usize];
                    *count += 1.0;
                    *sum += new[k][0] as f64;
                }
            }
        }
        let texels_a_cell = (width as f64 / SIDE as f64) * (height as f64 / SIDE as f64);
        let cell = |[count, sum]: [f64; 2]| ThumbnailCell {
            changed: (count / texels_a_cell).min(1.0) as f32,
            t: if count > 0.0 { (sum / count) as f32 } else { 0.0 },
        };
        Self { cells: sums.into_iter().map(cell).collect() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use lens::FocusOffset;

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
        let nothing = EditThumbnail::from_difference(&after, &after.clone());
        assert!(nothing.cells().iter().all(|cell| cell.changed == 0.0));
    }
}
