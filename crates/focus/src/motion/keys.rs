//! Keyframes.

use numerics::smooth_fraction;
use serde::{Deserialize, Serialize};

/// Interpolation from a value to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ease {
    /// Constant until the next.
    Hold,
    /// Linear.
    Linear,
    /// Smooth at both ends: 3u² − 2u³.
    #[default]
    Smooth,
}

impl Ease {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Ease); 3] =
        [("hold", Ease::Hold), ("linear", Ease::Linear), ("smooth", Ease::Smooth)];

    /// The interpolation with this name in files; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, ease)| *ease)
    }

    /// Interpolation weight of the next value, in [0, 1], at the fraction u in [0, 1] of the time between.
    pub fn share(self, u: f64) -> f64 {
        match self {
            Self::Hold => 0.0,
            Self::Linear => u,
            Self::Smooth => smooth_fraction(u),
        }
    }
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key<T> {
    /// The time, s.
    pub seconds: f64,
    /// The value.
    pub value: T,
    /// Interpolation to the next key.
    #[serde(default)]
    pub ease: Ease,
}

/// Keyframes, in ascending order of time. Before the first and after the last the value is constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Keys<T>(Vec<Key<T>>);

impl<T> Default for Keys<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

/// Two neighbouring values and the interpolation weight between them, in [0, 1].
#[derive(Debug, PartialEq)]
pub struct KeySpan<'a, T> {
    /// The value before.
    pub from: &'a T,
    /// The value after.
    pub to: &'a T,
    /// 0 at `from`, 1 at `to`.
    pub share: f64,
}

impl KeySpan<'_, f64> {
    /// The number at the time in question, never beyond either end.
    pub fn interpolate(&self) -> f64 {
        mix(*self.from, *self.to, self.share)
    }
}

/// The number at `share` of the way from a to b, never beyond either.
pub(crate) fn mix(a: f64, b: f64, share: f64) -> f64 {
    (a + (b - a) * share).clamp(a.min(b), a.max(b))
}

impl<T> Keys<T> {
    /// Maximum number of keys of one property.
    pub const MAX_KEYS: usize = 4096;

    /// The keys, ascending in time.
    pub fn keys(&self) -> &[Key<T>] {
        &self.0
    }

    /// Whether there are none, so that nothing is animated.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Inserts a key; one at the same time is replaced. Returns false, and changes nothing, if there are too many
    /// already.
    #[must_use]
    pub fn insert(&mut self, key: Key<T>) -> bool {
        let at = self.0.partition_point(|other| other.seconds < key.seconds);
        if self.0.get(at).is_some_and(|other| other.seconds == key.seconds) {
            self.0[at] = key;
        } else if self.0.len() < Self::MAX_KEYS {
            self.0.insert(at, key);
        } else {
            return false;
        }
        true
    }

    /// Removes the key at exactly this time, s. Returns whether there was one.
    pub fn remove(&mut self, seconds: f64) -> bool {
        let count = self.0.len();
        self.0.retain(|key| key.seconds != seconds);
        self.0.len() < count
    }

    /// The values of the keys before and after a time, s, and how far it lies between them; `None` without keys.
    pub fn span_at(&self, seconds: f64) -> Option<KeySpan<'_, T>> {
        let after = self.0.partition_point(|key| key.seconds <= seconds);
        let before = after.checked_sub(1).and_then(|before| self.0.get(before));
        Some(match (before, self.0.get(after)) {
            (Some(before), Some(after)) => {
                let u = ((seconds - before.seconds) / (after.seconds - before.seconds)).clamp(0.0, 1.0);
                KeySpan { from: &before.value, to: &after.value, share: before.ease.share(u) }
            }
            (Some(only), None) | (None, Some(only)) => {
                KeySpan { from: &only.value, to: &only.value, share: 0.0 }
            }
            (None, None) => return None,
        })
    }

    /// Whether times ascend and are finite and all values are usable; a file may contain others.
    pub fn is_valid(&self, is_usable: impl Fn(&T) -> bool) -> bool {
        self.0.len() <= Self::MAX_KEYS
            && self.0.iter().all(|key| key.seconds.is_finite() && is_usable(&key.value))
            && self.0.windows(2).all(|pair| pair[0].seconds < pair[1].seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(seconds: f64, value: f64, ease: Ease) -> Key<f64> {
        Key { seconds, value, ease }
    }

    #[test]
    fn values_run_from_key_to_key() {
        let mut keys = Keys::default();
        assert!(keys.span_at(0.0).is_none());
        for (seconds, value, ease) in
            [(2.0, 1.0, Ease::Hold), (0.0, 3.0, Ease::Smooth), (1.0, 5.0, Ease::Linear)]
        {
            assert!(keys.insert(key(seconds, value, ease)));
        }
        let at = |seconds: f64| keys.span_at(seconds).unwrap().interpolate();
        assert_eq!(
            [at(-1.0), at(0.0), at(0.5), at(1.0), at(1.25), at(2.0), at(9.0)],
            [3.0, 3.0, 4.0, 5.0, 4.0, 1.0, 1.0]
        );
        assert!((at(0.25) - (3.0 + 2.0 * 0.15625)).abs() < 1e-12, "slowly at first");
        assert!(keys.insert(key(1.0, 7.0, Ease::Hold)) && keys.keys().len() == 3, "one at a time");
        assert_eq!(keys.span_at(1.9).unwrap().interpolate(), 7.0);
        assert!(keys.remove(1.0) && !keys.remove(1.0));
    }

    #[test]
    fn invalid_keys_are_detected() {
        let usable = |keys: &str| serde_json::from_str::<Keys<f64>>(keys).unwrap().is_valid(|v| *v > 0.0);
        assert!(usable(r#"[{"seconds": 0, "value": 1}, {"seconds": 1, "value": 2, "ease": "hold"}]"#));
        assert!(!usable(r#"[{"seconds": 1, "value": 1}, {"seconds": 1, "value": 2}]"#));
        assert!(!usable(r#"[{"seconds": 0, "value": -1}]"#));
        assert!(
            serde_json::from_str::<Keys<f64>>(r#"[{"seconds": 0, "value": 1, "ease": "bouncy"}]"#).is_err()
        );
    }
}
