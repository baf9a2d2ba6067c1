//! From indices and a primitive mode to triangles (glTF 2.0 §3.7.2.1).

use gltf::mesh::Mode;

/// glTF's primitive modes.
pub(crate) const MODE_NAMES: [&str; 7] =
    ["points", "lines", "line loops", "line strips", "triangles", "triangle strips", "triangle fans"];

/// Number of triangles of `corners` corners; `None` for points and lines.
pub(crate) fn triangle_count(mode: Mode, corners: usize) -> Option<usize> {
    match mode {
        Mode::Triangles => Some(corners / 3),
        Mode::TriangleStrip | Mode::TriangleFan => Some(corners.saturating_sub(2)),
        _ => None,
    }
}

/// The corners of triangle `i`, for a mode that makes triangles.
pub(crate) fn triangle(mode: Mode, i: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
        Mode::TriangleFan => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_has_the_same_winding() {
        // A zigzag of points for the strip, a half circle for the fan: all triangles counter-clockwise.
        let zigzag = |k: usize| [(k / 2) as f64, (k % 2) as f64];
        let circle =
            |k: usize| if k == 0 { [0.0, 0.0] } else { [(k as f64 * 0.3).cos(), (k as f64 * 0.3).sin()] };
        let area = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        for i in 0..triangle_count(Mode::TriangleStrip, 8).unwrap() {
            // (0,0), (0,1), (1,0) runs clockwise, and so must its successors.
            assert!(area(triangle(Mode::TriangleStrip, i).map(zigzag)) < 0.0, "{i}");
        }
        for i in 0..triangle_count(Mode::TriangleFan, 8).unwrap() {
            assert!(area(triangle(Mode::TriangleFan, i).map(circle)) > 0.0, "{i}");
        }
    }

    #[test]
    fn counts() {
        assert_eq!(triangle_count(Mode::Triangles, 8), Some(2));
        assert_eq!(triangle_count(Mode::TriangleStrip, 2), Some(0));
        assert_eq!(triangle_count(Mode::TriangleFan, 0), Some(0));
        assert_eq!(triangle_count(Mode::Lines, 8), None);
    }
}
