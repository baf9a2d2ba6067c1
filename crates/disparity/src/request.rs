//! Which disparities are to be computed.

/// A request for the disparities of a light field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisparityRequest {
    /// The view whose disparities are computed first, counted from 0; the middle one has the most neighbours.
    pub reference: usize,
    /// Other views whose disparities are computed, consistent with the reference's; the outermost see most of what it
    /// does not.
    pub others: Vec<usize>,
    /// The least and the greatest disparity, pixels per step of the grid; `None` to estimate them (a parallax of up to 15 % of the width
    /// between the reference and the farthest view is searched).
    pub range: Option<(f32, f32)>,
}
