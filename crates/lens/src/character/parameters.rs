//! The numbers of a lens's character, and their validation.

use super::rims::Rim;
use crate::CameraError;

/// What a lens does beside focusing. Lengths are in scene units and scale with the lens; the default is none of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Character {
    /// R₀, the radius of the lens fully open: that of `edges`, which stays when the lens is stopped down. `None`: the camera's.
    pub widest_radius: Option<f64>,
    /// C, 1/length: the lens focuses at 1/s + C·|q₀|² instead of 1/s, nearer toward the corners if C > 0.
    pub field_curvature: f64,
    /// Δ of red and blue, a length: how much farther behind the lens these colours focus than green (longitudinal colour).
    pub longitudinal_colour: [f64; 2],
    /// m of red and blue: their pictures are 1 + m times as large as green's (lateral colour).
    pub lateral_colour: [f64; 2],
    /// b, in [−1, 1]: how bright the rims of far discs are; near ones are as much the opposite (see [`Edges`](super::Edges)).
    pub edges: f64,
    /// Openings that cut the aperture beside the axis: two at most.
    pub rims: [Option<Rim>; 2],
    /// Whether the picture darkens as cos⁴ of the angle to the axis.
    pub has_cos4_falloff: bool,
}

impl Character {
    /// The largest |m| of lateral colour.
    pub const LARGEST_LATERAL: f64 = 0.1;
    /// The largest |C|, 1/length.
    pub const LARGEST_CURVATURE: f64 = 1e6;

    /// Whether it does nothing.
    pub fn is_neutral(&self) -> bool {
        *self == Self { widest_radius: self.widest_radius, ..Self::default() }
    }

    /// The rims that there are.
    pub fn rims(&self) -> impl Iterator<Item = Rim> + Clone {
        self.rims.into_iter().flatten()
    }

    /// Whether colours are focused unlike.
    pub fn has_fringe(&self) -> bool {
        self.longitudinal_colour != [0.0; 2] || self.lateral_colour != [0.0; 2]
    }

    /// Whether the aperture is cut or weighed, so that a point's disc is not that of the plain lens.
    pub fn shapes_discs(&self) -> bool {
        self.edges != 0.0 || self.rims().next().is_some()
    }

    /// Checks that all fields are within their ranges for a lens of this image distance (scene units).
    ///
    /// # Errors
    /// The first field that is not.
    pub fn validate(&self, image_distance: f64) -> Result<(), CameraError> {
        let require = |ok: bool, field, must| if ok { Ok(()) } else { Err(CameraError { field, must }) };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        require(
            self.widest_radius.is_none_or(positive),
            "character widest_radius",
            "a length above 0 and finite",
        )?;
        require(
            self.field_curvature.abs() <= Self::LARGEST_CURVATURE,
            "character field_curvature",
            "a number from -1e6 to 1e6 (1/length)",
        )?;
        require(
            self.longitudinal_colour.iter().all(|shift| shift.abs() <= image_distance / 2.0),
            "character longitudinal_colour",
            "two lengths (red, blue) of at most half the distance from lens to sensor",
        )?;
        require(
            self.lateral_colour.iter().all(|ratio| ratio.abs() <= Self::LARGEST_LATERAL),
            "character lateral_colour",
            "two numbers (red, blue) from -0.1 to 0.1",
        )?;
        require(self.edges.abs() <= 1.0, "character edges", "a number from -1 to 1")?;
        for rim in self.rims() {
            require(positive(rim.radius), "character rims.radius", "a length above 0 and finite")?;
            require(rim.distance.is_finite(), "character rims.distance", "a finite length")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_named() {
        let rim = |radius, distance| [Some(Rim { radius, distance }), None];
        let good = Character {
            widest_radius: Some(0.02),
            field_curvature: -0.1,
            longitudinal_colour: [1e-4, -1e-4],
            lateral_colour: [1e-3, -1e-3],
            edges: 1.0,
            rims: rim(0.02, 0.05),
            has_cos4_falloff: true,
        };
        good.validate(0.05).unwrap();
        assert!(
            !good.is_neutral() && Character { widest_radius: Some(1.0), ..Character::default() }.is_neutral()
        );
        let bad = [
            (Character { widest_radius: Some(0.0), ..good }, "widest_radius"),
            (Character { field_curvature: f64::NAN, ..good }, "field_curvature"),
            (Character { field_curvature: f64::INFINITY, ..good }, "field_curvature"),
            (Character { longitudinal_colour: [0.0, -0.03], ..good }, "longitudinal_colour"),
            (Character { longitudinal_colour: [f64::NAN, 0.0], ..good }, "longitudinal_colour"),
            (Character { lateral_colour: [0.2, 0.0], ..good }, "lateral_colour"),
            (Character { edges: 1.1, ..good }, "edges"),
            (Character { edges: f64::NAN, ..good }, "edges"),
            (Character { rims: rim(0.0, 0.1), ..good }, "rims.radius"),
            (Character { rims: rim(f64::NAN, 0.1), ..good }, "rims.radius"),
            (Character { rims: rim(0.1, f64::INFINITY), ..good }, "rims.distance"),
        ];
        for (character, field) in bad {
            let error = character.validate(0.05).unwrap_err();
            assert_eq!(error.field.strip_prefix("character "), Some(field));
        }
    }
}
