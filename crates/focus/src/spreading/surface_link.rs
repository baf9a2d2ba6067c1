//! A link between two texels of the surface.

/// Two neighbouring texels, by their indices in the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceLink {
    pub texels: [u32; 2],
    /// Conductance of the link apart from what the texels look like, in (0, 1].
    pub conductance: f32,
}
