//! A view of the caller: a picture, and its position in the grid.

/// The least width and height of a view, pixels.
pub const MIN_SIDE_PX: usize = 16;

/// A borrowed picture.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels per row, at least [`MIN_SIDE_PX`](crate::MIN_SIDE_PX).
    pub width: usize,
    /// Number of rows, at least [`MIN_SIDE_PX`](crate::MIN_SIDE_PX).
    pub height: usize,
    /// Red, green and blue row by row from the top, *encoded as for display* (sRGB or a power near 1/2.2), black 0, white 1. Encoded values
    /// are matched because there noise and perceived contrast are about as large in shadows as in light.
    pub rgb: &'a [[f32; 3]],
}

/// A picture of the light field and its position.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The picture from there. All views have one size.
    pub picture: Picture<'a>,
    /// Column and row in units of the grid: columns grow to the right, rows downwards. Any two views differ.
    pub position: [f64; 2],
}
