//! Maps numbers to positions on an axis and chooses its ticks.

/// Kind of axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Linear; starts at 0 if no value is negative.
    Linear,
    /// Logarithmic; values of 0 or less have no position.
    Log,
}

/// A tick of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Its value.
    pub value: f64,
    /// Whether it is labelled with its number.
    pub has_label: bool,
}

/// A scale: `low` is at position 0, `high` at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    kind: Kind,
    low: f64,
    high: f64,
}

/// Minimum number of labels on an axis.
const MIN_LABELS: usize = 3;

impl Scale {
    /// A scale that contains all values that have a position on it, with round numbers at its ends. Without
    /// any, 0 to 10 (or 1 to 10).
    pub fn from_values(kind: Kind, values: impl Iterator<Item = f64>) -> Self {
        let values = values.filter(|&v| v.is_finite() && (kind == Kind::Linear || v > 0.0));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        match kind {
            _ if low > high => Self { kind, low: if kind == Kind::Log { 1.0 } else { 0.0 }, high: 10.0 },
            Kind::Log => {
                let (low, high) = (round_down(low / 1.04), round_up(high * 1.04));
                Self { kind, low, high }
            }
            Kind::Linear => {
                let low = low.min(0.0);
                let high = if high > low { high } else { low + 1.0 };
                let step = linear_step(high - low);
                Self { kind, low: (low / step).floor() * step, high: (high / step).ceil() * step }
            }
        }
    }

    /// Position of a value: 0 at the low end, 1 at the high one. `None` if it has no position.
    pub fn position(&self, value: f64) -> Option<f64> {
        let place = match self.kind {
            Kind::Linear => (value - self.low) / (self.high - self.low),
            Kind::Log if value > 0.0 => (value / self.low).ln() / (self.high / self.low).ln(),
            Kind::Log => return None,
        };
        place.is_finite().then_some(place)
    }

    /// The ticks, from low to high.
    pub fn ticks(&self) -> Vec<Tick> {
        match self.kind {
            Kind::Linear => {
                let step = linear_step(self.high - self.low);
                let count = ((self.high - self.low) / step).round() as i64;
                let tick = |k: i64| Tick { value: self.low + step * k as f64, has_label: true };
                (0..=count).map(tick).collect()
            }
            Kind::Log => self.log_ticks(),
        }
    }

    /// A tick at every multiple of a power of ten. The powers are labelled, and more multiples if these are
    /// too few.
    fn log_ticks(&self) -> Vec<Tick> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let multiples = decades.flat_map(|decade| (1..10).map(move |k| (k, k as f64 * 10f64.powi(decade))));
        let slack = 1e-9;
        let inside: Vec<(i32, f64)> = multiples
            .filter(|(_, v)| (self.low * (1.0 - slack)..=self.high * (1.0 + slack)).contains(v))
            .collect();
        let count = |labelled: &[i32]| inside.iter().filter(|(k, _)| labelled.contains(k)).count();
        let choices: [&[i32]; 4] = [&[1], &[1, 3], &[1, 2, 5], &[1, 2, 3, 4, 5, 6, 7, 8]];
        let labelled = choices.into_iter().find(|labelled| count(labelled) >= MIN_LABELS);
        let labelled = labelled.unwrap_or(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        // Over many decades only some powers are labelled.
        let powers = count(&[1]);
        let stride = if labelled == [1] { powers.div_ceil(8).max(1) as i32 } else { 1 };
        let tick = |&(k, value): &(i32, f64)| {
            let is_strided = (value.log10().floor() as i32).rem_euclid(stride) == 0;
            Tick { value, has_label: labelled.contains(&k) && is_strided }
        };
        inside.iter().map(tick).collect()
    }
}

/// A step of 1, 2 or 5 times a power of ten that divides `span` into four to ten parts.
fn linear_step(span: f64) -> f64 {
    let decade = 10f64.powf((span / 10.0).log10().ceil());
    let cuts = |step: f64| span / step;
    [decade / 5.0, decade / 2.0, decade].into_iter().find(|&step| cuts(step) <= 10.0).unwrap_or(decade)
}

/// The largest of 1, 2 or 5 times a power of ten that is at most `value`.
fn round_down(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0].map(|k| k * decade).into_iter().find(|&v| v <= value).unwrap_or(decade)
}

/// The smallest of 1, 2 or 5 times a power of ten that is at least `value`.
fn round_up(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|&v| v >= value).unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<f64> {
        scale.ticks().iter().filter(|tick| tick.has_label).map(|tick| tick.value).collect()
    }

    #[test]
    fn a_log_scale_places_factors_evenly() {
        let scale = Scale::from_values(Kind::Log, [0.012, 40.0].into_iter());
        let steps: Vec<f64> = [0.1, 1.0, 10.0].iter().map(|&v| scale.position(v).unwrap()).collect();
        assert!(((steps[1] - steps[0]) - (steps[2] - steps[1])).abs() < 1e-12);
        assert_eq!((scale.position(0.01), scale.position(50.0)), (Some(0.0), Some(1.0)));
        assert_eq!(scale.position(0.0), None);
        assert_eq!(scale.position(-1.0), None);
        assert_eq!(scale.position(f64::NAN), None);
    }

    #[test]
    fn all_values_lie_on_their_scale() {
        for kind in [Kind::Log, Kind::Linear] {
            for values in [[1e-9, 1e9], [3.0, 3.0], [0.99, 1.01], [7.0, 45.0], [1e-3, 0.5]] {
                let scale = Scale::from_values(kind, values.into_iter());
                for value in values {
                    let place = scale.position(value).unwrap();
                    assert!((0.0..=1.0).contains(&place), "{kind:?} {value} of {values:?} is at {place}");
                }
                assert!(labels(&scale).len() >= 2, "{kind:?} {values:?}: {scale:?}");
                assert!(labels(&scale).len() <= 12, "{kind:?} {values:?}: {:?}", labels(&scale));
            }
        }
    }

    #[test]
    fn few_decades_get_more_labels_and_many_get_fewer() {
        assert_eq!(labels(&Scale::from_values(Kind::Log, [0.11, 90.0].into_iter())), [0.1, 1.0, 10.0, 100.0]);
        assert!(labels(&Scale::from_values(Kind::Log, [2.2, 4.5].into_iter())).len() >= 3);
        let wide = labels(&Scale::from_values(Kind::Log, [1e-12, 1e12].into_iter()));
        assert!((4..=10).contains(&wide.len()), "{wide:?}");
    }

    #[test]
    fn a_linear_scale_starts_at_nought_and_has_round_steps() {
        let scale = Scale::from_values(Kind::Linear, [3.0, 47.0].into_iter());
        assert_eq!(labels(&scale), [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0]);
        assert_eq!(scale.position(25.0), Some(0.5));
        let nothing = Scale::from_values(Kind::Linear, std::iter::empty());
        assert_eq!(nothing.position(10.0), Some(1.0));
    }
}
