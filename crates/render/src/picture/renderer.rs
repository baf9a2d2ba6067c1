//! The renderers.

/// The renderer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Renderer {
    /// Splatting of the light field.
    #[default]
    Splat,
    /// The ground truth: distributed ray tracing.
    Truth,
    /// A baseline: the pinhole picture blurred by each pixel's circle of confusion.
    Blur,
    /// A baseline: the pinhole picture split into depth layers that are blurred and composited.
    Layers,
    /// A baseline: pinhole views over the aperture, shifted and added.
    Views,
    /// A baseline for Gaussian splats: each made larger by its circle of confusion, as other programs blur them.
    Dilation,
    /// A baseline: every ray of the light field scattered to one pixel.
    Scatter,
}

impl Renderer {
    /// All renderers with their names on the command line.
    pub const ALL: [(&'static str, Renderer); 7] = [
        ("splat", Renderer::Splat),
        ("truth", Renderer::Truth),
        ("blur", Renderer::Blur),
        ("layers", Renderer::Layers),
        ("views", Renderer::Views),
        ("dilation", Renderer::Dilation),
        ("scatter", Renderer::Scatter),
    ];

    /// The renderer with this name on the command line; `None` if there is none.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(entry_name, _)| *entry_name == name).map(|(_, renderer)| *renderer)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, renderer)| *renderer == self).map_or("", |(name, _)| name)
    }

    /// Whether it determines where light paths end, as alpha, Cryptomatte and the pinhole picture require.
    pub fn resolves_paths(self) -> bool {
        matches!(self, Self::Splat | Self::Truth)
    }

    /// Whether it draws from a light field.
    pub fn draws_light_field(self) -> bool {
        matches!(self, Self::Splat | Self::Scatter)
    }
}
