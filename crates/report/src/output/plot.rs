//! Plots as inline SVG: `scale` maps numbers to positions and finds ticks, `number` formats them, `chart`
//! draws, `labels` places labels without overlap.

mod chart;
mod labels;
mod number;
mod scale;

pub use chart::{Axis, Chart, Point, Rule, Series};
pub use number::{bytes, plain, seconds, significant, with_minus};
pub use scale::Kind;
