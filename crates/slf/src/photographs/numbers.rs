//! What is asked of numbers, whatever they are of.

mod median;
mod positive;
mod ramp;

pub(crate) use median::median;
pub(crate) use positive::solve_positive;
pub(crate) use ramp::ramp;
