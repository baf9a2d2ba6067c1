//! Which disparities are wanted.

/// What is asked of a light field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisparityRequest {
    /// The view whose disparities are found first; the middle one has the most neighbours. Counted from 0.
    pub reference: usize,
    /// Other views whose disparities are wanted, consistent with the reference's; the outermost see most of what it does not.
    pub others: Vec<usize>,
    /// The least and the largest disparity, pixels a step of the grid; `None` to find them (parallax of up to 15 % of the width
    /// between reference and farthest view is looked for).
    pub range: Option<(f32, f32)>,
}
