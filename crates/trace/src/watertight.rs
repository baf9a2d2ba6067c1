//! The watertight ray–triangle test, in f64.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Corners are moved to the
//! ray's origin and sheared so that the ray becomes the z axis; then the signs of three edge functions decide
//! whether the origin of that plane lies in the triangle. A corner's sheared position depends on the ray and
//! the corner alone, an edge function fl(x₁y₂) − fl(y₁x₂) changes exactly its sign when its corners are
//! swapped, and rounding is monotonic, so it never has the wrong sign (at worst it is 0, which counts as
//! inside). Two triangles that share an edge therefore never both miss a ray that crosses it. This needs
//! every product rounded by itself: no fused multiply-add.

use glam::{DVec2, DVec3};

/// A ray, prepared for the test of many triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    origin: DVec3,
    /// The axis along which the direction is longest, and the two others.
    axes: [usize; 3],
    /// dx/dz, dy/dz, 1/dz of the direction along those axes.
    shear: [f64; 3],
}

/// Where the line of a ray crosses a triangle: t and the weights b₁, b₂ of the second and third corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub t: f64,
    pub barycentric: DVec2,
    /// Whether the ray comes from the triangle's front: from where its corners run counter-clockwise.
    pub from_front: bool,
}

impl ShearedRay {
    /// How many triangles [`Self::may_cross`] tests.
    pub const AT_ONCE: usize = 4;

    /// Prepares a ray for intersection with triangles (Woop et al., 2013). `direction` must be finite and not zero.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let length = direction.abs();
        let z = if length.x >= length.y && length.x >= length.z {
            0
        } else if length.y >= length.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let d = direction.to_array();
        Self { origin, axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    /// A bit for each triangle that the ray's line does not pass beside: those that [`Self::cross`] may find crossed.
    #[inline(always)]
    pub fn may_cross(&self, triangles: [&[DVec3; 3]; Self::AT_ONCE]) -> u32 {
        let [sx, sy, _] = self.shear;
        let origin = self.origin.as_ref();
        // By corner and axis, a triangle a lane. Loops, here and below: what maps an array is not always inlined.
        let mut sheared = [[[0.0; Self::AT_ONCE]; 2]; 3];
        for (corner, [across, up]) in sheared.iter_mut().enumerate() {
            let [x, y, z] = self.axes;
            for lane in 0..Self::AT_ONCE {
                let position = triangles[lane][corner].as_ref();
                let along = position[z] - origin[z];
                across[lane] = (position[x] - origin[x]) - sx * along;
                up[lane] = (position[y] - origin[y]) - sy * along;
            }
        }
        let [[ax, ay], [bx, by], [cx, cy]] = &sheared;
        let mut near = 0;
        for lane in 0..Self::AT_ONCE {
            let u = cx[lane] * by[lane] - cy[lane] * bx[lane];
            let v = ax[lane] * cy[lane] - ay[lane] * cx[lane];
            let w = bx[lane] * ay[lane] - by[lane] * ax[lane];
            let is_negative = (u < 0.0) | (v < 0.0) | (w < 0.0);
            let is_positive = (u > 0.0) | (v > 0.0) | (w > 0.0);
            near |= u32::from(!(is_negative & is_positive)) << lane;
        }
        near
    }

    /// Where the ray's line, to both sides without end, crosses the triangle from either side; `None` beside
    /// it or edge-on.
    #[inline(always)]
    pub fn cross(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let [x, y, z] = self.axes;
        let [sx, sy, sz] = self.shear;
        let [a, b, c] = [
            (corners[0] - self.origin).to_array(),
            (corners[1] - self.origin).to_array(),
            (corners[2] - self.origin).to_array(),
        ];
        let (ax, ay) = (a[x] - sx * a[z], a[y] - sy * a[z]);
        let (bx, by) = (b[x] - sx * b[z], b[y] - sy * b[z]);
        let (cx, cy) = (c[x] - sx * c[z], c[y] - sy * c[z]);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let t = (u * (sz * a[z]) + v * (sz * b[z]) + w * (sz * c[z])) / determinant;
        let b1 = v / determinant;
        // The normal's component along the ray is −determinant·dz times what is positive.
        let from_front = determinant * sz > 0.0;
        Some(Crossing { t, barycentric: DVec2::new(b1, (w / determinant).min(1.0 - b1)), from_front })
    }
}

/// Several rays from one origin that are longest along the same axis.
pub(crate) struct ShearedRayPacket {
    origin: DVec3,
    axes: [usize; 3],
    /// dx/dz and dy/dz of each.
    shear: [[f64; ShearedRayPacket::MAX]; 2],
}

impl ShearedRayPacket {
    /// How many there can be.
    pub const MAX: usize = 16;

    /// A packet of rays with one origin. `None` if they are not longest along the same axis.
    pub fn new(rays: &[ShearedRay; Self::MAX]) -> Option<Self> {
        let ShearedRay { origin, axes, .. } = rays[0];
        let shear = [0, 1].map(|k| rays.map(|ray| ray.shear[k]));
        rays.iter().all(|ray| ray.axes == axes).then_some(Self { origin, axes, shear })
    }

