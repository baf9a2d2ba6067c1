//! The reconstruction filter: what share of a sample each pixel near it gets.

use glam::DVec2;

/// How samples become pixels: the weight of a sample by its offset from the pixel's middle, the product of a
/// function of x and one of y. Every filter integrates to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReconstructionFilter {
    /// Even over ± `radius` px; with the default ½ the mean over the pixel's own square.
    Box {
        /// Half the side, px.
        radius: f64,
    },
    /// Falls off evenly, to 0 at `radius` px.
    Tent {
        /// Half the base, px.
        radius: f64,
    },
    /// A Gaussian bell of standard deviation `radius`/3, lowered to meet 0 at `radius` px.
    Gaussian {
        /// Half the base, px.
        radius: f64,
    },
}

impl Default for ReconstructionFilter {
    fn default() -> Self {
        Self::Box { radius: 0.5 }
    }
}

impl ReconstructionFilter {
    /// The smallest and the largest radius that is accepted, px; others are moved to these.
    pub const RADII: [f64; 2] = [0.5, 8.0];

    /// How far from a pixel's middle samples count, px; limited to the radii that are supported.
    pub fn radius(self) -> f64 {
        let (Self::Box { radius } | Self::Tent { radius } | Self::Gaussian { radius }) = self;
        let [least, greatest] = Self::RADII;
        // Not `clamp`, which keeps what is not a number.
        if radius > least { radius.min(greatest) } else { least }
    }

    /// Whether every sample belongs to exactly one pixel, the one that it lands in.
    pub(super) fn is_own_pixel(self) -> bool {
        matches!(self, Self::Box { .. }) && self.radius() == 0.5
    }

    /// The weight along one axis at `x` px from the pixel's middle.
    fn along_axis(self, x: f64) -> f64 {
        let radius = self.radius();
        let x = x / radius;
        if !(-1.0..1.0).contains(&x) {
            return 0.0;
        }
        let shape = match self {
            Self::Box { .. } => 0.5,
            Self::Tent { .. } => 1.0 - x.abs(),
            Self::Gaussian { .. } => {
                // exp(−y²/2) − exp(−9/2) for y = 3x; over ±1 in x it integrates to GAUSSIAN_INTEGRAL.
                ((-4.5 * x * x).exp() - (-4.5f64).exp()) / GAUSSIAN_INTEGRAL
            }
        };
        shape / radius
    }

    /// The pixels that a sample at `position` (px) counts for, as column, row and weight.
    pub(super) fn weights(self, position: DVec2) -> impl Iterator<Item = (i64, i64, f64)> {
        let radius = self.radius();
        let span = move |x: f64| (x - radius).floor() as i64..=(x + radius).floor() as i64;
        let weight = move |x: f64, pixel: i64| self.along_axis(x - (pixel as f64 + 0.5));
        span(position.y).flat_map(move |row| {
            let across = weight(position.y, row);
            span(position.x).filter_map(move |column| {
                let weight = across * weight(position.x, column);
                (weight > 0.0).then_some((column, row, weight))
            })
        })
    }
}

/// ∫₋₁¹ exp(−(3x)²/2) − exp(−9/2) dx = (√(2π)·erf(3/√2) − 6·exp(−9/2))/3.
const GAUSSIAN_INTEGRAL: f64 = 0.811_068_970_084_547;

#[cfg(test)]
mod tests {
    use super::*;

    const FILTERS: [ReconstructionFilter; 5] = [
        ReconstructionFilter::Box { radius: 0.5 },
        ReconstructionFilter::Box { radius: 1.25 },
        ReconstructionFilter::Tent { radius: 1.0 },
        ReconstructionFilter::Gaussian { radius: 1.5 },
        ReconstructionFilter::Gaussian { radius: 4.0 },
    ];

    #[test]
    fn each_integrates_to_one_and_is_even() {
        for filter in FILTERS {
            let (radius, steps) = (filter.radius(), 20_000);
            let x = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) * 2.0 * radius - radius;
            let sum: f64 = (0..steps).map(|k| filter.along_axis(x(k))).sum();
            let integral = sum * 2.0 * radius / f64::from(steps);
            assert!((integral - 1.0).abs() < 1e-6, "{filter:?}: {integral}");
            assert_eq!(filter.along_axis(0.3), filter.along_axis(-0.3));
            assert_eq!(filter.along_axis(radius), 0.0);
        }
    }

    #[test]
    fn the_default_is_the_pixel_that_is_hit() {
        for (x, y) in [(3.0, 7.0), (3.999_999_9, 7.5), (0.0, 0.0), (-0.25, -3.0)] {
            let hits: Vec<_> = ReconstructionFilter::default().weights(DVec2::new(x, y)).collect();
            assert_eq!(hits, [(x.floor() as i64, y.floor() as i64, 1.0)]);
        }
    }

    #[test]
    fn tents_share_out_every_sample() {
        for k in 0..100 {
            let position = DVec2::new(0.0713, 0.0377) * f64::from(k);
            let tent = ReconstructionFilter::Tent { radius: 1.0 };
            let sum: f64 = tent.weights(position).map(|(_, _, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
    }

    #[test]
    fn senseless_radii_are_mended() {
        for radius in [f64::NAN, -1.0, 0.0, 1e-9] {
            assert_eq!(ReconstructionFilter::Tent { radius }.radius(), 0.5);
        }
        assert_eq!(ReconstructionFilter::Gaussian { radius: f64::INFINITY }.radius(), 8.0);
    }
}
