//! Symmetry: what is painted at one place is also painted at its images.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Mirroring and rotation about a point, along chosen axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Symmetry {
    /// Whether to mirror left and right (x), up and down (y), front and back (z); several together give all
    /// combinations.
    pub mirror: [bool; 3],
    /// Number of images around the y axis through the centre, the original included: 1 means none besides it.
    pub radial: u32,
    /// Centre of mirroring and rotation, world space.
    pub center: [f64; 3],
    /// The axes x, y and z: orthogonal unit directions in world space.
    #[serde(skip_serializing_if = "are_world_axes")]
    pub axes: [[f64; 3]; 3],
}

/// The world's own axes.
pub const WORLD_AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Whether these are the world's own axes.
pub(crate) fn are_world_axes(axes: &[[f64; 3]; 3]) -> bool {
    *axes == WORLD_AXES
}

/// Tolerance for axes being orthogonal and of length 1: the rounding of numbers written to a file.
const AXES_TOLERANCE: f64 = 1e-6;

impl Default for Symmetry {
    /// No symmetry.
    fn default() -> Self {
        Self { mirror: [false; 3], radial: 1, center: [0.0; 3], axes: WORLD_AXES }
    }
}

/// One of the images of a symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryImage {
    linear: DMat3,
    center: DVec3,
    is_identity: bool,
}

impl SymmetryImage {
    /// The image of a world point. The identity returns it bit for bit.
    pub fn point(&self, point: DVec3) -> DVec3 {
        if self.is_identity { point } else { self.center + self.linear * (point - self.center) }
    }

    /// The image of a world direction. The identity returns it bit for bit.
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        if self.is_identity { direction } else { self.linear * direction }
    }

    /// The world point of which `image` is the image.
    pub fn original(&self, image: DVec3) -> DVec3 {
        let back = || self.center + self.linear.transpose() * (image - self.center);
        if self.is_identity { image } else { back() }
    }
}

impl Symmetry {
    /// Maximum number of images around the vertical axis.
    pub const MAX_RADIAL: u32 = 64;

    /// Whether its axes are the world's own.
    pub fn has_world_axes(&self) -> bool {
        are_world_axes(&self.axes)
    }

    /// Whether it has no images besides the original.
    pub fn is_none(&self) -> bool {
        self.mirror == [false; 3] && self.radial <= 1
    }

    /// Whether its centre is finite, its axes are orthonormal, and the number of its turns is supported.
    pub fn is_valid(&self) -> bool {
        let axes = DMat3::from_cols_array_2d(&self.axes);
        let are_square = (axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, AXES_TOLERANCE);
        let is_center_finite = self.center.iter().all(|x| x.is_finite());
        (1..=Self::MAX_RADIAL).contains(&self.radial) && is_center_finite && are_square
    }

    /// All images under the mirrors and turns, the identity first.
    pub fn images(&self) -> Vec<SymmetryImage> {
        let center = DVec3::from_array(self.center);
        let axes = DMat3::from_cols_array_2d(&self.axes);
        let turns = self.radial.clamp(1, Self::MAX_RADIAL);
        let mut images: Vec<SymmetryImage> = Vec::new();
        for turn in 0..turns {
            let angle = std::f64::consts::TAU * turn as f64 / turns as f64;
            for bits in 0..8u8 {
                let flips = [0, 1, 2].map(|axis| bits >> axis & 1 == 1);
                if (0..3).any(|axis| flips[axis] && !self.mirror[axis]) {
                    continue;
                }
                let signs = DVec3::from_array(flips.map(|flipped| if flipped { -1.0 } else { 1.0 }));
                let linear = DMat3::from_rotation_y(angle) * DMat3::from_diagonal(signs);
                let linear = axes * linear * axes.transpose();
                let is_identity = turn == 0 && bits == 0;
                // A half turn is also the mirror image in x and z.
                if images.iter().all(|image| !image.linear.abs_diff_eq(linear, 1e-9)) {
                    images.push(SymmetryImage { linear, center, is_identity });
                }
            }
        }
        images
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_the_thing_itself_its_mirrors_and_its_turns_once_each() {
        let center = [1.0, 2.0, 3.0];
        let point = DVec3::new(1.5, 2.5, 3.25);
        let images = |mirror, radial| {
            let images = Symmetry { mirror, radial, center, ..Symmetry::default() }.images();
            for image in &images {
                assert!(image.original(image.point(point)).distance(point) < 1e-12);
            }
            images.iter().map(|image| image.point(point)).collect::<Vec<_>>()
        };
        assert_eq!(images([false; 3], 1), [point]);
        assert_eq!(images([true, false, false], 1), [point, DVec3::new(0.5, 2.5, 3.25)]);
        let three = images([false; 3], 3);
        assert_eq!(three.len(), 3);
        let radius = |p: &DVec3| DVec3::new(p.x - 1.0, 0.0, p.z - 3.0).length();
        assert!(three.iter().all(|p| (radius(p) - radius(&point)).abs() < 1e-12 && p.y == 2.5));
        assert!(three[0].distance(three[1]) > 0.5);
        assert_eq!(images([true, false, true], 2).len(), 4, "a half turn is both mirrors at once");
        assert_eq!(images([true, true, true], 4).len(), 16);

        // Turned by a quarter about the vertical, left and right are front and back.
        let axes = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        let turned = Symmetry { mirror: [true, false, false], radial: 1, center, axes };
        let across: Vec<_> = turned.images().iter().map(|image| image.point(point)).collect();
        assert_eq!(across, [point, DVec3::new(1.5, 2.5, 2.75)]);
        assert!(turned.is_valid());
        assert!(!Symmetry { axes: [[2.0, 0.0, 0.0], axes[1], axes[2]], ..turned }.is_valid());
        assert!(!Symmetry { axes: [[f64::NAN; 3], axes[1], axes[2]], ..turned }.is_valid());
    }
}