    /// A bit for each ray whose line does not pass beside the triangle: the signs that [`ShearedRay::cross`] tests.
    #[inline(always)]
    pub fn may_hit(&self, corners: &[DVec3; 3]) -> u32 {
        let [x, y, z] = self.axes;
        let [a, b, c] = [
            (corners[0] - self.origin).to_array(),
            (corners[1] - self.origin).to_array(),
            (corners[2] - self.origin).to_array(),
        ];
        let mut near = 0;
        for at in 0..Self::MAX {
            let (sx, sy) = (self.shear[0][at], self.shear[1][at]);
            let (ax, ay) = (a[x] - sx * a[z], a[y] - sy * a[z]);
            let (bx, by) = (b[x] - sx * b[z], b[y] - sy * b[z]);
            let (cx, cy) = (c[x] - sx * c[z], c[y] - sy * c[z]);
            let u = cx * by - cy * bx;
            let v = ax * cy - ay * cx;
            let w = bx * ay - by * ax;
            let is_negative = (u < 0.0) | (v < 0.0) | (w < 0.0);
            let is_positive = (u > 0.0) | (v > 0.0) | (w > 0.0);
            near |= u32::from(!(is_negative & is_positive)) << at;
        }
        near
    }
}

/// Whether a triangle has an area: more than rounding makes of three corners on a line. Non-finite corners
/// have none.
pub(crate) fn has_area([a, b, c]: &[DVec3; 3]) -> bool {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let doubled_area = ab.cross(ac).length();
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    doubled_area > 4.0 * f64::EPSILON * longest && longest < f64::INFINITY
}

/// Whether `point` lies in the triangle's plane to the precision of f64.
///
/// With C the corner opposite the longest side, e and g the sides that meet there, n = e × g and r = P − C,
/// the distance n·r/|n| is 0 within the rounding of P (a sum of three products, so off by up to 3u in each
/// coordinate for coordinates up to m), of n (up to 8u·|e||g|) and of the sum itself. The bound 16u·(|n|₁·m +
/// |e||g||r|), u = 2⁻⁵³, covers all of them: the plane of a well-shaped triangle is some 3e-15 of the
/// coordinates thick. Taking the two shorter sides keeps it thin for long and narrow triangles too.
pub(crate) fn in_plane(corners: &[DVec3; 3], point: DVec3) -> bool {
    let opposite = |k: usize| corners[(k + 1) % 3].distance_squared(corners[(k + 2) % 3]);
    let k =
        (0..3).max_by(|&i, &j| opposite(i).total_cmp(&opposite(j))).expect("a triangle has three corners");
    let corner = corners[k];
    let (e, g, r) = (corners[(k + 1) % 3] - corner, corners[(k + 2) % 3] - corner, point - corner);
    let n = e.cross(g);
    let m = corners.iter().fold(point.abs(), |m, corner| m.max(corner.abs())).max_element();
    let bound = n.abs().element_sum() * m + e.length() * g.length() * r.length();
    n.dot(r).abs() <= 8.0 * f64::EPSILON * bound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_thin() {
        let x = DVec3::X;
        for (corners, thickness) in [
            ([DVec3::ZERO, x, DVec3::Z], 1e-14),
            ([DVec3::ZERO, 1e4 * x, DVec3::new(1e4, 0.0, 1e-3)], 1e-10),
            ([DVec3::ZERO, 1e4 * x, DVec3::new(5e3, 0.0, 5e3)], 1e-10),
        ] {
            for turn in 0..3 {
                let corners = [0, 1, 2].map(|k| corners[(k + turn) % 3]);
                for weights in [[0.2, 0.3, 0.5], [0.0, 0.1, 0.9], [0.0, 0.0, 1.0]] {
                    let point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
                    assert!(in_plane(&corners, point));
                    assert!(!in_plane(&corners, point + thickness * DVec3::Y), "{corners:?}");
                }
            }
        }
    }

    #[test]
    fn several_triangles_are_tested_as_each_is() {
        // Whole coordinates, so that many edges are met exactly.
        let mut state = 1u64;
        let mut coordinate = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 60) as f64 - 8.0
        };
        let mut corner = || DVec3::new(coordinate(), coordinate(), coordinate());
        let (mut crossed, mut beside) = (0, 0);
        for _ in 0..3000 {
            let triangles: [[DVec3; 3]; 4] = std::array::from_fn(|_| [corner(), corner(), corner()]);
            let direction = corner();
            if direction == DVec3::ZERO {
                continue;
            }
            let ray = ShearedRay::new(corner(), direction);
            let near = ray.may_cross(triangles.each_ref());
            for (lane, triangle) in triangles.iter().enumerate() {
                let is_crossed = ray.cross(triangle).is_some();
                assert!(!is_crossed || near >> lane & 1 == 1, "{ray:?} {triangle:?}");
                crossed += u32::from(is_crossed);
                beside += u32::from(near >> lane & 1 == 0);
            }
        }
        assert!(crossed > 500 && beside > 5000, "{crossed} {beside}");
    }

    #[test]
    fn only_triangles_with_an_area_have_one() {
        let triangle = |c: DVec3| has_area(&[DVec3::ZERO, DVec3::X, c]);
        assert!(triangle(DVec3::Y) && triangle(DVec3::new(0.5, 1e-12, 0.0)));
        assert!(!triangle(DVec3::X) && !triangle(0.3 * DVec3::X) && !triangle(DVec3::new(0.3, 1e-17, 0.0)));
    }
}
