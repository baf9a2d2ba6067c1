//! The plane that samples lie on.

use half::f16;

/// A triangle, and how the weight of what lies on it changes over the aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(C, packed(2))]
pub(crate) struct Plane {
    pub triangle: u32,
    /// Toward the aperture's centre, and its change with u and v, as half floats: for cells as a share of their
    /// weight alone, for patches of their largest.
    pub weights: [u16; 3],
}

impl Plane {
    pub const BYTES: usize = size_of::<Self>();
    /// The triangle number of the background, seen through partly transparent surfaces.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// The plane as stored in a file, little endian.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..4].copy_from_slice(&{ self.triangle }.to_le_bytes());
        let weights = self.weights;
        for (place, weight) in bytes[4..].chunks_mut(2).zip(weights) {
            place.copy_from_slice(&weight.to_le_bytes());
        }
        bytes
    }

    /// The plane from its bytes in a file; the inverse of [`Self::to_bytes`].
    pub fn from_bytes([a, b, c, d, w0, w1, u0, u1, v0, v1]: [u8; Self::BYTES]) -> Self {
        let weights = [[w0, w1], [u0, u1], [v0, v1]].map(u16::from_le_bytes);
        Self { triangle: u32::from_le_bytes([a, b, c, d]), weights }
    }

    pub(super) fn weights(&self) -> [f32; 3] {
        { self.weights }.map(|bits| f16::from_bits(bits).to_f32())
    }
}
