//! Plots as inline SVG: `scale` maps numbers to places and finds ticks, `number` writes them, `chart` draws, `labels` keeps its words apart.

mod chart;
mod labels;
mod number;
mod scale;

pub use chart::{Axis, Chart, Point, Rule, Series};
pub use number::{bytes, plain, seconds, significant, with_minus};
pub use scale::Kind;
