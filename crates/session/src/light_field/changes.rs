//! Changes of the focus map that a sum does not include yet.

/// Beyond this number of texels, a change counts as a change of everything.
const MAX_TEXELS: usize = 1 << 22;

/// Changes of the focus map that a sum does not include yet.
#[derive(Clone, Debug)]
pub(crate) enum Changes {
    /// These.
    Texels(Vec<[u32; 2]>),
    /// All of them, or the background.
    Everything,
}

impl Default for Changes {
    fn default() -> Self {
        Self::Texels(Vec::new())
    }
}

impl Changes {
    /// Whether nothing has changed.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::Texels(texels) if texels.is_empty())
    }

    /// Adds changes that were made later.
    pub fn join(&mut self, newer: &Changes) {
        match (&mut *self, newer) {
            (Self::Texels(texels), Self::Texels(more)) if texels.len() + more.len() <= MAX_TEXELS => {
                texels.extend(more);
            }
            _ => *self = Self::Everything,
        }
    }
}
