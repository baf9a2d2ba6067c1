//! A set of texels, one bit each.

/// A set of texels of a map: those that may be painted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TexelSet {
    size: [u32; 2],
    /// Row by row, lowest bit first; the unused bits of the last byte are 0.
    bytes: Vec<u8>,
}

impl TexelSet {
    /// The set of `texels` (column and row) of a map of width and height `size`; those outside it are dropped.
    pub fn new(size: [u32; 2], texels: impl Iterator<Item = [u32; 2]>) -> Self {
        let mut set = Self { size, bytes: vec![0; byte_count(size)] };
        for texel in texels {
            if let Some((byte, bit)) = set.bit_position(texel) {
                set.bytes[byte] |= 1 << bit;
            }
        }
        set
    }

    /// Columns and rows of texels of the map.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Whether a texel (column and row) is in it; false outside the map.
    pub fn contains(&self, texel: [u32; 2]) -> bool {
        self.bit_position(texel).is_some_and(|(byte, bit)| self.bytes[byte] >> bit & 1 == 1)
    }

    /// Byte and bit of a texel.
    fn bit_position(&self, [x, y]: [u32; 2]) -> Option<(usize, u32)> {
        let [width, height] = self.size;
        let index = y as usize * width as usize + x as usize;
        (x < width && y < height).then_some((index / 8, (index % 8) as u32))
    }

    /// Its form in a file.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        self.bytes.clone()
    }

    /// From its form in a file; `None` if the length is wrong or unused bits are set.
    pub(crate) fn from_bytes(size: [u32; 2], bytes: Vec<u8>) -> Option<Self> {
        let texels = u64::from(size[0]) * u64::from(size[1]);
        let spare = (8 - texels % 8) % 8;
        let is_clean = bytes.last().is_none_or(|last| u32::from(*last) >> (8 - spare) == 0);
        (bytes.len() == byte_count(size) && is_clean).then_some(Self { size, bytes })
    }
}

fn byte_count(size: [u32; 2]) -> usize {
    (size[0] as usize * size[1] as usize).div_ceil(8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_in_it_or_not_and_bytes_come_back() {
        let texels = [[0, 0], [4, 1], [2, 2], [9, 9]];
        let set = TexelSet::new([5, 3], texels.into_iter());
        let members: Vec<_> =
            (0..3).flat_map(|y| (0..5).map(move |x| [x, y])).filter(|t| set.contains(*t)).collect();
        assert_eq!(members, &texels[..3]);
        assert!(!set.contains([5, 0]) && !set.contains([0, 3]));
        let bytes = set.to_bytes();
        assert_eq!(bytes.len(), 2);
        assert_eq!(TexelSet::from_bytes([5, 3], bytes.clone()), Some(set));
        assert_eq!(TexelSet::from_bytes([5, 4], bytes.clone()), None);
        assert_eq!(TexelSet::from_bytes([5, 3], vec![bytes[0], bytes[1] | 0x80]), None, "a 16th texel");
        assert_eq!(TexelSet::from_bytes([4, 2], vec![0xff]).map(|set| set.contains([3, 1])), Some(true));
    }
}
