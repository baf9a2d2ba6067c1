//! The requested variant of a scene.

/// The requested variant of a scene (KHR_materials_variants).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum VariantChoice {
    /// The project's variant; for a scene, its own materials.
    #[default]
    AsSaved,
    /// The scene's own materials, overriding a project.
    Own,
    /// The variant of this name, overriding a project.
    Named(String),
}

impl VariantChoice {
    /// The choice that a name stands for on the command line and in scripts: none for the project's, an empty one for the scene's own
    /// materials.
    pub fn from_argument(name: Option<&str>) -> Self {
        match name {
            None => Self::AsSaved,
            Some("") => Self::Own,
            Some(name) => Self::Named(name.into()),
        }
    }

    /// The name of the variant, if the project's is `saved`; `None` for the scene's own materials.
    pub(crate) fn name<'a>(&'a self, saved: Option<&'a str>) -> Option<&'a str> {
        match self {
            Self::AsSaved => saved,
            Self::Own => None,
            Self::Named(name) => Some(name),
        }
    }
}
