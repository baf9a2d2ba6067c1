//! What can keep disparities from being found.

use progress::Cancelled;

/// Why there are no disparities.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DisparityError {
    /// One view shows no parallax.
    #[error("a light field of {views} view has no parallax (give two views or more)")]
    TooFewViews {
        /// How many there are.
        views: usize,
    },
    /// A view is asked for that is not there.
    #[error("view {view} is asked for, but there are {views} (views are counted from 0)")]
    NoSuchView {
        /// The view that is asked for.
        view: usize,
        /// How many there are.
        views: usize,
    },
    /// A picture does not have the size that it says, or that the others have.
    #[error("view {view}: {what} (all views need one size, {smallest} pixels a side or more)", smallest = crate::view::MIN_SIDE_PX)]
    Size {
        /// The view.
        view: usize,
        /// What its size is, and what it should be.
        what: String,
    },
    /// A pixel that is no number.
    #[error("view {view}, pixel ({x}, {y}): not a finite number (replace it by the colour beside it)")]
    NotFinite {
        /// The view.
        view: usize,
        /// The pixel's column.
        x: usize,
        /// The pixel's row.
        y: usize,
    },
    /// A position that is no number, or that two views share.
    #[error("view {view}: {what} (every view needs a place of its own in the grid)")]
    Position {
        /// The view.
        view: usize,
        /// What is wrong.
        what: String,
    },
    /// A range of disparities from which nothing can be chosen.
    #[error("disparities from {low} to {high}: {why}")]
    Range {
        /// The least, pixels a step of the grid.
        low: f32,
        /// The largest, pixels a step of the grid.
        high: f32,
        /// What is wrong, and what to do.
        why: String,
    },
    /// Too few disparities are known to read colours by.
    #[error("{samples} known disparities are too few to read a map of colours by (give 40 or more)")]
    TooFewSamples {
        /// How many there are.
        samples: usize,
    },
    /// A known disparity that is no number or lies outside of the map.
    #[error("known disparity {sample}: outside of the map or not a finite number (leave it out)")]
    SampleOutside {
        /// Which, counted from 0.
        sample: usize,
    },
    /// A picture whose colours are no code of the disparities that are known.
    #[error(
        "the map of colours cannot be read: {why} (residual {percent:.1} % of the range; give the map that belongs to these views)"
    )]
    NotColourCoded {
        /// The median residual, percent of the range that was fitted.
        percent: f32,
        /// What is wrong.
        why: String,
    },
    /// The watcher stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
