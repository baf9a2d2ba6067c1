//! One undoable change of a focus map: its tiles before and after.

use crate::focus_map::{TILE_TEXELS, Tile};
use crate::{Changed, FocusMap};
use lens::FocusOffset;
use std::sync::Arc;

/// One undoable change of a focus map.
#[derive(Clone, Debug)]
pub struct Edit {
    name: String,
    /// Index, before, after.
    tiles: Vec<(usize, Arc<Tile>, Arc<Tile>)>,
    /// Before, after.
    background: [FocusOffset; 2],
}

impl Edit {
    /// What turns `before` into `after`, two maps of one size; `None` if they are equal. Cheap where `after`
    /// was made from a clone of `before`: only tiles that were written are looked at.
    pub fn between(name: impl Into<String>, before: &FocusMap, after: &FocusMap) -> Option<Self> {
        debug_assert_eq!(before.size(), after.size());
        let pairs = before.tiles().iter().zip(after.tiles()).enumerate();
        let differ = pairs.filter(|(_, (a, b))| !Arc::ptr_eq(a, b) && a != b);
        let tiles: Vec<_> = differ.map(|(index, (a, b))| (index, a.clone(), b.clone())).collect();
        let background = [before.background, after.background];
        let empty = tiles.is_empty() && background[0] == background[1];
        (!empty).then(|| Self { name: name.into(), tiles, background })
    }

    /// Its name in the undo list.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Memory that it keeps alive: in a history each tile is shared with the neighbouring edit or the map, so
    /// an edit counts one of its two.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.tiles.len() * (size_of::<Tile>() + size_of::<(usize, Arc<Tile>, Arc<Tile>)>())
    }

    /// Whether the background's focus is part of it.
    pub fn changes_background(&self) -> bool {
        self.background[0] != self.background[1]
    }

    /// Makes the change. Returns what changed.
    pub fn apply(&self, map: &mut FocusMap) -> Changed {
        self.replace(map, |(_, _, after)| after, self.background[1])
    }

    /// Takes the change back, to the same bits. Returns what changed.
    pub fn revert(&self, map: &mut FocusMap) -> Changed {
        self.replace(map, |(_, before, _)| before, self.background[0])
    }

    fn replace(
        &self,
        map: &mut FocusMap,
        side: impl Fn(&(usize, Arc<Tile>, Arc<Tile>)) -> &Arc<Tile>,
        background: FocusOffset,
    ) -> Changed {
        let mut changed = Vec::new();
        for entry in &self.tiles {
            let (index, a, b) = entry;
            let differing = (0..TILE_TEXELS).filter(|&k| a[k] != b[k]);
            changed.extend(differing.filter_map(|k| map.position(*index, k)));
            map.set_tile(*index, side(entry).clone());
        }
        map.background = background;
        Changed::new(changed)
    }
}
