//! A view as the caller has it: a picture, and where in the grid it was taken.

/// Pixels a side that a view needs.
pub const MIN_SIDE_PX: usize = 16;

/// A picture that is only looked at.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels a row, at least [`SMALLEST`](crate::SMALLEST).
    pub width: usize,
    /// Rows, at least [`SMALLEST`](crate::SMALLEST).
    pub height: usize,
    /// Red, green and blue row by row from the top, *encoded as for display* (sRGB or a power near 1/2.2), black 0, white 1.
    /// Encoded values are what is matched, for there noise and what an eye calls contrast are about as large in shadows as in light.
    pub rgb: &'a [[f32; 3]],
}

/// A picture of the light field and its place.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// What is seen from there. All views have one size.
    pub picture: Picture<'a>,
    /// Column and row in units of the grid: columns grow to the right, rows downwards. Any two views differ.
    pub position: [f64; 2],
}
