//! The sRGB transfer function.

/// The sRGB encoding (IEC 61966-2-1) of a linear value; linear below 0, as it is near 0.
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear value of an sRGB-encoded one (IEC 61966-2-1), both in [0, 1].
pub fn linear_from_srgb(v: f64) -> f32 {
    (if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }) as f32
}
