//! A chart before packing: flat, in world lengths.

use glam::{DMat2, DVec2, DVec3};

/// A flattened piece of surface. Its triangles are oriented from x to y (positive area) and do not overlap.
#[derive(Clone, Debug)]
pub(crate) struct UnpackedChart {
    /// The part.
    pub part: u32,
    /// Scene triangles.
    pub triangles: Vec<u32>,
    /// Their corners in the plane, world lengths.
    pub corners: Vec<[DVec2; 3]>,
    /// Whether the packer may rotate it by any angle (an artist's island keeps its axes).
    pub can_rotate: bool,
}

/// A triangle laid into the plane without distortion: a at the origin, b on the x axis.
pub(crate) fn flatten_triangle([a, b, c]: [DVec3; 3]) -> [DVec2; 3] {
    let (ab, ac) = (b - a, c - a);
    let length = ab.length();
    if length == 0.0 {
        return [DVec2::ZERO, DVec2::ZERO, DVec2::new(ac.length(), 0.0)];
    }
    let along = ac.dot(ab) / length;
    [DVec2::ZERO, DVec2::new(length, 0.0), DVec2::new(along, ab.cross(ac).length() / length)]
}

/// Signed area.
pub(crate) fn signed_area([a, b, c]: [DVec2; 3]) -> f64 {
    0.5 * (b - a).perp_dot(c - a)
}

impl UnpackedChart {
    /// A chart of one triangle with these corners (world), undistorted.
    pub fn from_triangle(part: u32, triangle: u32, corners: [DVec3; 3]) -> Self {
        Self { part, triangles: vec![triangle], corners: vec![flatten_triangle(corners)], can_rotate: true }
    }

    /// Brings a flattening of any scale to world lengths: first the linear map that makes its mean metric that of the
    /// surface (undoing any stretch that all its triangles share), then the scale that makes the areas equal.
    /// `worlds` are the triangles' corners in the world. `None` if the flattening has no area.
    pub fn scale_to_world(&mut self, worlds: &[[DVec3; 3]]) -> Option<()> {
        if self.corners.iter().map(|&c| signed_area(c)).sum::<f64>() < 0.0 {
            self.corners.iter_mut().flatten().for_each(|c| c.x = -c.x);
        }
        // The metric G = Jᵀ·J of each triangle's map plane → surface, weighted by its area in the plane.
        let (mut metric, mut weight) = (DMat2::ZERO, 0.0);
        for (&plane, &world) in self.corners.iter().zip(worlds) {
            let edges = DMat2::from_cols(plane[1] - plane[0], plane[2] - plane[0]);
            let flat = flatten_triangle(world);
            let determinant = edges.determinant();
            if determinant > 0.0 {
                let jacobian = DMat2::from_cols(flat[1] - flat[0], flat[2] - flat[0]) * edges.inverse();
                metric += jacobian.transpose() * jacobian * determinant;
                weight += determinant;
            }
        }
        let root = square_root(metric * (1.0 / weight))?;
        self.corners.iter_mut().flatten().for_each(|c| *c = root * *c);
        let flat: f64 = self.corners.iter().map(|&c| signed_area(c)).sum();
        let world: f64 = worlds.iter().map(|&w| signed_area(flatten_triangle(w))).sum();
        let scale = (world / flat).sqrt();
        self.corners.iter_mut().flatten().for_each(|c| *c *= scale);
        let finite = self.corners.iter().flatten().all(|c| c.is_finite());
        (finite && scale > 0.0).then_some(())
    }
}

/// The symmetric square root of a symmetric positive definite matrix: √G = (G + √|G|·1) / √(tr G + 2√|G|).
fn square_root(g: DMat2) -> Option<DMat2> {
    let determinant = g.determinant().max(0.0).sqrt();
    let trace = g.x_axis.x + g.y_axis.y + 2.0 * determinant;
    let root = (g + DMat2::IDENTITY * determinant) * (1.0 / trace.sqrt());
    (determinant > 0.0 && root.is_finite()).then_some(root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretched_flattening_becomes_true_to_the_surface() {
        let world = [DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 0.0)];
        let other = [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0), DVec3::new(-2.0, 1.0, 0.0)];
        let stretch = DMat2::from_cols(DVec2::new(0.1, 0.02), DVec2::new(-0.3, 5.0));
        let plane = [world, other].map(|t| t.map(|p| stretch * p.truncate()));
        let mut chart =
            UnpackedChart { part: 0, triangles: vec![0, 1], corners: plane.to_vec(), can_rotate: true };
        chart.scale_to_world(&[world, other]).unwrap();
        for (flat, world) in chart.corners.iter().zip([world, other]) {
            for k in 0..3 {
                let (i, j) = (k, (k + 1) % 3);
                assert!(((flat[i] - flat[j]).length() - (world[i] - world[j]).length()).abs() < 1e-12);
            }
        }
    }
}
