//! One undoable change of a focus map: its tiles before and after.

use crate::focus_map::tile_grid::{Tile, TileGrid};
use crate::{ChangedTexels, FocusMap};
use lens::FocusOffset;
use std::sync::Arc;

/// One undoable change of a focus map.
#[derive(Clone, Debug)]
pub struct Edit {
    name: String,
    values: Vec<TileChange<[f32; 2]>>,
    gloss: Vec<TileChange<f32>>,
    mask: Vec<TileChange<f32>>,
    /// Before, after: the background's focus and mask.
    background: [(FocusOffset, f32); 2],
}

/// A tile: its index, before, after.
type TileChange<T> = (usize, Arc<Tile<T>>, Arc<Tile<T>>);

/// Which end of a change.
#[derive(Clone, Copy)]
enum EditSide {
    Before,
    After,
}

impl Edit {
    /// The change from `before` to `after`, two maps of one size that both have a mask or both have none; `None` if
    /// they are equal. Cheap if `after` was made from a clone of `before`: only tiles that were written are compared.
    pub fn from_difference(name: impl Into<String>, before: &FocusMap, after: &FocusMap) -> Option<Self> {
        debug_assert_eq!(before.size(), after.size());
        debug_assert_eq!(before.mask.is_some(), after.mask.is_some());
        let values = tile_changes(&before.texels, &after.texels);
        let gloss = tile_changes(&before.gloss, &after.gloss);
        let masks = before.mask.as_ref().zip(after.mask.as_ref());
        let mask = masks.map_or(Vec::new(), |(before, after)| tile_changes(before, after));
        let background = [before, after].map(|map| (map.background, map.background_mask));
        let empty =
            values.is_empty() && gloss.is_empty() && mask.is_empty() && background[0] == background[1];
        (!empty).then(|| Self { name: name.into(), values, gloss, mask, background })
    }

    /// Its name in the undo list.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Memory that it keeps alive, in bytes: in a history each tile is shared with the neighbouring edit or with the
    /// map, so an edit counts one of its two.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + change_bytes(&self.values) + change_bytes(&self.gloss) + change_bytes(&self.mask)
    }

    /// Whether the background's focus changes.
    pub fn changes_background(&self) -> bool {
        self.background[0] != self.background[1]
    }

    /// Applies the change to `map`. Returns the texels that changed.
    pub fn apply(&self, map: &mut FocusMap) -> ChangedTexels {
        self.replace(map, EditSide::After)
    }

    /// Reverts the change in `map`, bit for bit. Returns the texels that changed.
    pub fn revert(&self, map: &mut FocusMap) -> ChangedTexels {
        self.replace(map, EditSide::Before)
    }

    fn replace(&self, map: &mut FocusMap, end: EditSide) -> ChangedTexels {
        let mut changed = replace_tiles(&self.values, &mut map.texels, end);
        changed.extend(replace_tiles(&self.gloss, &mut map.gloss, end));
        if let Some(mask) = &mut map.mask {
            changed.extend(replace_tiles(&self.mask, mask, end));
        }
        (map.background, map.background_mask) = self.background[end as usize];
        ChangedTexels::new(changed)
    }
}

/// The tiles in which two grids differ.
fn tile_changes<T: Copy + PartialEq>(before: &TileGrid<T>, after: &TileGrid<T>) -> Vec<TileChange<T>> {
    let pairs = before.tiles().iter().zip(after.tiles()).enumerate();
    let differ = pairs.filter(|(_, (a, b))| !Arc::ptr_eq(a, b) && a != b);
    differ.map(|(index, (a, b))| (index, a.clone(), b.clone())).collect()
}

fn replace_tiles<T: Copy + PartialEq>(
    changes: &[TileChange<T>],
    grid: &mut TileGrid<T>,
    end: EditSide,
) -> Vec<[u32; 2]> {
    let mut changed = Vec::new();
    for (index, before, after) in changes {
        changed.extend(grid.differing_texels(*index, before, after));
        let tile = match end {
            EditSide::Before => before,
            EditSide::After => after,
        };
        grid.set_tile(*index, tile.clone());
    }
    changed
}

fn change_bytes<T>(changes: &[TileChange<T>]) -> usize {
    changes.len() * (size_of::<Tile<T>>() + size_of::<TileChange<T>>())
}
