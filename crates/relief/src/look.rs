//! Colours that are alike: their mean, and how much they vary.

/// Noise of square roots of light: somewhat more than eight bits leave.
const NOISE: f32 = 0.006;

/// What some colours have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColorStats {
    /// Their mean.
    pub color: [f32; 3],
    /// Mean square deviation from it, all channels together, noise included.
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
    /// Adds a colour that counts by a weight ≥ 0.
    pub fn add(&mut self, color: [f32; 3], weight: f32) {
        self.weight += weight;
        (0..3).for_each(|c| self.color[c] += weight * color[c]);
        self.square += weight * color.iter().map(|c| c * c).sum::<f32>();
    }

    /// What they have in common, if there are any.
    pub fn stats(&self) -> Option<ColorStats> {
        if self.weight <= 0.0 {
            return None;
        }
        let color = self.color.map(|sum| sum / self.weight);
        let variance = self.square / self.weight - color.iter().map(|c| c * c).sum::<f32>();
        Some(ColorStats { color, variance: variance.max(0.0) + noise_variance(color) })
    }
}

/// Variance by noise, all channels together.
pub(crate) fn noise_variance(color: [f32; 3]) -> f32 {
    4.0 * NOISE * NOISE * color.iter().map(|c| c.max(0.0)).sum::<f32>() + 3.0 * NOISE.powi(4)
}

/// How far two colours are apart, squared.
pub(crate) fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum()
}
