//! The scale of blur: signed circles of confusion as positions from near to far, as false colours and sliders show them.
//!
//! It is logarithmic, because the first pixels matter most.

/// The circle of confusion at the ends of the scale, px.
pub const LARGEST_CIRCLE_PX: f64 = 96.0;

/// Where a signed circle of confusion (px; negative near, positive far) lies on the scale, in [−1, 1]:
///
/// ```text
/// sign(c)·ln(1 + |c|) / ln(1 + LARGEST_CIRCLE_PX)
/// ```
pub fn position(circle_px: f64) -> f64 {
    (circle_px.abs().ln_1p() / LARGEST_CIRCLE_PX.ln_1p()).min(1.0) * circle_px.signum()
}

/// The signed circle of confusion at a position of the scale. Inverse of [`position`] on [−1, 1].
pub fn circle_px(position: f64) -> f64 {
    (position.abs() * LARGEST_CIRCLE_PX.ln_1p()).exp_m1() * position.signum()
}

/// The byte for paint that blurs by a signed circle of confusion: 1 (near) over 128 (sharp) to 255 (far). `None`, what is not painted, is 0.
pub fn paint_code(circle_px: Option<f64>) -> u8 {
    circle_px.map_or(0, |circle_px| (128.0 + 127.0 * position(circle_px)).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_inverts() {
        assert_eq!(position(0.0), 0.0);
        for px in [-96.0, -4.0, -0.25, 0.5, 16.0, 90.0] {
            assert!((circle_px(position(px)) - px).abs() < 1e-9, "{px}");
        }
        assert_eq!(position(-1e9), -1.0);
        assert_eq!([Some(-1e9), Some(0.0), Some(1e9), None].map(paint_code), [1, 128, 255, 0]);
    }
}
