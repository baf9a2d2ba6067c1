//! The painted surface: triangles in a tree for nearest-point queries.

use glam::{DVec2, DVec3};
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use scene::{Scene, SurfacePoint};

/// Minimum cosine of the angle between corresponding normals: an edge that a remesher has rounded still matches both of its faces.
const MIN_NORMAL_COSINE: f64 = 0.5;

/// Maximum number of nearest triangles that are tried for a similar normal, as in a crumpled place.
const MAX_CANDIDATES: usize = 256;

/// The painted surface, or a part of it.
pub(crate) struct OldSurface(RTree<IndexedTriangle>);

/// A triangle of the scene.
struct IndexedTriangle {
    index: u32,
    corners: [DVec3; 3],
    normal: DVec3,
}

/// The nearest point of the surface, and its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    pub point: SurfacePoint,
    /// In world space.
    pub position: DVec3,
    pub distance: f64,
}

impl OldSurface {
    /// The surface of some triangles of a scene; those without area are left out.
    pub fn new(scene: &Scene, triangles: impl Iterator<Item = u32>) -> Self {
        let indexed = triangles.filter_map(|index| {
            let normal = scene.area_normal(index).try_normalize()?;
            Some(IndexedTriangle { index, corners: scene.corners(index), normal })
        });
        Self(RTree::bulk_load(indexed.collect()))
    }

    /// The point nearest to `position` on a triangle with a similar normal, within the distance `limit`.
    pub fn nearest(&self, position: DVec3, normal: DVec3, limit: f64) -> Option<Nearest> {
        let mut candidates = self.0.nearest_neighbor_iter(&position.to_array()).take(MAX_CANDIDATES);
        let triangle = candidates.find(|triangle| triangle.normal.dot(normal) >= MIN_NORMAL_COSINE)?;
        let (barycentric, nearest_point) = closest_point_on_triangle(position, triangle.corners);
        let distance = nearest_point.distance(position);
        let point = SurfacePoint { triangle: triangle.index, barycentric };
        (distance <= limit).then_some(Nearest { point, position: nearest_point, distance })
    }
}

impl RTreeObject for IndexedTriangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.corners;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }
}

impl PointDistance for IndexedTriangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let point = DVec3::from_array(*point);
        closest_point_on_triangle(point, self.corners).1.distance_squared(point)
    }
}

/// The point of a triangle nearest to `p`: its barycentric coordinates of the second and third corner, and its position (Ericson, Real-Time
/// Collision Detection, 2005, 5.1.5).
fn closest_point_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec2, DVec3) {
    let (ab, ac) = (b - a, c - a);
    let point_at = |v: f64, w: f64| (DVec2::new(v, w), a + ab * v + ac * w);
    let (ap, bp, cp) = (p - a, p - b, p - c);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return point_at(0.0, 0.0);
    }
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return point_at(1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return point_at(d1 / (d1 - d3), 0.0);
    }
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return point_at(0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return point_at(0.0, d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return point_at(1.0 - w, w);
    }
    let sum = va + vb + vc;
    point_at(vb / sum, vc / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_a_triangle_is_closer_than_the_closest_point() {
        let corners = [DVec3::new(0.0, 0.0, 0.0), DVec3::new(2.0, 0.1, 0.3), DVec3::new(0.4, 1.5, -0.6)];
        for k in 0..400 {
            let turn = |prime: f64| (f64::from(k) * prime).fract() * 6.0 - 3.0;
            let p = DVec3::new(turn(0.618_034), turn(0.754_877), turn(0.569_840));
            let (DVec2 { x: v, y: w }, nearest_point) = closest_point_on_triangle(p, corners);
            assert!(v >= -1e-12 && w >= -1e-12 && v + w <= 1.0 + 1e-12, "{v} {w}");
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (v, w) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let other = corners[0] + (corners[1] - corners[0]) * v + (corners[2] - corners[0]) * w;
                    assert!(nearest_point.distance(p) <= other.distance(p) + 1e-9);
                }
            }
        }
    }
}
