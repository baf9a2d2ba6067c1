//! The false colours of blur: one diverging colour map for the paint view, the slider's track and the legend.
//!
//! Near blur is warm (orange), sharp a neutral light grey, far blur cool (blue). Orange and blue stay apart
//! under the common colour-blindnesses, and lightness falls on both sides, so that amount reads without hue.
//! The position on the map is logarithmic in the circle of confusion: the first pixels matter most.

use egui::{Color32, Mesh, Painter, Rect, Shape, pos2};
pub use lens::blur_scale::{LARGEST_CIRCLE_PX, circle_px, position};

/// The map's colours from the nearest blur over sharp to the farthest: sRGB-encoded, equally spaced.
pub const STOPS: [[f32; 3]; 7] = [
    [0.45, 0.15, 0.02],
    [0.80, 0.38, 0.05],
    [0.98, 0.71, 0.42],
    [0.94, 0.94, 0.93],
    [0.56, 0.77, 0.92],
    [0.20, 0.50, 0.80],
    [0.06, 0.22, 0.48],
];

/// The colour at a position of the map, sRGB-encoded.
pub fn color_at(position: f64) -> [f32; 3] {
    let last = STOPS.len() - 1;
    let at = (position.clamp(-1.0, 1.0) + 1.0) / 2.0 * last as f64;
    let index = (at as usize).min(last - 1);
    let share = (at - index as f64) as f32;
    std::array::from_fn(|c| STOPS[index][c] + (STOPS[index + 1][c] - STOPS[index][c]) * share)
}

/// The colour of a signed circle of confusion.
pub fn color(circle_px: f64) -> Color32 {
    let [r, g, b] = color_at(position(circle_px)).map(|c| (c * 255.0).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// The nearness map's colours, from far to near; also from few to many.
const FEW: [f32; 3] = [30.0, 50.0, 110.0];
const SEVERAL: [f32; 3] = [40.0, 150.0, 140.0];
const ALL: [f32; 3] = [250.0, 230.0, 90.0];

/// The colour of nearness, from far (0) to near (1), or of counts from few to many; sRGB-encoded, with
/// increasing lightness.
pub fn nearness_color(share: f32) -> [u8; 3] {
    let at = 2.0 * share.clamp(0.0, 1.0);
    let (from, to, share) = if at < 1.0 { (FEW, SEVERAL, at) } else { (SEVERAL, ALL, at - 1.0) };
    std::array::from_fn(|k| (from[k] + (to[k] - from[k]) * share + 0.5) as u8)
}

/// Draws the blur map as a bar, near on the left; `fade` below 1 for a disabled control.
pub fn paint_bar(painter: &Painter, rect: Rect, fade: f32) {
    let color = |[r, g, b]: [f32; 3]| {
        let [r, g, b] = [r, g, b].map(|c| (c * 255.0).round() as u8);
        Color32::from_rgb(r, g, b).gamma_multiply(fade)
    };
    paint_stops(painter, rect, &STOPS.map(color));
}

/// Draws the nearness map as a bar.
pub fn paint_nearness_bar(painter: &Painter, rect: Rect) {
    paint_stops(
        painter,
        rect,
        &[0.0, 0.5, 1.0].map(nearness_color).map(|[r, g, b]| Color32::from_rgb(r, g, b)),
    );
}

/// Draws colours, equally spaced and interpolated, as a bar.
fn paint_stops(painter: &Painter, rect: Rect, colors: &[Color32]) {
    let mut mesh = Mesh::default();
    let last = colors.len() - 1;
    for (index, &color) in colors.iter().enumerate() {
        let x = rect.left() + rect.width() * index as f32 / last as f32;
        mesh.colored_vertex(pos2(x, rect.top()), color);
        mesh.colored_vertex(pos2(x, rect.bottom()), color);
    }
    for k in 0..last as u32 {
        mesh.add_triangle(2 * k, 2 * k + 1, 2 * k + 2);
        mesh.add_triangle(2 * k + 1, 2 * k + 2, 2 * k + 3);
    }
    painter.add(Shape::mesh(mesh));
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::luminance;

    #[test]
    fn sharp_is_the_middle() {
        assert_eq!(color_at(0.0), STOPS[3]);
        let end = color_at(1.0).iter().zip(STOPS[6]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(end < 1e-6, "{end}");
    }

    #[test]
    fn amount_reads_without_hue() {
        for side in [-1.0, 1.0] {
            for step in 0..20 {
                let (a, b) = (step as f64 / 20.0, (step + 1) as f64 / 20.0);
                assert!(luminance(color_at(side * a)) > luminance(color_at(side * b)), "{side} {a}");
            }
        }
    }
}
