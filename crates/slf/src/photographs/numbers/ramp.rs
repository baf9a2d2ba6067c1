//! Where something begins to count, and where it counts in full.

/// Rises smoothly from 0 at the first value to 1 at the second.
pub(crate) fn ramp(value: f32, [from, to]: [f32; 2]) -> f32 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
