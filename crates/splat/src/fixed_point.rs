//! The integers that pictures are summed in.
//!
//! A sum of integers has no order: any number of threads, and adding and later subtracting, give the same bits. A
//! radiance of 1 over a whole pixel is 2²⁸ quanta; i64 then holds pixels up to 2³⁵ ≈ 3.4e10, and a wall of 1e-3 spread
//! over a circle of confusion of 150 px still deposits 15 quanta a pixel.

/// Quanta of a pixel of value 1.
pub const QUANTA: f64 = (1u64 << 28) as f64;

/// The brightest sample, as radiance times footprint density: more would leave the range of [`quantise`].
pub const BRIGHTEST: f64 = (1u64 << 22) as f64;

/// The largest pixel that is sure not to have wrapped, in units of 1.
pub const LARGEST_PIXEL: f64 = (1u64 << 34) as f64;

/// The nearest integer, ties to even, for |x| < 2⁵¹: adding 1.5·2⁵² leaves no room for a fraction.
#[inline(always)]
pub fn quantise(x: f64) -> i64 {
    const SHIFT: f64 = 6755399441055744.0;
    (x + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits()) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantise_rounds_to_nearest() {
        for x in [0.0, 0.49, -0.49, 0.51, -0.51, 1e15, -1e15, 123456.5, -7.0] {
            assert_eq!(quantise(x), f64::round_ties_even(x) as i64, "{x}");
        }
    }
}
