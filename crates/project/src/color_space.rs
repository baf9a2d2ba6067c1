//! Linear colour spaces by their primaries and white.
//!
//! A colour is converted by way of CIE XYZ; if the whites differ, it is adapted with Bradford's matrix (Lam 1985), as
//! in the Academy's transforms (ACES S-2014-004, TB-2014-004).

use glam::{DMat3, DVec2, DVec3};

/// A linear colour space that pictures can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ColorSpace {
    /// The primaries of ITU-R BT.709 with white D65: the program's working space.
    #[default]
    Rec709,
    /// ACEScg: the primaries AP1 with the Academy's white (SMPTE ST 2065-1, ACES S-2014-004).
    AcesCg,
}

impl ColorSpace {
    /// All of them, with their names on the command line.
    pub const ALL: [(&'static str, Self); 2] = [("rec709", Self::Rec709), ("acescg", Self::AcesCg)];

    /// The colour space with this name on the command line and in files; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, space)| *space)
    }

    /// Its name at the Color Interop Forum: the attribute `colorInteropID` of OpenEXR.
    pub(crate) fn interop_id(self) -> &'static str {
        match self {
            Self::Rec709 => "lin_rec709_scene",
            Self::AcesCg => "lin_ap1_scene",
        }
    }

    /// Its primaries and white.
    pub(crate) fn chromaticities(self) -> Chromaticities {
        match self {
            Self::Rec709 => Chromaticities {
                red: DVec2::new(0.64, 0.33),
                green: DVec2::new(0.3, 0.6),
                blue: DVec2::new(0.15, 0.06),
                white: DVec2::new(0.3127, 0.329),
            },
            Self::AcesCg => Chromaticities {
                red: DVec2::new(0.713, 0.293),
                green: DVec2::new(0.165, 0.83),
                blue: DVec2::new(0.128, 0.044),
                white: DVec2::new(0.32168, 0.33767),
            },
        }
    }
}

/// The positions of red, green, blue and white on the CIE 1931 chromaticity diagram, (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chromaticities {
    pub red: DVec2,
    pub green: DVec2,
    pub blue: DVec2,
    pub white: DVec2,
}

/// Files store chromaticities as 32-bit floats, often with three digits.
const CHROMATICITY_TOLERANCE: f64 = 1e-3;

impl Chromaticities {
    /// Whether both have the same primaries and white within the precision of files.
    pub fn is_close_to(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|c| [c.red, c.green, c.blue, c.white]);
        a.iter().zip(b).all(|(a, b)| (*a - b).abs().max_element() <= CHROMATICITY_TOLERANCE)
    }

    /// The matrix from linear RGB with these primaries to linear RGB with those of `to`; `None` if either do not span
    /// a colour space.
    pub fn matrix_to(&self, to: &Self) -> Option<DMat3> {
        let adapt = chromatic_adaptation(self.white, to.white);
        let matrix = to.xyz_from_rgb()?.inverse() * adapt * self.xyz_from_rgb()?;
        matrix.is_finite().then_some(matrix)
    }

    /// RGB to XYZ; white has Y = 1.
    fn xyz_from_rgb(&self) -> Option<DMat3> {
        let primaries =
            DMat3::from_cols(xyz_from_xy(self.red), xyz_from_xy(self.green), xyz_from_xy(self.blue));
        let amounts = primaries.inverse() * xyz_from_xy(self.white);
        let matrix = primaries * DMat3::from_diagonal(amounts);
        (matrix.is_finite() && matrix.determinant() != 0.0).then_some(matrix)
    }
}

/// The XYZ of a chromaticity at Y = 1.
fn xyz_from_xy(at: DVec2) -> DVec3 {
    DVec3::new(at.x / at.y, 1.0, (1.0 - at.x - at.y) / at.y)
}

/// The matrix that adapts colours from one white to another.
fn chromatic_adaptation(from: DVec2, to: DVec2) -> DMat3 {
    /// Cone responses to X, Y and Z, by columns.
    const BRADFORD: DMat3 = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    if from == to {
        return DMat3::IDENTITY;
    }
    let [from, to] = [from, to].map(|white| BRADFORD * xyz_from_xy(white));
    BRADFORD.inverse() * DMat3::from_diagonal(to / from) * BRADFORD
}

/// Multiplies colours by a matrix.
pub(crate) fn transform_colors(matrix: &DMat3, rgb: &mut [[f32; 3]]) {
    for color in rgb {
        *color = (*matrix * DVec3::from_array(color.map(f64::from))).as_vec3().to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(from: ColorSpace, to: ColorSpace) -> DMat3 {
        from.chromaticities().matrix_to(&to.chromaticities()).expect("a colour space")
    }

    #[test]
    fn the_academys_matrix_is_reproduced() {
        // ACES 1.3, `Rec709_to_AP1` of its utility transforms, by rows.
        let published =
            [[0.613097, 0.339523, 0.047379], [0.070194, 0.916354, 0.013452], [0.020616, 0.109570, 0.869815]];
        let found = between(ColorSpace::Rec709, ColorSpace::AcesCg).transpose().to_cols_array_2d();
        for (found, published) in found.as_flattened().iter().zip(published.as_flattened()) {
            assert!((found - published).abs() < 5e-6, "{found} {published}");
        }
    }

    #[test]
    fn white_stays_white_and_back_is_back() {
        let there = between(ColorSpace::Rec709, ColorSpace::AcesCg);
        let back = between(ColorSpace::AcesCg, ColorSpace::Rec709);
        assert!((there * DVec3::ONE - DVec3::ONE).length() < 1e-12);
        assert!((there * back).abs_diff_eq(DMat3::IDENTITY, 1e-12));
        let mut colors = [[0.25, 0.5, 4.0]];
        transform_colors(&there, &mut colors);
        assert!(colors[0][0] > 0.25, "a saturated blue has red of wider primaries: {colors:?}");
    }

    #[test]
    fn invalid_primaries_are_detected() {
        let rec709 = ColorSpace::Rec709.chromaticities();
        let flat = Chromaticities { green: rec709.red, ..rec709 };
        let empty = Chromaticities { red: DVec2::ZERO, ..rec709 };
        assert!(
            flat.matrix_to(&rec709).is_none()
                && rec709.matrix_to(&flat).is_none()
                && empty.matrix_to(&rec709).is_none()
        );
        let rounded = Chromaticities { white: DVec2::new(0.3128, 0.3291), ..rec709 };
        assert!(rec709.is_close_to(&rounded) && !rec709.is_close_to(&ColorSpace::AcesCg.chromaticities()));
    }
}
