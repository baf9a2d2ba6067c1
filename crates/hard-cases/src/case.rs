//! A hard case and its outcome.

use progress::{Cancelled, Progress};
use serde::Serialize;

/// Number of rays and samples that the cases use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Effort {
    /// As many as the stated accuracy needs: some minutes for the suite.
    #[default]
    Full,
    /// A small share of these, for tests.
    Reduced,
}

impl Effort {
    /// `full` or `reduced`, depending on the effort.
    pub(crate) fn choose<T>(self, full: T, reduced: T) -> T {
        match self {
            Self::Full => full,
            Self::Reduced => reduced,
        }
    }
}

/// One hard case.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name, unique in the suite.
    pub name: &'static str,
    /// The reason for the expected result, a sentence.
    pub reason: &'static str,
    /// What the negative control computes wrongly, a phrase.
    pub control: &'static str,
    pub(crate) check: fn(Effort, &dyn Progress) -> Result<Verdict, Cancelled>,
}

impl Case {
    /// Runs the case and its control.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn run(&self, effort: Effort, progress: &dyn Progress) -> Result<Outcome, Cancelled> {
        let Verdict { expected, measured, pass, control_fails } = (self.check)(effort, progress)?;
        Ok(Outcome { case: self.name.into(), expected, measured, pass, control_fails })
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Outcome {
    /// The case's name.
    pub case: String,
    /// The expected result.
    pub expected: String,
    /// The measured result, and that of the control.
    pub measured: String,
    /// Whether the measured result is as expected.
    pub pass: bool,
    /// Whether the deliberately wrong computation fails the same check, as it must.
    pub control_fails: bool,
}

/// Value of a number that a control does not compute; it is within every limit.
pub(crate) const NOT_COMPUTED: f64 = f64::NEG_INFINITY;

/// The result of a case's check.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    pub expected: String,
    pub measured: String,
    pub pass: bool,
    pub control_fails: bool,
}

impl Verdict {
    /// Checks numbers against upper limits, each given with its name: `right` are those of the product, `wrong`
    /// those of the control ([`NOT_COMPUTED`] where it has none). NaN is never within a limit.
    pub fn new<const N: usize>(
        expected: impl Into<String>,
        limits: [(&str, f64); N],
        right: [f64; N],
        wrong: [f64; N],
    ) -> Self {
        let holds = |values: &[f64; N]| values.iter().zip(&limits).all(|(value, (_, most))| value <= most);
        let list = |values: &[f64; N]| {
            let computed = values.iter().zip(&limits).filter(|(value, _)| **value != NOT_COMPUTED);
            let entries = computed.map(|(value, (name, _))| format!("{name} {}", format_value(*value)));
            entries.collect::<Vec<_>>().join(", ")
        };
        Self {
            expected: expected.into(),
            measured: format!("{} (control: {})", list(&right), list(&wrong)),
            pass: holds(&right),
            control_fails: !holds(&wrong),
        }
    }
}

/// Formats a number for the table: integers exactly, others with two to three digits.
fn format_value(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 {
        format!("{value}")
    } else if (0.01..1000.0).contains(&value.abs()) {
        format!("{value:.3}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn not_a_number_passes_no_check() {
        let finding = Verdict::new("small", [("error", 1.0)], [f64::NAN], [2.0]);
        assert!(!finding.pass && finding.control_fails);
        let finding = Verdict::new("small", [("error", 1.0), ("leaks", 0.0)], [0.123, 0.0], [0.5, 0.0]);
        assert!(finding.pass && !finding.control_fails);
        assert_eq!(finding.measured, "error 0.123, leaks 0 (control: error 0.500, leaks 0)");
    }
}
