//! Plots as inline SVG: `scale` maps numbers to positions and finds ticks, `number_text` formats them, `chart`
//! draws, `labels` places labels without overlap.

mod chart;
mod labels;
mod scale;

pub use crate::number_text::{bytes, plain, seconds, significant, with_minus};
pub use chart::{Axis, Chart, Point, Rule, Series};
pub use scale::Kind;
