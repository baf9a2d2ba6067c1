//! A chart rotated into its smallest bounding box, ready for the packer.

use crate::packing::unpacked_chart::UnpackedChart;
use glam::DVec2;

/// A chart rotated into its smallest bounding box, which starts at 0 and is at least as wide as high.
pub(crate) struct BoxedChart {
    corners: Vec<[DVec2; 3]>,
    /// Its extent, world lengths.
    pub size: DVec2,
}

impl BoxedChart {
    /// Rotates a chart into its smallest bounding box, if it may be rotated.
    pub fn new(chart: &UnpackedChart) -> Self {
        let axis = if chart.can_rotate { smallest_box_axis(&chart.corners) } else { DVec2::X };
        let turn = |c: DVec2| DVec2::new(c.dot(axis), axis.perp_dot(c));
        let mut corners: Vec<[DVec2; 3]> = chart.corners.iter().map(|t| t.map(turn)).collect();
        let low = corners.iter().flatten().fold(DVec2::INFINITY, |low, &c| low.min(c));
        corners.iter_mut().flatten().for_each(|c| *c -= low);
        let mut size = corners.iter().flatten().fold(DVec2::ZERO, |high, &c| high.max(c));
        if size.y > size.x {
            corners.iter_mut().flatten().for_each(|c| *c = DVec2::new(size.y - c.y, c.x));
            size = DVec2::new(size.y, size.x);
        }
        Self { corners, size }
    }

    /// Texels per world length: the density, but more for a chart that would be shorter than a texel, which takes a
    /// whole texel anyway.
    pub fn scale(&self, density: f64) -> f64 {
        if self.size.x > 0.0 { density.max(1.0 / self.size.x) } else { density }
    }

    /// Its triangles after `turns` quarter turns, in texels from 0 on, at `density` texels per scene unit.
    pub fn rotated(&self, density: f64, turns: u32) -> impl Iterator<Item = [DVec2; 3]> + Clone {
        let scale = self.scale(density);
        let size = self.size * scale;
        let turn = move |c: DVec2| match turns {
            0 => c,
            1 => DVec2::new(size.y - c.y, c.x),
            2 => size - c,
            _ => DVec2::new(c.y, size.x - c.x),
        };
        self.corners.iter().map(move |t| t.map(|c| turn(c * scale).max(DVec2::ZERO)))
    }
}

/// The axis of the smallest bounding box of some triangles: along an edge of their convex hull.
fn smallest_box_axis(triangles: &[[DVec2; 3]]) -> DVec2 {
    let hull = convex_hull(triangles.iter().flatten().copied().collect());
    let mut best = (f64::INFINITY, DVec2::X);
    for (i, &from) in hull.iter().enumerate() {
        let Some(axis) = (hull[(i + 1) % hull.len()] - from).try_normalize() else { continue };
        let (low, high) = hull.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), c| {
            let c = DVec2::new(c.dot(axis), axis.perp_dot(*c));
            (low.min(c), high.max(c))
        });
        let area = (high - low).element_product();
        if area < best.0 {
            best = (area, axis);
        }
    }
    best.1
}

/// The convex hull (Andrew's monotone chain).
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    for pass in 0..2 {
        let start = hull.len();
        for &p in &points {
            while hull.len() >= start + 2
                && (hull[hull.len() - 1] - hull[hull.len() - 2]).perp_dot(p - hull[hull.len() - 2]) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
        if pass == 0 {
            points.reverse();
        }
    }
    if hull.is_empty() { points } else { hull }
}
