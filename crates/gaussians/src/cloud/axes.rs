//! Where the axes of a file point.

use glam::{DMat3, DVec3};

/// A direction as an upright viewer has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toward {
    /// +x of glTF.
    Right,
    /// −x of glTF.
    Left,
    /// +y of glTF.
    Up,
    /// −y of glTF.
    Down,
    /// +z of glTF, toward the viewer.
    Back,
    /// −z of glTF, away from the viewer.
    Forward,
}

impl Toward {
    /// Its unit vector in the axes of glTF.
    pub fn in_gltf(self) -> DVec3 {
        match self {
            Self::Right => DVec3::X,
            Self::Left => DVec3::NEG_X,
            Self::Up => DVec3::Y,
            Self::Down => DVec3::NEG_Y,
            Self::Back => DVec3::Z,
            Self::Forward => DVec3::NEG_Z,
        }
    }
}

/// Where x, y and z of a file point. By default a cloud stays in the axes of its file; [`crate::Placement::upright`] turns it into those
/// of glTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes(pub [Toward; 3]);

impl Axes {
    /// Right, down, forward: COLMAP's and those of 3DGS's files.
    pub const RIGHT_DOWN_FORWARD: Self = Self([Toward::Right, Toward::Down, Toward::Forward]);
    /// Right, up, back: glTF's and those of .spz.
    pub const RIGHT_UP_BACK: Self = Self([Toward::Right, Toward::Up, Toward::Back]);

    /// The matrix from the axes of the file to those of glTF: orthogonal, and a reflection where the file's axes are left-handed.
    pub fn to_gltf(self) -> DMat3 {
        let [x, y, z] = self.0.map(Toward::in_gltf);
        DMat3::from_cols(x, y, z)
    }
}
