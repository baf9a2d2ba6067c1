//! Names with numbers in them: `lf_03_11`, `r1c2`, `out_00_10_-383.248_1017.39_`.

/// A name, split at its numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NumberedName {
    /// The text before each number, lower case, and the text after the last.
    pub texts: Vec<String>,
    /// In order.
    pub numbers: Vec<u32>,
}

impl NumberedName {
    /// Parses a file's name without its extension; `None` if it has no number, or one that is too large.
    pub fn parse(stem: &str) -> Option<Self> {
        let (mut texts, mut numbers) = (vec![String::new()], Vec::new());
        let mut digits = String::new();
        for c in stem.to_lowercase().chars().chain(['\0']) {
            if c.is_ascii_digit() {
                digits.push(c);
                continue;
            }
            if !digits.is_empty() {
                numbers.push(digits.parse().ok()?);
                texts.push(String::new());
                digits.clear();
            }
            if c != '\0' {
                texts.last_mut()?.push(c);
            }
        }
        (!numbers.is_empty()).then_some(Self { texts, numbers })
    }
}

/// Row, column, y and x of a name of Stanford's light field archive: two whole numbers, then two with decimals.
pub(super) fn parse_positions(stem: &str) -> Option<([u32; 2], [f64; 2])> {
    let fields: Vec<&str> = stem.split('_').collect();
    let parse_fields = |fields: &[&str]| {
        let whole =
            |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten();
        let decimal = |text: &str| {
            text.contains('.').then(|| text.parse().ok()).flatten().filter(|number: &f64| number.is_finite())
        };
        Some(([whole(fields[0])?, whole(fields[1])?], [decimal(fields[2])?, decimal(fields[3])?]))
    };
    fields.windows(4).find_map(parse_fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_the_text_between_them() {
        let name = NumberedName::parse("LF_03_11b").unwrap();
        assert_eq!((name.texts, name.numbers), (["lf_", "_", "b"].map(String::from).to_vec(), vec![3, 11]));
        assert_eq!(NumberedName::parse("7").unwrap().numbers, [7]);
        assert_eq!(NumberedName::parse("center"), None);
        assert_eq!(NumberedName::parse("99999999999999999999_1"), None);
    }

    #[test]
    fn stanfords_names() {
        let expected = Some(([0, 10], [-383.248383, 1017.387878]));
        assert_eq!(parse_positions("out_00_10_-383.248383_1017.387878"), expected);
        assert_eq!(parse_positions("out_00_10_-383.248383_1017.387878_"), expected);
        for other in ["out_00_10", "out_00_10_3_4", "out_a_10_1.5_2.5", "out_00_10_nan._2.5"] {
            assert_eq!(parse_positions(other), None, "{other}");
        }
    }
}
