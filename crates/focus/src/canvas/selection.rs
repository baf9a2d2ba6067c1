//! A selection: the set of texels that may be painted; all others are frozen.

use crate::focus_map::tile_grid::TileGrid;
use crate::{Canvas, CanvasTexel, FocusMap};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Texels of a canvas that may be painted, at least one. Clones share their memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// One bit for each texel, in the canvas's order.
    words: Arc<[u64]>,
    count: usize,
    texel_count: usize,
}

/// How newly selected texels are combined with the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CombineMode {
    /// Only the new ones.
    #[default]
    Replace,
    /// Both.
    Add,
    /// The selection without the new ones.
    Subtract,
    /// Those in both.
    Intersect,
}

impl CombineMode {
    /// All modes, in the order in which a menu offers them.
    pub const ALL: [Self; 4] = [Self::Replace, Self::Add, Self::Subtract, Self::Intersect];
}

impl Selection {
    /// Selects the texels of a canvas for which `is_selected` is true.
    pub fn from_predicate(canvas: &Canvas, is_selected: impl Fn(&CanvasTexel) -> bool) -> SelectionResult {
        Self::from_bits(canvas.texels().map(|texel| is_selected(&texel)))
    }

    /// Selects the texels of a canvas for whose index `is_selected` is true.
    pub fn from_indices(canvas: &Canvas, is_selected: impl Fn(usize) -> bool) -> SelectionResult {
        Self::from_bits((0..canvas.texels().len()).map(is_selected))
    }

    fn from_bits(bits: impl ExactSizeIterator<Item = bool>) -> SelectionResult {
        let texel_count = bits.len();
        let mut words = vec![0u64; texel_count.div_ceil(64)];
        let mut count = 0;
        for (index, bit) in bits.enumerate() {
            words[index / 64] |= u64::from(bit) << (index % 64);
            count += usize::from(bit);
        }
        match count {
            0 => SelectionResult::Nothing,
            _ if count == texel_count => SelectionResult::Everything,
            _ => SelectionResult::Some(Self { words: words.into(), count, texel_count }),
        }
    }

    /// Whether the canvas's texel with this index is selected.
    pub fn contains(&self, index: usize) -> bool {
        self.words[index / 64] >> (index % 64) & 1 == 1
    }

    /// The number of selected texels.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The selection of all other texels.
    pub fn inverted(&self) -> SelectionResult {
        Self::from_bits((0..self.texel_count).map(|index| !self.contains(index)))
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.words)
    }
}

impl FocusMap {
    /// Sets the mask to 1 where the map is selected and to 0 elsewhere, the background included.
    pub fn set_mask_from_selection(&mut self, canvas: &Canvas, selection: &Selection) {
        let [width, height] = self.size();
        let mut mask = TileGrid::new(width, height, 0.0);
        for (index, texel) in canvas.texels().enumerate() {
            if selection.contains(index) {
                mask.set(texel.x, texel.y, 1.0);
                canvas.gutters_of(index).iter().for_each(|&[x, y]| mask.set(x, y, 1.0));
            }
        }
        (self.mask, self.background_mask) = (Some(mask), 0.0);
    }
}

/// The result of selecting texels.
#[derive(Clone, Debug, PartialEq)]
pub enum SelectionResult {
    /// No texel.
    Nothing,
    /// All texels: nothing is frozen.
    Everything,
    /// These texels.
    Some(Selection),
}

impl SelectionResult {
    /// Combines newly selected texels with a selection (`None`: everything), on a canvas of `texel_count` texels.
    pub fn combine_with(self, before: Option<&Selection>, combine: CombineMode, texel_count: usize) -> Self {
        let new = |index: usize| match &self {
            Self::Nothing => false,
            Self::Everything => true,
            Self::Some(selection) => selection.contains(index),
        };
        let old = |index: usize| before.is_none_or(|selection| selection.contains(index));
        match combine {
            CombineMode::Replace => self,
            // Where everything is selected there is nothing to add to: start with the new ones.
            CombineMode::Add if before.is_none() => self,
            CombineMode::Add => Selection::from_bits((0..texel_count).map(|index| old(index) || new(index))),
            CombineMode::Subtract => {
                Selection::from_bits((0..texel_count).map(|index| old(index) && !new(index)))
            }
            CombineMode::Intersect => {
                Selection::from_bits((0..texel_count).map(|index| old(index) && new(index)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bits: [bool; 4]) -> SelectionResult {
        Selection::from_bits(bits.into_iter())
    }

    #[test]
    fn sets_join_as_sets_do() {
        let old = of([true, true, false, false]);
        let SelectionResult::Some(old) = old else { panic!("some") };
        assert_eq!((old.count(), old.contains(1), old.contains(2)), (2, true, false));
        let new = || of([false, true, true, false]);
        let join = |combine| new().combine_with(Some(&old), combine, 4);
        assert_eq!(join(CombineMode::Replace), new());
        assert_eq!(join(CombineMode::Add), of([true, true, true, false]));
        assert_eq!(join(CombineMode::Subtract), of([true, false, false, false]));
        assert_eq!(join(CombineMode::Intersect), of([false, true, false, false]));
        assert_eq!(old.inverted(), of([false, false, true, true]));
        assert_eq!(new().combine_with(None, CombineMode::Add, 4), new());
        assert_eq!(new().combine_with(None, CombineMode::Subtract, 4), of([true, false, false, true]));
        assert_eq!(of([true; 4]), SelectionResult::Everything);
        assert_eq!(
            SelectionResult::Everything.combine_with(Some(&old), CombineMode::Subtract, 4),
            SelectionResult::Nothing
        );
    }
}
