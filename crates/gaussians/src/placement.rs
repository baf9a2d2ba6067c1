//! Where a cloud stands in the world.

use crate::cloud::Axes;
use glam::{DMat3, DVec3};

/// The transform from the axes of a file to the world: world = rotation · (scale ∘ file) + translation.
///
/// Colours turn with `rotation`, as glTF's `KHR_gaussian_splatting` wants it: the direction from which a splat is viewed is turned back
/// into the axes of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Orthogonal; a reflection for left-handed files.
    pub rotation: DMat3,
    /// Scale along the file's axes, > 0.
    pub scale: DVec3,
    /// World units.
    pub translation: DVec3,
}

impl Placement {
    /// The axes of the file are the world's.
    pub const IDENTITY: Self =
        Self { rotation: DMat3::IDENTITY, scale: DVec3::ONE, translation: DVec3::ZERO };

    /// Turns the axes of a file into those of glTF, so that up is +y.
    pub fn upright(axes: Axes) -> Self {
        Self { rotation: axes.to_gltf(), ..Self::IDENTITY }
    }

    /// Whether the numbers are usable: finite, the rotation orthogonal to 1e-3, the scales positive.
    pub fn is_valid(&self) -> bool {
        let deviation = self.rotation.transpose() * self.rotation - DMat3::IDENTITY;
        self.rotation.is_finite()
            && deviation.to_cols_array().iter().all(|e| e.abs() < 1e-3)
            && self.scale.is_finite()
            && self.scale.min_element() > 0.0
            && self.translation.is_finite()
    }

    /// Whether it turns and scales as a whole: valid, not mirrored, the scales equal to 1e-4 of them.
    pub fn is_similarity(&self) -> bool {
        let x = self.scale.x;
        let is_alike = (self.scale - DVec3::splat(x)).abs().max_element() <= 1e-4 * x;
        self.is_valid() && is_alike && self.rotation.determinant() > 0.0
    }

    /// The linear part, from vectors of the file to vectors of the world.
    pub fn linear(&self) -> DMat3 {
        self.rotation * DMat3::from_diagonal(self.scale)
    }

    /// A point of the file in the world.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.linear() * point + self.translation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_with_y_down_stand_upright() {
        let placement = Placement::upright(Axes::RIGHT_DOWN_FORWARD);
        assert!(placement.is_valid());
        assert_eq!(placement.point(DVec3::new(1.0, -2.0, 3.0)), DVec3::new(1.0, 2.0, -3.0));
        assert_eq!(Placement::upright(Axes::RIGHT_UP_BACK), Placement::IDENTITY);
        assert!(!Placement { scale: DVec3::new(1.0, 0.0, 1.0), ..placement }.is_valid());
        assert!(!Placement { rotation: 2.0 * DMat3::IDENTITY, ..placement }.is_valid());
    }
}
