//! Undo and redo: tiles before and after, under a byte budget.

use crate::focus_map::{TILE_TEXELS, Tile};
use crate::{Changed, FocusMap};
use lens::FocusOffset;
use std::collections::VecDeque;
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

/// An edit that was undone or redone.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied {
    /// Its name.
    pub name: String,
    /// The texels that changed.
    pub changed: Changed,
    /// Whether the background's focus changed.
    pub background: bool,
}

/// The edits that can be undone and redone.
#[derive(Clone, Debug)]
pub struct History {
    done: VecDeque<Edit>,
    undone: Vec<Edit>,
    budget: usize,
}

impl Default for History {
    /// A budget of 256 MiB.
    fn default() -> Self {
        Self::new(256 << 20)
    }
}

impl History {
    /// A history that forgets its oldest edits beyond `budget` bytes. The latest is always kept.
    pub fn new(budget: usize) -> Self {
        Self { done: VecDeque::new(), undone: Vec::new(), budget }
    }

    /// Takes up an edit that was just made; what was undone before is gone.
    pub fn push(&mut self, edit: Edit) {
        self.undone.clear();
        self.done.push_back(edit);
        while self.bytes() > self.budget && self.done.len() > 1 {
            self.done.pop_front();
        }
    }

    /// Takes the latest edit back. `None` if there is none.
    pub fn undo(&mut self, map: &mut FocusMap) -> Option<Applied> {
        let edit = self.done.pop_back()?;
        let changed = edit.revert(map);
        let applied = Applied { name: edit.name.clone(), changed, background: edit.changes_background() };
        self.undone.push(edit);
        Some(applied)
    }

    /// Makes the edit again that was undone last. `None` if there is none.
    pub fn redo(&mut self, map: &mut FocusMap) -> Option<Applied> {
        let edit = self.undone.pop()?;
        let changed = edit.apply(map);
        let applied = Applied { name: edit.name.clone(), changed, background: edit.changes_background() };
        self.done.push_back(edit);
        Some(applied)
    }

    /// The name of what [`Self::undo`] would take back.
    pub fn undo_name(&self) -> Option<&str> {
        self.done.back().map(Edit::name)
    }

    /// The name of what [`Self::redo`] would make again.
    pub fn redo_name(&self) -> Option<&str> {
        self.undone.last().map(Edit::name)
    }

    /// The names of all that can be undone, oldest first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.done.iter().map(Edit::name)
    }

    /// Memory that the edits keep alive.
    pub fn bytes(&self) -> usize {
        self.done.iter().chain(&self.undone).map(Edit::bytes).sum()
    }

    /// Forgets everything, as when another map takes the place of this one.
    pub fn clear(&mut self) {
        self.done.clear();
        self.undone.clear();
    }
}
