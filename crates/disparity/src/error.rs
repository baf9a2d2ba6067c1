//! Why disparities cannot be computed.

use progress::Cancelled;

/// Why there are no disparities. Displays as `view N: what is wrong (what to do)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DisparityError {
    /// One view shows no parallax.
    #[error("a light field of {views} view has no parallax (give two views or more)")]
    TooFewViews {
        /// How many there are.
        views: usize,
    },
    /// A request for a view that does not exist.
    #[error("view {view} was requested, but there are only {views} views (views are counted from 0)")]
    NoSuchView {
        /// The requested view.
        view: usize,
        /// How many there are.
        views: usize,
    },
    /// A picture does not have the size that is specified, or that the others have.
    #[error("view {view}: {what} (all views need one size, {smallest} pixels a side or more)", smallest = crate::view::MIN_SIDE_PX)]
    Size {
        /// The view.
        view: usize,
        /// What its size is, and what it should be.
        what: String,
    },
    /// A pixel that is no number.
    #[error("view {view}, pixel ({x}, {y}): not a finite number (replace it with a neighbouring colour)")]
    NotFinite {
        /// The view.
        view: usize,
        /// The pixel's column.
        x: usize,
        /// The pixel's row.
        y: usize,
    },
    /// A position that is no finite number, or that two views share.
    #[error("view {view}: {what} (every view needs a position of its own in the grid)")]
    Position {
        /// The view.
        view: usize,
        /// What is wrong.
        what: String,
    },
    /// A range of disparities that is empty.
    #[error("disparities from {low} to {high}: {why}")]
    Range {
        /// The least, pixels a step of the grid.
        low: f32,
        /// The largest, pixels a step of the grid.
        high: f32,
        /// What is wrong, and what to do.
        why: String,
    },
    /// Too few known disparities to decode colours.
    #[error("{samples} known disparities are too few to decode a colour-coded map (give 40 or more)")]
    TooFewSamples {
        /// How many there are.
        samples: usize,
    },
    /// A known disparity that is no number or lies outside the map.
    #[error("known disparity {sample}: outside the map or not a finite number (leave it out)")]
    SampleOutside {
        /// Which, counted from 0.
        sample: usize,
    },
    /// A picture whose colours are no code of the known disparities.
    #[error(
        "the colour-coded map cannot be decoded: {why} (residual {percent:.1} % of the range; give the map that belongs to these views)"
    )]
    NotColourCoded {
        /// The median residual, percent of the range that was fitted.
        percent: f32,
        /// What is wrong.
        why: String,
    },
    /// `progress` cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
