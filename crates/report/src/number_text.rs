//! Formatting of numbers for readers.

/// `value` with three significant digits, without trailing zeros; powers of ten where the decimal form would
/// be long.
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return with_minus(format!("{value}"));
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&magnitude) {
        let mantissa = value / 10f64.powi(magnitude);
        let rounded = without_trailing_zeros(&format!("{mantissa:.2}"));
        return match rounded.as_str() {
            "1" => power_of_ten(magnitude),
            "10" => power_of_ten(magnitude + 1),
            _ => with_minus(format!("{rounded}·{}", power_of_ten(magnitude))),
        };
    }
    let decimals = (2 - magnitude).max(0) as usize;
    with_minus(without_trailing_zeros(&format!("{value:.decimals$}")))
}

/// Formats a value without a unit, as on an axis.
pub fn plain(value: f64) -> String {
    significant(value)
}

/// A time in seconds as text, in ms below one second.
pub fn seconds(value: f64) -> String {
    match value {
        _ if value >= 1.0 || value == 0.0 => format!("{} s", significant(value)),
        _ if value >= 1e-3 => format!("{} ms", significant(value * 1e3)),
        _ => format!("{} µs", significant(value * 1e6)),
    }
}

/// A number of bytes as text, in decimal units.
pub fn bytes(value: f64) -> String {
    match value {
        _ if value < 1e3 => format!("{} B", significant(value)),
        _ if value < 1e6 => format!("{} kB", significant(value / 1e3)),
        _ if value < 1e9 => format!("{} MB", significant(value / 1e6)),
        _ => format!("{} GB", significant(value / 1e9)),
    }
}

/// A formatted number with a minus sign in place of a hyphen.
pub fn with_minus(number: String) -> String {
    number.replace('-', "−")
}

fn without_trailing_zeros(text: &str) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text.into() }
}

fn power_of_ten(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The superscripts 0 and 4 to 9 are in Unicode order.
        _ => char::from_u32('⁰' as u32 + c as u32 - '0' as u32).unwrap_or(c),
    };
    format!("10{}", exponent.to_string().chars().map(digit).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_and_powers() {
        assert_eq!(significant(0.012345), "0.0123");
        assert_eq!(significant(1.0), "1");
        assert_eq!(significant(123456.0), "123456");
        assert_eq!(significant(-2.5), "−2.5");
        assert_eq!(significant(f64::NEG_INFINITY), "−inf");
        assert_eq!(significant(1e-6), "10⁻⁶");
        assert_eq!(significant(2.5e7), "2.5·10⁷");
        assert_eq!(significant(9.999e-6), "10⁻⁵");
        assert_eq!(significant(0.0), "0");
        assert_eq!(significant(f64::INFINITY), "inf");
    }

    #[test]
    fn units() {
        assert_eq!(seconds(0.0123), "12.3 ms");
        assert_eq!(seconds(75.04), "75 s");
        assert_eq!(seconds(2e-5), "20 µs");
        assert_eq!(bytes(384.0), "384 B");
        assert_eq!(bytes(12_345_678.0), "12.3 MB");
    }
}
