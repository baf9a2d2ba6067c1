//! A square footprint on a grid of pixels.

use glam::DVec2;

/// Calls `add` with each pixel (column, row) of `width` × `height` that a square of side `side` about `center` (px) covers, and with the share of the square that
/// lies in it.
pub(crate) fn cover_pixels(
    center: DVec2,
    side: f64,
    columns: std::ops::Range<i64>,
    rows: std::ops::Range<i64>,
    mut add: impl FnMut(i64, i64, f64),
) {
    let (from, to) = (center - side / 2.0, center + side / 2.0);
    let area = 1.0 / (side * side);
    // Casts saturate: what lands infinitely far away covers nothing.
    let span = |from: f64, to: f64, range: &std::ops::Range<i64>| {
        (from.floor() as i64).max(range.start)..(to.floor() as i64).min(range.end - 1) + 1
    };
    for row in span(from.y, to.y, &rows) {
        let height = to.y.min(row as f64 + 1.0) - from.y.max(row as f64);
        for column in span(from.x, to.x, &columns) {
            let width = to.x.min(column as f64 + 1.0) - from.x.max(column as f64);
            add(column, row, width * height * area);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_one_inside() {
        for center in [DVec2::new(2.0, 3.0), DVec2::new(2.25, 3.75), DVec2::new(4.1, 1.9)] {
            let (mut sum, mut moment) = (0.0, DVec2::ZERO);
            cover_pixels(center, 0.5, 0..8, 0..8, |column, row, share| {
                sum += share;
                moment += share * DVec2::new(column as f64, row as f64);
            });
            assert!((sum - 1.0).abs() < 1e-12);
            assert!((moment + 0.5 - center).abs().max_element() < 0.51);
        }
    }

    #[test]
    fn what_lies_outside_covers_nothing() {
        for center in [DVec2::new(-3.0, 2.0), DVec2::new(1e300, 0.0), DVec2::new(f64::NEG_INFINITY, 1.0)] {
            cover_pixels(center, 0.5, 0..8, 0..8, |_, _, _| panic!("{center}"));
        }
        let mut sum = 0.0;
        cover_pixels(DVec2::new(0.0, 4.5), 0.5, 0..8, 0..8, |_, _, share| sum += share);
        assert_eq!(sum, 0.5);
    }
}
