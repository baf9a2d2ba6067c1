//! Templates with named holes.

use crate::error::WebPageError;

/// Fills the holes `{{name}}` of a template. Values are not searched for holes.
///
/// # Errors
/// [`WebPageError::Template`]: a hole without a value, or a value without a hole.
pub fn fill_template(template: &str, values: &[(&str, &str)]) -> Result<String, WebPageError> {
    let mut filled =
        String::with_capacity(template.len() + values.iter().map(|(_, v)| v.len()).sum::<usize>());
    let mut is_used = vec![false; values.len()];
    let mut rest = template;
    while let Some((before, from_name)) = rest.split_once("{{") {
        let mismatch = |name: &str| WebPageError::Template(name.into());
        let (name, after) = from_name.split_once("}}").ok_or_else(|| mismatch(from_name))?;
        let index = values.iter().position(|(n, _)| *n == name).ok_or_else(|| mismatch(name))?;
        is_used[index] = true;
        filled.push_str(before);
        filled.push_str(values[index].1);
        rest = after;
    }
    filled.push_str(rest);
    match is_used.iter().position(|is_used| !is_used) {
        Some(unused) => Err(WebPageError::Template(values[unused].0.into())),
        None => Ok(filled),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_filled_and_values_left_alone() {
        let filled = fill_template("<{{a}}|{{b}}|{{a}}>", &[("a", "{{b}}"), ("b", "x")]);
        assert_eq!(filled.as_deref(), Ok("<{{b}}|x|{{b}}>"));
    }

    #[test]
    fn a_missing_hole_and_a_missing_value_are_errors() {
        let mismatch = |name: &str| Err(WebPageError::Template(name.into()));
        assert_eq!(fill_template("{{a}}", &[("a", "1"), ("b", "2")]), mismatch("b"));
        assert_eq!(fill_template("{{a}}{{b}}", &[("a", "1")]), mismatch("b"));
        assert_eq!(fill_template("{{a", &[("a", "1")]), mismatch("a"));
    }
}
