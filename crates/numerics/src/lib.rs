//! Small numerical routines that several crates share: order statistics, robust scale, Cholesky solves, luminance,
//! smooth steps, PSNR, the sRGB curve; inner loops compiled for the widest SIMD instructions of the machine; and, for whole programs that
//! contain this crate, sines, exponentials and their kin, and C's sorting, that are the same on every system.
//!
//! Results are bitwise reproducible. The order of the floating-point operations is part of each function's contract;
//! values are compared by [`f64::total_cmp`], so that NaN and signed zeros have a place, too.
//!
//! ```
//! use numerics::{luminance, quantile, solve_positive, upper_median};
//!
//! assert_eq!(upper_median(&mut [4.0, 1.0, 2.0, 3.0]), Some(3.0));
//! assert_eq!(quantile(&mut [4.0, 1.0, 2.0, 3.0], 1.0), Some(4.0));
//! // [4 2; 2 2] x = (8, 6)
//! let mut right = [8.0, 6.0];
//! solve_positive(&mut [4.0, 2.0, 2.0, 2.0], &mut right);
//! assert_eq!(right, [1.0, 2.0]);
//! assert_eq!(luminance([0.0f32, 1.0, 0.0]), 0.7152);
//! ```

mod cholesky;
mod elementary_functions;
mod luminance;
mod merge_sort;
mod order_statistics;
mod psnr;
mod real;
mod robust_scale;
mod simd_dispatch;
mod smoothstep;
mod srgb;

pub use cholesky::{back_substitute, decompose_positive, forward_substitute, solve_positive};
pub use luminance::{REC709_LUMINANCE, luminance};
pub use order_statistics::{
    median, order_statistic, quantile, quantile_of_sorted, upper_median, upper_quantile_of_sorted,
};
pub use psnr::{mean_square_of_psnr, psnr};
pub use real::Real;
pub use robust_scale::{MAD_OF_NORMAL, MAD_SCALE, scaled_mad};
pub use simd_dispatch::{prefetch, with_widest_simd};
pub use smoothstep::{smooth_fraction, smoothstep};
pub use srgb::{linear_from_srgb, screen_level, srgb_from_linear};
