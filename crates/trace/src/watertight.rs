//! The watertight ray–triangle test, in f64.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Corners are moved to the
//! ray's origin and sheared so that the ray becomes the z axis; then the signs of three edge functions say
//! whether the origin of that plane lies in the triangle. A corner's sheared position depends on the ray and the
//! corner alone, an edge function fl(x₁y₂) − fl(y₁x₂) changes exactly its sign when its corners are swapped, and
//! rounding is monotonic, so it never has the wrong sign (at worst it is 0, which counts as inside). Two triangles
//! that share an edge therefore never both miss a ray that crosses it. This needs every product rounded by itself: no
//! fused multiply-add.

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
}

impl ShearedRay {
    /// `direction` must be finite and not zero.
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

    /// Where the ray's line, to both sides without end, crosses the triangle from either side; `None` beside it or edge-on.
    #[inline(always)]
    pub fn cross(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let [x, y, z] = self.axes;
        let [sx, sy, sz] = self.shear;
        let [a, b, c] = corners.map(|corner| (corner - self.origin).to_array());
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
        Some(Crossing { t, barycentric: DVec2::new(b1, (w / determinant).min(1.0 - b1)) })
    }
}

/// Whether a triangle has an area: more than rounding makes of three corners on a line. Non-finite corners have none.
pub(crate) fn has_area([a, b, c]: &[DVec3; 3]) -> bool {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let doubled_area = ab.cross(ac).length();
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    doubled_area > 4.0 * f64::EPSILON * longest && longest < f64::INFINITY
}

/// Whether `point` lies in the triangle's plane as far as f64 can tell.
///
/// With n = (B − A) × (C − A) and r = P − A, the distance n·r/|n| is 0 within the rounding of P (a sum of three
/// products, so off by up to 3u in each coordinate for coordinates up to m), of n (up to 8u·|B − A||C − A|) and of
/// the sum itself. The bound 16u·(|n|₁·m + |B − A||C − A||r|), u = 2⁻⁵³, covers all of them: the thickness of the plane is some
/// 3e-15 of the coordinates for a well-shaped triangle.
pub(crate) fn in_plane(corners: &[DVec3; 3], point: DVec3) -> bool {
    let [a, b, c] = *corners;
    let (ab, ac, r) = (b - a, c - a, point - a);
    let n = ab.cross(ac);
    let m = a.abs().max(b.abs()).max(c.abs()).max(point.abs()).max_element();
    let bound = n.abs().element_sum() * m + ab.length() * ac.length() * r.length();
    n.dot(r).abs() <= 8.0 * f64::EPSILON * bound
}
