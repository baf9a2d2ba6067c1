//! Numbers of a depth map as a file stores them, before they are interpreted.

/// The numbers of a file.
pub(crate) struct Stored {
    pub width: u32,
    pub height: u32,
    /// Row 0 on top.
    pub values: Vec<f32>,
    pub numbers: Numbers,
}

/// The encoding of the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// Floats: they may be physical quantities.
    Floats,
    /// Grey levels of a picture, 0 black to 1 white: without a scale of their own.
    Levels,
}
