//! Where the pixel rows of an image lie in the aperture.

use crate::canvas::PIXEL;
use crate::character::node_shape::ImageRow;
use crate::draw::image::Image;
use crate::fixed::{GOLDEN, ONE};

/// Where the rows of an image lie in the aperture.
pub struct ImageFrame {
    center: [i32; 2],
    radius: i32,
    v_deviation: i32,
    part_width: i32,
    dither: u32,
}

impl ImageFrame {
    /// The frame of an image whose aperture has this signed radius on it, 1/4096 px.
    pub fn new(image: &Image, radius: i32) -> Self {
        let size = radius.unsigned_abs().max(1);
        let radius = if image.radius < 0 { -(size as i32) } else { size as i32 };
        // Half a pixel over √3.
        let v_deviation =
            (f64::from(PIXEL) / 2.0 / 3f64.sqrt() * f64::from(ONE) / f64::from(size)).min(f64::from(ONE));
        let is_alone = image.node.is_highlight || image.node.is_bright;
        // Where many images lie over each other, the steps of none are visible.
        let part_width = if is_alone { PIXEL } else { PIXEL.max(size as i32 / 2) };
        Self {
            center: image.center,
            radius,
            v_deviation: v_deviation as i32,
            part_width,
            dither: image.dither,
        }
    }

    /// A row of it with light in `span`, at the height `v` or that of the row's middle.
    #[inline(always)]
    pub fn row(&self, row: i32, v: Option<i32>, span: [i32; 2]) -> ImageRow {
        let middle = || {
            let down = i64::from(row) * i64::from(PIXEL) + i64::from(PIXEL / 2);
            let v = ((i64::from(self.center[1]) - down) << 14) / i64::from(self.radius);
            v.clamp(-i64::from(ONE), i64::from(ONE)) as i32
        };
        ImageRow {
            center: self.center[0],
            radius: self.radius,
            v: v.unwrap_or_else(middle),
            v_deviation: self.v_deviation,
            span,
            part_width: self.part_width,
            dither: self.dither.wrapping_add((row as u32).wrapping_mul(GOLDEN)),
        }
    }
}
