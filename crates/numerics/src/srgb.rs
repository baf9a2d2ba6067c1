//! The sRGB transfer function.

use std::sync::LazyLock;

/// Entries of the table of levels. Even in the shadows, an 8-bit step is at least three entries wide.
const ENTRIES: usize = 1 << 13;

/// The sRGB encoding (IEC 61966-2-1) of a linear value; linear below 0, as it is near 0.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear value of an sRGB-encoded one (IEC 61966-2-1), both in [0, 1].
pub fn linear_from_srgb(v: f64) -> f32 {
    (if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
}

/// The 8-bit sRGB level of linear light, by a table of [0, 1] in 8192 cells, each of which has the level of its middle. Below 0 and NaN: 0; above
/// 1: 255.
#[inline(always)]
pub fn screen_level(linear: f32) -> u8 {
    static LEVELS: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let level = |k| (srgb_from_linear((k as f32 + 0.5) / ENTRIES as f32) * 255.0).round() as u8;
        (0..ENTRIES).map(level).collect()
    });
    LEVELS[((linear.max(0.0) * ENTRIES as f32) as usize).min(ENTRIES - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_the_curve() {
        for k in 0..=1000 {
            let linear = k as f32 / 1000.0;
            let exact = srgb_from_linear(linear) * 255.0;
            assert!((f32::from(screen_level(linear)) - exact).abs() <= 0.8, "{linear}");
        }
        assert_eq!([f32::NAN, -1.0, 0.0, 7.0, f32::INFINITY].map(screen_level), [0, 0, 0, 255, 255]);
    }
}
