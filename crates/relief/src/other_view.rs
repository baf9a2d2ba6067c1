//! Views that look behind what stands before something.

/// A view beside the one that the surface is of.
pub struct OtherView<'a, E> {
    /// How many steps to the right and downward it was taken from: a pixel (x, y) of disparity d is at (x − d·dx, y − d·dy) in it.
    pub offset: [f32; 2],
    /// Reads it: linear RGB, as many pixels.
    pub read: Box<dyn Fn() -> Result<Vec<[f32; 3]>, E> + Sync + 'a>,
}
