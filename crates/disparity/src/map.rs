//! The result for a view.

/// The disparities of a view: for each pixel how far it moves from view to view.
#[derive(Clone, Debug, PartialEq)]
pub struct DisparityMap {
    /// The index of the view.
    pub view: usize,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the top, pixels per step of the grid. The pixel (x, y) is at (x − d Δcolumn, y − d Δrow) in a view that lies
    /// (Δcolumn, Δrow) from this one: nearer points have larger disparities. All are finite.
    pub disparity: Vec<f32>,
    /// How well the pictures determine each, in [0, 1]: near 1 where the views agree on a place to a tenth of a pixel, near 0 where the
    /// surface is plain and the disparity follows its surroundings, or where views disagree (gloss, glass).
    pub confidence: Vec<f32>,
}
