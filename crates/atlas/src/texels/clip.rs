//! Cutting convex polygons at axis-aligned lines.

use glam::DVec2;

/// Corners a triangle can have after four cuts (seven), with two to spare.
const CAPACITY: usize = 9;

/// A convex polygon of few corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    corners: [DVec2; CAPACITY],
    len: usize,
}

impl Polygon {
    /// No corners.
    fn empty() -> Self {
        Self { corners: [DVec2::ZERO; CAPACITY], len: 0 }
    }

    /// The polygon of a triangle.
    pub fn triangle(corners: [DVec2; 3]) -> Self {
        let mut polygon = Self::empty();
        corners.into_iter().for_each(|c| polygon.push(c));
        polygon
    }

    fn push(&mut self, corner: DVec2) {
        // A triangle cut four times has at most seven corners. Rounding cannot add more: each cut evaluates the sign
        // of each corner once and so crosses at most twice.
        if self.len < CAPACITY {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// The polygon's corners, in order.
    pub fn corners(&self) -> &[DVec2] {
        &self.corners[..self.len]
    }

    /// The parts below and above the line where coordinate `axis` (0: x, 1: y) equals `at`.
    pub fn split(&self, axis: usize, at: f64) -> (Polygon, Polygon) {
        let (mut below, mut above) = (Self::empty(), Self::empty());
        let corners = self.corners();
        let Some(&last) = corners.last() else { return (below, above) };
        let mut from = last;
        for &to in corners {
            let (d0, d1) = (from[axis] - at, to[axis] - at);
            if (d0 < 0.0 && d1 > 0.0) || (d0 > 0.0 && d1 < 0.0) {
                let mut crossing = from + (to - from) * (d0 / (d0 - d1));
                crossing[axis] = at;
                below.push(crossing);
                above.push(crossing);
            }
            if d1 <= 0.0 {
                below.push(to);
            }
            if d1 >= 0.0 {
                above.push(to);
            }
            from = to;
        }
        (below, above)
    }

    /// Signed area (positive if the corners run from x to y) and centroid. The centroid of a polygon without area is
    /// the mean of its corners.
    pub fn area_and_centroid(&self) -> (f64, DVec2) {
        let corners = self.corners();
        let Some(&origin) = corners.first() else { return (0.0, DVec2::ZERO) };
        let (mut twice_area, mut moment) = (0.0, DVec2::ZERO);
        for pair in corners[1..].windows(2) {
            let (b, c) = (pair[0] - origin, pair[1] - origin);
            let cross = b.perp_dot(c);
            twice_area += cross;
            moment += (b + c) * cross;
        }
        if twice_area == 0.0 {
            return (0.0, corners.iter().sum::<DVec2>() / corners.len() as f64);
        }
        (0.5 * twice_area, origin + moment / (3.0 * twice_area))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_sides_sum_to_the_whole() {
        let whole = Polygon::triangle([DVec2::new(0.3, 0.1), DVec2::new(5.0, 1.7), DVec2::new(2.2, 4.9)]);
        let (area, centroid) = whole.area_and_centroid();
        for (axis, at) in [(0, 1.0), (0, 2.2), (1, 3.0), (1, 1.7)] {
            let (below, above) = whole.split(axis, at);
            let ((a0, c0), (a1, c1)) = (below.area_and_centroid(), above.area_and_centroid());
            assert!((a0 + a1 - area).abs() < 1e-14 && a0 > 0.0 && a1 > 0.0);
            assert!((c0 * a0 + c1 * a1 - centroid * area).length() < 1e-13);
        }
    }

    #[test]
    fn a_line_beside_it_leaves_one_side_empty() {
        let whole = Polygon::triangle([DVec2::ZERO, DVec2::X, DVec2::Y]);
        let (below, above) = whole.split(0, 0.0);
        assert_eq!(below.area_and_centroid().0, 0.0);
        assert_eq!(above.area_and_centroid().0, 0.5);
    }
}
