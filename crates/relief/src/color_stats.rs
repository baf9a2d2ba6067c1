//! Statistics of colours: their mean and variance.

/// Noise of square roots of light: somewhat more than that of eight bits.
const NOISE: f32 = 0.006;

/// Statistics of some colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColorStats {
    /// Their mean.
    pub color: [f32; 3],
    /// Mean square deviation from the mean, all channels together, noise included.
    pub variance: f32,
}

/// Sums of colours.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ColorAccumulator {
    weight: f32,
    color: [f32; 3],
    square: f32,
}

impl ColorAccumulator {
    /// Adds a linear RGB colour that counts with `weight` ≥ 0.
    pub fn add(&mut self, color: [f32; 3], weight: f32) {
        self.weight += weight;
        (0..3).for_each(|c| self.color[c] += weight * color[c]);
        self.square += weight * color.iter().map(|c| c * c).sum::<f32>();
    }

    /// The statistics of the colours so far; `None` if there are none.
    pub fn stats(&self) -> Option<ColorStats> {
        if self.weight <= 0.0 {
            return None;
        }
        let color = self.color.map(|sum| sum / self.weight);
        let variance = self.square / self.weight - color.iter().map(|c| c * c).sum::<f32>();
        Some(ColorStats { color, variance: variance.max(0.0) + noise_variance(color) })
    }
}

/// The variance of noise, all channels together.
pub(crate) fn noise_variance(color: [f32; 3]) -> f32 {
    4.0 * NOISE * NOISE * color.iter().map(|c| c.max(0.0)).sum::<f32>() + 3.0 * NOISE.powi(4)
}

/// The squared distance of two colours.
pub(crate) fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum()
}
