//! Texels as bytes: f32, little endian.

/// The numbers; incomplete ones at the end are dropped.
pub(crate) fn floats_from_bytes(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word)).collect()
}

/// The bytes of numbers. Inverse of [`floats_from_bytes`].
pub(crate) fn bytes_from_floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// The numbers in pairs.
pub(crate) fn pairs_from_bytes(bytes: &[u8]) -> Vec<[f32; 2]> {
    bytes
        .as_chunks::<8>()
        .0
        .iter()
        .map(|[a, b, c, d, e, f, g, h]| [[*a, *b, *c, *d], [*e, *f, *g, *h]].map(f32::from_le_bytes))
        .collect()
}
