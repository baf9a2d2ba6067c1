//! The candidate disparities, evenly spaced.

/// Disparities `low + label · step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Labels {
    /// The disparity of label 0, pixels per step of the grid.
    pub low: f32,
    /// From one label to the next, pixels per step of the grid.
    pub step: f32,
    /// Number of labels, at least 3.
    pub count: usize,
}

impl Labels {
    /// Labels, at least three, that cover the disparities `low..=high` no more than `step` apart.
    pub fn covering(low: f32, high: f32, step: f32) -> Self {
        let count = (((high - low) / step).ceil() as usize + 1).max(3);
        Self { low, step: ((high - low) / (count - 1) as f32).max(f32::MIN_POSITIVE), count }
    }

    /// The disparity of a label; a fraction lies between two labels.
    pub fn disparity(&self, label: f32) -> f32 {
        self.low + label * self.step
    }
}
