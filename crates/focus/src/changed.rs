//! Which texels an edit touched.

use std::ops::Range;

/// The texels that an edit changed, gutters included, each once and in row order.
///
/// The map is sampled bilinearly, so what lies within one texel of these has changed too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changed {
    /// Column and row of each.
    pub texels: Vec<[u32; 2]>,
}

impl Changed {
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

    /// The columns and rows that all of them lie in; empty ranges if there are none.
    pub fn bounds(&self) -> [Range<u32>; 2] {
        [0, 1].map(|axis| {
            let along = || self.texels.iter().map(|texel| texel[axis]);
            along().min().unwrap_or(0)..along().max().map_or(0, |last| last + 1)
        })
    }

    /// Adds the texels of another edit.
    pub fn extend(&mut self, other: Changed) {
        let mut texels = std::mem::take(&mut self.texels);
        texels.extend(other.texels);
        *self = Self::new(texels);
    }
}
