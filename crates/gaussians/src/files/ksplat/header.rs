//! The header of a `.ksplat`.

use super::super::bytes::{f32_at, u16_at, u32_at};

pub(super) const HEADER_BYTES: usize = 4096;

/// What holds for all sections.
pub(super) struct Header {
    pub sections: u64,
    pub count: u32,
    pub level: Level,
    /// What the bytes of coefficients lie between.
    pub coefficient_range: [f32; 2],
}

/// How numbers are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    Floats,
    Halves,
    Bytes,
}

impl Header {
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let bytes = bytes.get(..HEADER_BYTES)?;
        let level = match u16_at(bytes, 20) {
            0 => Level::Floats,
            1 => Level::Halves,
            2 => Level::Bytes,
            _ => return None,
        };
        let range = [f32_at(bytes, 36), f32_at(bytes, 40)];
        let is_set = range.iter().all(|end| end.is_finite()) && range[0] < range[1];
        let header = Self {
            sections: u32_at(bytes, 4).into(),
            count: u32_at(bytes, 16),
            level,
            coefficient_range: if is_set { range } else { [-1.5, 1.5] },
        };
        // Version 0.1 is the only one there is.
        (bytes[0] == 0 && bytes[1] >= 1).then_some(header)
    }
}
