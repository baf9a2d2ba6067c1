//! The header of SPZ.

/// What a file says of itself.
pub(super) struct Header {
    pub version: u32,
    pub count: u32,
    pub degree: u32,
    pub fractional_bits: u8,
    pub is_antialiased: bool,
    pub has_extensions: bool,
}

impl Header {
    /// Bytes of a splat's mean.
    pub fn mean_bytes(&self) -> u64 {
        if self.version == 1 { 6 } else { 9 }
    }

    /// Bytes of a splat's rotation.
    pub fn rotation_bytes(&self) -> u64 {
        if self.version < 3 { 3 } else { 4 }
    }
}
