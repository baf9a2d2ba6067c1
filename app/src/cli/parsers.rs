//! How values that several commands take are read.

use clap::builder::{OsStringValueParser, TypedValueParser};

/// A name inside a file, which is UTF-8 there: other bytes make a name that nothing has.
pub fn name_parser() -> impl TypedValueParser<Value = String> {
    OsStringValueParser::new().map(|text| text.to_string_lossy().into_owned())
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
    number.ok_or_else(|| "a number above 0".into())
}
