//! A measured value: a number, a range, or a bound.

use serde_json::{Number, Value};

/// A value as it was measured. In JSON a number, a pair of numbers for a range, or either with `"bound"`.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The least value; the same as `high` unless it is a range.
    pub low: f64,
    /// The greatest value.
    pub high: f64,
    /// `>` where the value is a lower bound, `<` where it is an upper one.
    pub bound: Option<char>,
    text: String,
}

impl Quantity {
    /// Reads the fields `value` and `bound` of a record.
    ///
    /// # Errors
    /// When they are of another form; the message says which form is expected.
    pub fn from_json(value: &Value, bound: Option<&Value>) -> Result<Self, String> {
        let numbers: Option<Vec<&Number>> = match value {
            Value::Number(number) => Some(vec![number]),
            Value::Array(pair) if pair.len() == 2 => pair.iter().map(Value::as_number).collect(),
            _ => None,
        };
        let numbers = numbers.ok_or("\"value\" must be a number or a pair of numbers")?;
        let floats: Vec<f64> = numbers.iter().filter_map(|number| number.as_f64()).collect();
        let bound = match bound.map(|b| b.as_str().unwrap_or_default()) {
            None => None,
            Some(">") => Some('>'),
            Some("<") => Some('<'),
            Some(other) => return Err(format!("\"bound\" must be \">\" or \"<\", not {other:?}")),
        };
        let text = numbers.iter().map(|number| written(&number.to_string())).collect::<Vec<_>>().join(" to ");
        Ok(Self { low: floats[0], high: floats[floats.len() - 1], bound, text })
    }

    /// The value without its unit, as pages show it.
    pub fn text(&self) -> String {
        match self.bound {
            Some(bound) => format!("{bound} {}", self.text),
            None => self.text.clone(),
        }
    }
}

/// A number with a true minus sign, and with commas between thousands from 10,000 on.
fn written(number: &str) -> String {
    let (sign, digits) = number.strip_prefix('-').map_or(("", number), |digits| ("−", digits));
    let (whole, fraction) = digits.find('.').map_or((digits, ""), |at| digits.split_at(at));
    let mut grouped = String::new();
    for (k, digit) in whole.chars().enumerate() {
        if k > 0 && whole.len() > 4 && (whole.len() - k).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    format!("{sign}{grouped}{fraction}")
}
