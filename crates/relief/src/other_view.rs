//! Views that see behind occluders.

/// A view next to the one that the surface is made of.
pub struct OtherView<'a, E> {
    /// Position relative to that view, in steps to the right and downward: a pixel (x, y) of disparity d is at (x −
    /// d·dx, y − d·dy) in it.
    pub offset: [f32; 2],
    /// Reads its pixels: linear RGB, as many as the picture has.
    pub read: Box<dyn Fn() -> Result<Vec<[f32; 3]>, E> + Sync + 'a>,
}
