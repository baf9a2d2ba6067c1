//! Edges within pixels: a straight line that separates foreground and background.
//!
//! The coverage of a pixel, and of those around it, determines a line (Youngs, *Time-dependent multi-material flow*, 1982): perpendicular to
//! the gradient of coverage, and placed so that it leaves the pixel's coverage on its side. If that line also reproduces the coverage of
//! the pixels around, the edge is straight there. Otherwise, at hair, corners and gaps, there is no line.

use glam::Vec2;

/// The largest mean error of the coverage of the pixels around.
const MAX_MEAN_ERROR: f32 = 0.12;
/// Bisections until a line has the right coverage: finer than coverage is quantised.
const HALVINGS: usize = 24;

/// The corners of a pixel, counter-clockwise as the picture shows them.
const PIXEL: [Vec2; 4] = [Vec2::new(0.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)];

/// The foreground part of a pixel, by its coverage and that of the pixels around, row by row: corners in it, x right, y down,
/// counter-clockwise as the picture shows them.
pub(crate) fn fit_outline(shares: &[[f32; 3]; 3]) -> Option<Vec<Vec2>> {
    let rise = |at: &dyn Fn(usize, usize) -> f32| {
        (0..3).map(|k| [1.0, 2.0, 1.0][k] * (at(k, 2) - at(k, 0))).sum::<f32>()
    };
    let rise = Vec2::new(rise(&|k, end| shares[k][end]), rise(&|k, end| shares[end][k]));
    let normal = rise.try_normalize()?;
    // The extent of a pixel along the normal.
    let [mut low, mut high] = [-1.5, 1.5];
    let corner = Vec2::splat(0.5);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match area(&clip(Vec2::ZERO, normal, corner, middle)) > shares[1][1] {
            true => low = middle,
            false => high = middle,
        }
    }
    let mut mean_error = 0.0;
    for (y, row) in shares.iter().enumerate() {
        for (x, share) in row.iter().enumerate() {
            let pixel = Vec2::new(x as f32 - 1.0, y as f32 - 1.0);
            mean_error += (area(&clip(pixel, normal, corner, low)) - share).abs() / 8.0;
        }
    }
    let outline = clip(Vec2::ZERO, normal, corner, low);
    (mean_error <= MAX_MEAN_ERROR && outline.len() >= 3).then_some(outline)
}

/// The part of a pixel with this upper left corner whose distance from `from` along a normal is at least `far`.
fn clip(pixel: Vec2, normal: Vec2, from: Vec2, far: f32) -> Vec<Vec2> {
    let height = |place: Vec2| (place - from).dot(normal) - far;
    let mut left = Vec::with_capacity(5);
    for k in 0..4 {
        let [a, b] = [PIXEL[k] + pixel, PIXEL[(k + 1) % 4] + pixel];
        let [of_a, of_b] = [height(a), height(b)];
        if of_a >= 0.0 {
            left.push(a);
        }
        if (of_a >= 0.0) != (of_b >= 0.0) {
            let crossing = a + (b - a) * (of_a / (of_a - of_b));
            // A line through a corner adds it once.
            if left.last() != Some(&crossing) && crossing != b {
                left.push(crossing);
            }
        }
    }
    left
}

/// The area of a polygon.
fn area(corners: &[Vec2]) -> f32 {
    let Some(&first) = corners.first() else { return 0.0 };
    corners.array_windows().map(|&[a, b]| 0.5 * (b - first).perp_dot(a - first)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coverage of a line perpendicular to an angle, at this distance from the middle.
    fn shares(angle: f32, far: f32) -> [[f32; 3]; 3] {
        let share_at = |x: usize, y: usize| {
            let pixel = Vec2::new(x as f32 - 1.0, y as f32 - 1.0);
            area(&clip(pixel, Vec2::from_angle(angle), Vec2::splat(0.5), far))
        };
        std::array::from_fn(|y| std::array::from_fn(|x| share_at(x, y)))
    }

    #[test]
    fn a_straight_edge_is_located() {
        for step in 0..40 {
            let (angle, far) = (0.37 * step as f32, 0.4 * (0.61 * step as f32).sin());
            let shares = shares(angle, far);
            let outline = fit_outline(&shares).expect("it is straight");
            assert!((area(&outline) - shares[1][1]).abs() < 1e-4, "{} {}", area(&outline), shares[1][1]);
            // Between the true line and the fitted one lies little.
            let normal = Vec2::from_angle(angle);
            let error = outline.iter().map(|place| far - (*place - 0.5).dot(normal)).fold(0.0, f32::max);
            assert!(error < 0.12, "{error} at {angle} {far}");
        }
    }

    #[test]
    fn hair_and_corners_have_no_line() {
        assert_eq!(fit_outline(&[[0.0, 0.5, 0.0]; 3]), None, "a hair");
        assert_eq!(fit_outline(&[[0.0; 3], [0.0, 0.4, 0.0], [0.0; 3]]), None, "a speck");
        assert_eq!(fit_outline(&[[1.0, 0.3, 1.0]; 3]), None, "a gap");
        assert_eq!(
            fit_outline(&[[0.0, 0.0, 0.0], [0.0, 0.3, 0.3], [0.0, 0.0, 0.0]]),
            None,
            "the end of a hair"
        );
    }
}
