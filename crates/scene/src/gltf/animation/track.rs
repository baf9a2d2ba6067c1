//! An animation sampler: times, and a value for each.

use super::interpolation::{Interpolation, hermite, linear, slerp};
use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};

/// Keyframes. Elements are read one at a time, so that a long track costs nothing.
pub(super) struct Track<'a> {
    times: Accessor<'a>,
    values: Accessor<'a>,
    interpolation: Interpolation,
    /// Elements of `values` that make one value: the number of morph targets, or one.
    elements: usize,
    place: String,
}

impl<'a> Track<'a> {
    /// Opens and checks a sampler of an animation.
    ///
    /// # Errors
    /// Its accessors or its interpolation are faulty.
    pub fn open(document: &'a Document<'_>, sampler: &Object<'_>) -> Result<Self, Fault> {
        let accessor = |key: &str| -> Result<Accessor<'a>, Fault> {
            let index = sampler.index(key)?.ok_or_else(|| sampler.malformed(key, "is missing"))?;
            Accessor::open(document, index, &format!("{}/{key}", sampler.place))
        };
        let (times, values) = (accessor("input")?.expect_components(&[1], "times")?, accessor("output")?);
        if times.component != Component::F32 {
            return Err(times.malformed("times must be floats"));
        }
        let name = sampler.text("interpolation")?;
        let interpolation = Interpolation::from_name(name)
            .ok_or_else(|| sampler.malformed("interpolation", "is none of STEP, LINEAR, CUBICSPLINE"))?;
        let parts = times.count.saturating_mul(interpolation.values_per_key());
        let elements = values.count.checked_div(parts).unwrap_or(0);
        if elements == 0 || values.count != elements * parts || values.shape.is_matrix() {
            let what = format!("has {} values for {} times", values.count, times.count);
            return Err(sampler.malformed("output", what));
        }
        let track = Self { times, values, interpolation, elements, place: sampler.place.clone() };
        if track.times.count > 1 && track.end_seconds() <= track.time(0) {
            document.warn(format!("{}/input: the times of its keys do not increase", track.place));
        }
        Ok(track)
    }

    fn time(&self, key: usize) -> f64 {
        let [time] = self.times.doubles(key);
        time
    }

    /// The time of the last key, s.
    pub fn end_seconds(&self) -> f64 {
        self.time(self.times.count - 1)
    }

    /// The value at a time, s. Before the first key it is that of the first, after the last that of the last.
    /// Rotations are interpolated on the sphere.
    ///
    /// # Errors
    /// The budget of steps or memory is exhausted.
    pub fn sample(
        &self,
        document: &Document<'_>,
        seconds: f64,
        is_rotation: bool,
    ) -> Result<Vec<f64>, Fault> {
        let numbers = self.elements as u64 * self.values.shape.components() as u64;
        document.budget.take_work(16 + 8 * numbers, &self.place)?;
        document.budget.take_memory(64 * numbers, &self.place)?;
        let values = self.interpolate(seconds, is_rotation);
        document.budget.release_memory(64 * numbers);
        Ok(values)
    }

    fn interpolate(&self, seconds: f64, is_rotation: bool) -> Vec<f64> {
        let after = self.key_count_until(seconds);
        let Some(before) = after.checked_sub(1) else { return self.value(0) };
        if after == self.times.count {
            return self.value(before);
        }
        let span = self.time(after) - self.time(before);
        let u = (seconds - self.time(before)) / span;
        // Times that do not increase have no position between them.
        let u = if u.is_finite() { u.clamp(0.0, 1.0) } else { 0.0 };
        match self.interpolation {
            Interpolation::Step => self.value(before),
            Interpolation::Linear => match (self.value(before), self.value(after)) {
                (a, b) if is_rotation => match (<[f64; 4]>::try_from(&a[..]), <[f64; 4]>::try_from(&b[..])) {
                    (Ok(a), Ok(b)) => slerp(a, b, u).to_vec(),
                    _ => a,
                },
                (a, b) => linear(&a, &b, u),
            },
            Interpolation::Cubic => {
                let from = [self.value(before), self.spline_part(before, 2)];
                let to = [self.value(after), self.spline_part(after, 0)];
                hermite([&from[0], &from[1]], [&to[0], &to[1]], span, u)
            }
        }
    }

    /// Number of keys at or before a time.
    fn key_count_until(&self, seconds: f64) -> usize {
        let (mut low, mut high) = (0, self.times.count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.time(middle) <= seconds { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// The value of a key.
    fn value(&self, key: usize) -> Vec<f64> {
        self.spline_part(key, usize::from(self.interpolation == Interpolation::Cubic))
    }

    /// Incoming tangent (0), value (1) or outgoing tangent (2) of a spline's key; other keys have only a value.
    fn spline_part(&self, key: usize, part: usize) -> Vec<f64> {
        let first = (key * self.interpolation.values_per_key() + part) * self.elements;
        let components = self.values.shape.components();
        let element =
            |index: usize| (0..components).map(move |component| self.values.value(index, component));
        (first..first + self.elements).flat_map(element).collect()
    }
}
