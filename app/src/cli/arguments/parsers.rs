//! Parsers for the values of command-line options.

use clap::builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser};
use document::CameraChoice;
use render::Aov;
use splat::Integers;
use std::path::PathBuf;

/// A name inside a file. Names in files are UTF-8: invalid bytes give a name that matches nothing.
pub fn name_parser() -> impl TypedValueParser<Value = String> {
    OsStringValueParser::new().map(|text| text.to_string_lossy().into_owned())
}

/// A finite number above 0.
///
/// # Errors
/// The text is not such a number.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    number.ok_or_else(|| "a number above 0".into())
}

/// A finite number of at least 1.
///
/// # Errors
/// The text is not such a number.
pub fn parse_divisor(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|x: &f64| *x >= 1.0 && x.is_finite());
    number.ok_or_else(|| "a number of 1 or more".into())
}

/// A position in a picture, px.
///
/// # Errors
/// The text is not `X,Y` with finite numbers.
pub fn parse_position(text: &str) -> Result<glam::DVec2, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let place = text.split_once(',').and_then(|(x, y)| Some(glam::DVec2::new(number(x)?, number(y)?)));
    place.ok_or_else(|| "X,Y in pixels".into())
}

/// A camera file, or a camera's name.
pub fn camera_parser() -> impl TypedValueParser<Value = CameraChoice> {
    OsStringValueParser::new().map(|text| CameraChoice::from_argument(&text))
}

/// Parses `NAME=OUT.exr`. The name of a photograph may itself contain `=`.
///
/// # Errors
/// The text is not of this form.
pub fn parse_photograph_output(text: &str) -> Result<(String, PathBuf), String> {
    match text.rsplit_once('=') {
        Some((name, file)) if !name.is_empty() && file.to_lowercase().ends_with(".exr") => {
            Ok((name.into(), file.into()))
        }
        _ => Err("NAME=OUT.exr".into()),
    }
}

/// Width and height of a picture, px.
///
/// # Errors
/// The text is not `WIDTHxHEIGHT`, or a side is out of range.
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']);
    let side = |text: &str| {
        text.trim().parse().ok().filter(|side| (1..=lens::Camera::LARGEST_SIDE_PX).contains(side))
    };
    sides
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("WIDTHxHEIGHT in pixels, each 1 to {}", lens::Camera::LARGEST_SIDE_PX))
}

/// One of the given values, chosen by name.
pub fn choice_parser<T: Copy + Send + Sync + 'static, const COUNT: usize>(
    all: [(&'static str, T); COUNT],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.map(|(name, _)| name)).try_map(move |name| {
        let entry = all.iter().find(|(candidate, _)| *candidate == name);
        entry.map(|(_, value)| *value).ok_or("not one of them")
    })
}

/// An extra channel.
///
/// # Errors
/// There is no channel of this name; the message lists them.
pub fn parse_aov(name: &str) -> Result<Aov, String> {
    Aov::named(name).ok_or_else(|| {
        let names: Vec<_> = Aov::ALL.iter().map(|(name, _)| *name).collect();
        format!("one of {}", names.join(", "))
    })
}

/// A finite number of at least 0.
///
/// # Errors
/// The text is not such a number.
pub fn parse_non_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite());
    number.ok_or_else(|| "a number of 0 or more".into())
}

/// Fraction bits of unpainted and painted sums, `BITS,BITS`.
///
/// # Errors
/// The text is not of this form, or a number of bits is out of range.
pub fn parse_integers(text: &str) -> Result<Integers, String> {
    let parts =
        text.split_once(',').and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    let bits = parts.map(|(standard, painted)| Integers { standard, painted });
    bits.filter(|integers| integers.are_valid()).ok_or_else(|| "two of 22, 14 and 6, as in 14,22".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked() {
        assert_eq!(parse_size("960x540"), Ok([960, 540]));
        assert!(parse_size("960").is_err() && parse_size("0x5").is_err() && parse_size("99999x1").is_err());
        assert_eq!(CameraChoice::from_argument("a.JSON".as_ref()), CameraChoice::File("a.JSON".into()));
        assert_eq!(CameraChoice::from_argument("front".as_ref()), CameraChoice::Named("front".into()));
        assert!(parse_aov("depth").is_ok() && parse_aov("z").is_err());
        assert!(
            parse_positive("0").is_err() && parse_positive("nan").is_err() && parse_non_negative("0").is_ok()
        );
    }
}
