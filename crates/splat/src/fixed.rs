//! The arithmetic of the sum: what 32-bit integers, and products of two of them, can do.
//!
//! A shader has no wider integers. Everything between a placed node and the accumulators is made of these functions, and
//! `fixed.wgsl` has the same functions under the same names.

/// One as a share.
pub const ONE: i32 = 1 << 14;

/// All of the light as a share: shares of light are multiples of 2⁻²⁴.
pub const WHOLE: u32 = 1 << 24;

/// 2³² over the golden ratio: its multiples, modulo 2³², are spread evenly.
pub const GOLDEN: u32 = 0x9E37_79B1;

/// ⌊a·b / 2^`shift`⌋, its lower 32 bits; `shift` ≤ 63.
#[inline(always)]
pub fn mul_shift(a: u32, b: u32, shift: u32) -> u32 {
    ((a as u64 * b as u64) >> shift) as u32
}

/// a·b / 2^`shift`, rounded toward zero: alike for either sign.
#[inline(always)]
pub fn signed_mul_shift(a: i32, b: i32, shift: u32) -> i32 {
    let size = mul_shift(a.unsigned_abs(), b.unsigned_abs(), shift) as i32;
    if (a ^ b) < 0 { -size } else { size }
}

/// ⌊x⌋ of 0 ≤ x < 2³²: without what `as` does for other numbers, several are made at a time.
#[inline(always)]
pub fn floored(x: f64) -> u32 {
    // Sums of this size have no digits behind the point.
    const SIZE: f64 = (1u64 << 52) as f64;
    (x.floor() + SIZE).to_bits() as u32
}

/// ⌊√x⌋, exact.
#[inline(always)]
pub fn integer_sqrt(x: u32) -> u32 {
    (x as f64).sqrt() as u32
}

/// √(a² + b² − less) for a, b < 2²⁰, in 15 bits; 0 if that is negative.
#[inline(always)]
pub fn hypotenuse(a: u32, b: u32, less: u32) -> u32 {
    let shift = 17u32.saturating_sub((a | b).leading_zeros());
    let (a, b) = (a >> shift, b >> shift);
    integer_sqrt((a * a + b * b).saturating_sub(less >> (2 * shift))) << shift
}

/// ⌊numerator·2²⁴ / denominator⌋, at most `most` ≥ 1 times 2²⁴; both below 2²⁶, `most` below 2⁷.
#[inline(always)]
pub fn ratio(numerator: u32, denominator: u32, most: u32) -> u32 {
    let [numerator, denominator, most] = [numerator, denominator.max(1), most].map(|x| x as i32 as f64);
    // The quotient is further below the next integer, by 1/denominator at least, than it is rounded: by 2⁵⁰/denominator
    // times 2⁻⁵³.
    floored((numerator * (1 << 24) as f64 / denominator).min(most * (1 << 24) as f64))
}

/// 2 to 31 + `bits` over a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reciprocal {
    /// From 2²⁶ (for 2¹⁸) to 2³¹.
    pub value: u32,
    pub bits: u32,
}

impl Reciprocal {
    /// The reciprocal of a number from 1 to 2¹⁸.
    #[inline(always)]
    pub fn new(number: u32) -> Self {
        let size = number.ilog2();
        let bits = size.min(30 - size);
        Self { value: ((1u64 << (31 + bits)) / number as u64) as u32, bits }
    }
}

/// A divisor of up to 30 bits, of which the first 16 count.
#[derive(Clone, Copy, Debug)]
pub struct Divisor {
    shift: u32,
    /// 2³¹ over what is left.
    reciprocal: u32,
}

impl Divisor {
    /// A divisor, which must be ≥ 1.
    #[inline(always)]
    pub fn new(divisor: u32) -> Self {
        let shift = 16u32.saturating_sub(divisor.leading_zeros());
        Self { shift, reciprocal: (1 << 31) / (divisor >> shift) }
    }

    /// x·2¹⁴ / divisor, rounded toward zero and limited to ±2¹⁵.
    #[inline(always)]
    pub fn divide(self, x: i32) -> i32 {
        let size = mul_shift(x.unsigned_abs() >> self.shift, self.reciprocal, 17).min(1 << 15) as i32;
        if x < 0 { -size } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floored_numbers_are_those_of_as() {
        for x in [0.0, 0.3, 0.999, 1.0, 1.5, 77.9999, 2147483647.5, 4294967295.0, 4294967295.9] {
            assert_eq!(floored(x), x as u32, "{x}");
        }
    }

    #[test]
    fn roots_are_exact_to_their_bits() {
        for x in [0, 1, 3, 4, 15, 16, 65535, 65536, 1 << 30, (46340 * 46340) - 1, 46340 * 46340, u32::MAX] {
            let root = integer_sqrt(x) as u64;
            assert!(root * root <= x as u64 && (root + 1) * (root + 1) > x as u64, "{x}");
        }
        for (a, b) in [(0, 0), (3, 4), (4096, 5000), (32767, 32767), (65535, 131072), (1 << 19, 77)] {
            let exact = (a as f64).hypot(b as f64);
            let found = hypotenuse(a, b, 0) as f64;
            assert!((found - exact).abs() <= 1.0 + exact / 8192.0, "{a} {b}: {found} {exact}");
            let most = a.max(b).min((1 << 15) - 1);
            assert_eq!(hypotenuse(a.min(most), b.min(most), u32::MAX), 0);
            let found = hypotenuse(a, b, most * most) as f64;
            let exact = (exact * exact - (most * most) as f64).sqrt();
            assert!((found - exact).abs() <= 2.0 + exact / 4096.0, "{a} {b} less {most}: {found} {exact}");
        }
    }

    #[test]
    fn divisions_are_near() {
        for divisor in [1u32, 77, 4096, 65535, 65537, 1 << 20, (1 << 30) - 3] {
            for share in [-1.5, -1.0, -0.3, 0.0, 0.01, 0.9, 1.99] {
                let x = (divisor as f64 * share) as i32;
                let exact = x as f64 / divisor as f64 * 16384.0;
                let found = Divisor::new(divisor).divide(x) as f64;
                assert!(
                    (found - exact).abs() <= 1.0 + exact.abs() / 16384.0,
                    "{divisor} {x}: {found} {exact}"
                );
            }
        }
        for number in [1u32, 3, 128, 4096, 40961, 65535, 131073, 1 << 18] {
            let found = Reciprocal::new(number);
            let exact = (1u64 << (31 + found.bits)) as f64 / number as f64;
            assert!(
                (found.value as f64 - exact).abs() <= 1.0 && found.value >= 1 << 25,
                "{number}: {found:?}"
            );
        }
        assert_eq!(ratio(1 << 23, 1 << 24, 4), 1 << 23);
        assert_eq!(ratio(1 << 25, 3, 4), 4 << 24);
        assert_eq!((signed_mul_shift(-3, 5, 1), signed_mul_shift(3, 5, 1)), (-7, 7));
    }
}
