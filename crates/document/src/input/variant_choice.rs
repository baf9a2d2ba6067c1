//! Which variant of a scene is asked for.

/// A variant of a scene (KHR_materials_variants), as asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum VariantChoice {
    /// That of the project; a scene's own materials.
    #[default]
    AsSaved,
    /// The scene's own materials, whatever a project says.
    Own,
    /// The one of this name, whatever a project says.
    Named(String),
}

impl VariantChoice {
    /// The name of the variant where the project, if there is one, says `saved`; none: the scene's own materials.
    pub(crate) fn name<'a>(&'a self, saved: Option<&'a str>) -> Option<&'a str> {
        match self {
            Self::AsSaved => saved,
            Self::Own => None,
            Self::Named(name) => Some(name),
        }
    }
}
