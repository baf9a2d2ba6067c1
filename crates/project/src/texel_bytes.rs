//! Texels as bytes: f32, little endian.

/// The numbers; bytes that are left over make no number.
pub(crate) fn floats_from_bytes(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word)).collect()
}

/// The bytes of numbers. Inverse of [`floats`].
pub(crate) fn bytes_from_floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// The numbers two by two.
pub(crate) fn pairs_from_bytes(bytes: &[u8]) -> Vec<[f32; 2]> {
    bytes
        .as_chunks::<8>()
        .0
        .iter()
        .map(|[a, b, c, d, e, f, g, h]| [[*a, *b, *c, *d], [*e, *f, *g, *h]].map(f32::from_le_bytes))
        .collect()
}
