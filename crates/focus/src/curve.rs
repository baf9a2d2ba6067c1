//! A smooth curve through points that never overshoots them.

use serde::{Deserialize, Serialize};

/// A curve y(x) through points: a monotone cubic between them, constant beyond the first and the last.
///
/// Where neighbouring points rise, the curve rises; where they fall, it falls; it never overshoots (Fritsch and
/// Carlson 1980). The slope at a point is the harmonic mean of the slopes on its two sides, weighted by their lengths
/// (Fritsch and Butland 1984), and 0 at peaks and at both ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Curve {
    /// [x, y], x ascending.
    points: Vec<[f64; 2]>,
}

impl Curve {
    /// Maximum number of points of a curve.
    pub const MAX_POINTS: usize = 64;

    /// The curve through `points`, sorted by x; of several points at one x the last counts. `None` if there are no
    /// points, too many, or any that are not finite.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let mut sorted: Vec<[f64; 2]> = Vec::new();
        for point in points {
            let at = sorted.partition_point(|p| p[0] < point[0]);
            match sorted.get_mut(at).filter(|p| p[0] == point[0]) {
                Some(same) => *same = point,
                None => sorted.insert(at, point),
            }
        }
        let curve = Self { points: sorted };
        curve.is_valid().then_some(curve)
    }

    /// Whether it is a valid curve. [`Self::new`] makes no others, but a file may contain one.
    pub fn is_valid(&self) -> bool {
        (1..=Self::MAX_POINTS).contains(&self.points.len())
            && self.points.as_flattened().iter().all(|number| number.is_finite())
            && self.points.windows(2).all(|pair| pair[0][0] < pair[1][0])
    }

    /// The curve's points as [x, y], x ascending.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The curve's y at `x`; beyond its ends that of the nearest point.
    pub fn evaluate(&self, x: f64) -> f64 {
        let next = self.points.partition_point(|p| p[0] <= x);
        let (Some(after), Some(before)) = (self.points.get(next), next.checked_sub(1)) else {
            let nearest = next.saturating_sub(1).min(self.points.len() - 1);
            return self.points[nearest][1];
        };
        let [[x0, y0], [x1, y1]] = [self.points[before], *after];
        let (h, s) = (x1 - x0, (x - x0) / (x1 - x0));
        let (m0, m1) = (self.slope(before) * h, self.slope(next) * h);
        // Cubic Hermite, written from y0 so that equal ends give exactly their value.
        let (s2, s3) = (s * s, s * s * s);
        y0 + (y1 - y0) * (3.0 * s2 - 2.0 * s3) + m0 * (s3 - 2.0 * s2 + s) + m1 * (s3 - s2)
    }

    /// The slope at a point.
    fn slope(&self, k: usize) -> f64 {
        let side = |k: usize| {
            let [[x0, y0], [x1, y1]] = [*self.points.get(k)?, *self.points.get(k + 1)?];
            Some((x1 - x0, (y1 - y0) / (x1 - x0)))
        };
        match (k.checked_sub(1).and_then(side), side(k)) {
            (Some((h0, d0)), Some((h1, d1))) if d0 * d1 > 0.0 => {
                let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
                (w0 + w1) / (w0 / d0 + w1 / d1)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_through_its_points_and_stays_between_them() {
        let points = [[0.0, 1.0], [1.0, 1.0], [2.0, 5.0], [2.5, 5.2], [4.0, -1.0]];
        let curve = Curve::new(points).unwrap();
        for [x, y] in points {
            assert!((curve.evaluate(x) - y).abs() < 1e-12);
        }
        for pair in points.windows(2) {
            let mut last = pair[0][1];
            for k in 0..=100 {
                let x = pair[0][0] + (pair[1][0] - pair[0][0]) * k as f64 / 100.0;
                let y = curve.evaluate(x);
                assert!(
                    (y - last) * (pair[1][1] - pair[0][1]) >= -1e-12,
                    "monotone between {pair:?}: {last} then {y}"
                );
                last = y;
            }
        }
        assert_eq!(curve.evaluate(0.5), 1.0, "level between equal points");
        assert_eq!((curve.evaluate(-9.0), curve.evaluate(9.0)), (1.0, -1.0));
    }

    #[test]
    fn a_straight_row_of_points_is_straight_inside() {
        let curve = Curve::new((0..6).map(|k| [k as f64, 2.0 * k as f64])).unwrap();
        for x in [1.25, 2.5, 3.75] {
            assert!((curve.evaluate(x) - 2.0 * x).abs() < 1e-12);
        }
    }

    #[test]
    fn bad_points_make_no_curve() {
        assert!(Curve::new([]).is_none());
        assert!(Curve::new([[0.0, f64::NAN]]).is_none());
        assert!(Curve::new([[f64::INFINITY, 0.0]]).is_none());
        assert!(Curve::new((0..65).map(|k| [k as f64, 0.0])).is_none());
        let last = Curve::new([[1.0, 2.0], [0.0, 0.0], [1.0, 3.0]]).unwrap();
        assert_eq!(last.points(), [[0.0, 0.0], [1.0, 3.0]]);
        let from_file: Curve = serde_json::from_str("[[1.0, 0.0], [0.0, 0.0]]").unwrap();
        assert!(!from_file.is_valid());
    }
}
