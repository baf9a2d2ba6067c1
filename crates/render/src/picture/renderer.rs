//! Who can draw the picture.

/// What draws the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Renderer {
    /// The light field, splatted.
    #[default]
    Splat,
    /// Distributed ray tracing.
    Truth,
    /// A baseline: a blur of the pinhole picture by each pixel's own circle of confusion.
    Blur,
    /// A baseline: the pinhole picture cut to layers by depth, each blurred, composited.
    Layers,
    /// A baseline: pinhole views over the aperture, shifted and added.
    Views,
    /// A baseline: every ray of the light field, thrown at one pixel.
    Scatter,
}

impl Renderer {
    /// All of them, by the names that the command line knows.
    pub const ALL: [(&'static str, Renderer); 6] = [
        ("splat", Renderer::Splat),
        ("truth", Renderer::Truth),
        ("blur", Renderer::Blur),
        ("layers", Renderer::Layers),
        ("views", Renderer::Views),
        ("scatter", Renderer::Scatter),
    ];

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(entry_name, _)| *entry_name == name).map(|(_, renderer)| *renderer)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, renderer)| *renderer == self).map_or("", |(name, _)| name)
    }

    /// Whether it tells where light paths end: what alpha, Cryptomatte and the pinhole's picture are made of.
    pub fn resolves_paths(self) -> bool {
        matches!(self, Self::Splat | Self::Truth)
    }

    /// Whether it draws from a light field.
    pub fn draws_light_field(self) -> bool {
        matches!(self, Self::Splat | Self::Scatter)
    }
}
