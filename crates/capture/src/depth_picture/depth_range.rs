//! Distances from the levels of a phone's depth map.
//!
//! ```text
//! RangeLinear     z = near + d·(far − near)
//! RangeInverse    z = far·near / (far − d·(far − near))        that is, 1/z = (1 − d)/near + d/far
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | d | level, 0 black to 1 white: black is near | – |
//! | near, far | distances of black and white, > 0; far may be infinite with RangeInverse | m |
//! | z | distance along the axis | m |
//!
//! (Depthmap Metadata, Google 2014; Dynamic Depth 1.0, Google 2019.)

/// The mapping from levels to distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DepthRange {
    pub is_inverse: bool,
    /// m
    pub near: f64,
    /// m
    pub far: f64,
}

impl DepthRange {
    /// The distance, m, of a level in [0, 1].
    pub fn distance(&self, level: f64) -> f64 {
        let Self { is_inverse, near, far } = *self;
        if is_inverse { ((1.0 - level) / near + level / far).recip() } else { near + level * (far - near) }
    }

    /// Parses the range that a file declares. `None` if it has none: the map is relative then.
    ///
    /// # Errors
    /// What is wrong, as text.
    pub fn parse(
        format: Option<&str>,
        near: Option<&str>,
        far: Option<&str>,
        unit: Unit,
    ) -> Result<Option<Self>, String> {
        let is_inverse = match format.map(|format| format.trim().to_lowercase()).as_deref() {
            None | Some("" | "rangeinverse") => true,
            Some("rangelinear") => false,
            Some(other) => {
                return Err(format!(
                    "its format {} is neither RangeInverse nor RangeLinear",
                    crate::files::text::quoted(other)
                ));
            }
        };
        let number = |what: &str, text: &str| {
            let value = text.trim().parse::<f64>().ok().filter(|value| *value > 0.0);
            value.ok_or_else(|| format!("{what} is {}, not a distance", crate::files::text::quoted(text)))
        };
        let (Some(near), Some(far)) = (near, far) else { return Ok(None) };
        let (near, far) = (number("Near", near)?, number("Far", far)?);
        let (near, far) = match unit {
            Unit::Metres => (near, far),
            Unit::Millimetres => (near * 1e-3, far * 1e-3),
            // Dioptres are the greater the nearer.
            Unit::Dioptres if near > far => (near.recip(), far.recip()),
            // Pixel phones write distances without a scale and call them dioptres.
            Unit::Dioptres => (near, far),
        };
        if near.is_infinite() || (far.is_infinite() && !is_inverse) || near == far {
            return Err(format!("Near {near} and Far {far} leave no range"));
        }
        Ok(Some(Self { is_inverse, near, far }))
    }
}

/// The unit of near and far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Metres,
    Millimetres,
    Dioptres,
}

impl Unit {
    /// The unit with this name; metres if there is no name, or another one.
    pub fn named(name: Option<&str>) -> Self {
        match name.unwrap_or_default().trim().to_lowercase().as_str() {
            "mm" | "millimeters" | "millimetres" => Self::Millimetres,
            "diopters" | "dioptres" | "diopter" => Self::Dioptres,
            _ => Self::Metres,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(format: &str, near: &str, far: &str, unit: &str) -> DepthRange {
        DepthRange::parse(Some(format), Some(near), Some(far), Unit::named(Some(unit))).unwrap().unwrap()
    }

    #[test]
    fn black_is_near_and_white_is_far() {
        for format in ["RangeInverse", "RangeLinear"] {
            let range = range(format, "0.5", "8", "m");
            assert_eq!((range.distance(0.0), range.distance(1.0)), (0.5, 8.0));
        }
        // z = far·near / (far − d·(far − near)).
        let inverse = range("RangeInverse", "0.5", "8", "m");
        for level in [0.1, 0.5, 0.9] {
            let expected = 8.0 * 0.5 / (8.0 - level * (8.0 - 0.5));
            assert!((inverse.distance(level) - expected).abs() < 1e-12);
        }
        assert_eq!(range("RangeLinear", "1", "3", "m").distance(0.25), 1.5);
        // The control: the two are not the same between the ends.
        assert!((inverse.distance(0.5) - range("RangeLinear", "0.5", "8", "m").distance(0.5)).abs() > 1.0);
    }

    #[test]
    fn units() {
        assert_eq!(range("RangeInverse", "29.3", "878.7", "mm").near, 0.0293);
        let dioptres = range("RangeInverse", "2", "0.125", "Diopters");
        assert_eq!((dioptres.near, dioptres.far), (0.5, 8.0));
        // As Pixel 4 writes it: the other way round, so not dioptres.
        let pixel = range("RangeInverse", "0.086360", "0.129485", "Diopters");
        assert_eq!((pixel.near, pixel.far), (0.08636, 0.129485));
    }

    #[test]
    fn what_is_no_range() {
        let parse = |format, near, far| DepthRange::parse(Some(format), Some(near), Some(far), Unit::Metres);
        assert!(parse("Range", "1", "2").unwrap_err().contains("neither RangeInverse nor RangeLinear"));
        for (near, far) in [("0", "1"), ("-1", "2"), ("nan", "2"), ("x", "2"), ("1", "1"), ("inf", "1")] {
            assert!(parse("RangeInverse", near, far).is_err(), "{near} {far}");
        }
        assert!(parse("RangeInverse", "1", "inf").is_ok());
        assert!(parse("RangeLinear", "1", "inf").is_err());
        assert_eq!(DepthRange::parse(None, None, Some("1"), Unit::Metres), Ok(None));
    }
}
