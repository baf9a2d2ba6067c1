//! Whether faces are seen from behind.

/// Whether the backs of faces that are not double sided are seen. Light is stopped by either side, whatever is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BackFaces {
    /// Not seen, as glTF asks for: a wall that is looked at from outside opens the room.
    #[default]
    Hide,
    /// Seen, as if every material were double sided: for files whose faces are turned, and to compare with renderers that
    /// show them.
    Show,
}

impl BackFaces {
    /// Both, by the names that files and the command line know.
    pub const ALL: [(&'static str, Self); 2] = [("hide", Self::Hide), ("show", Self::Show)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, candidate)| *candidate == self).map_or("", |(name, _)| name)
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, back_faces)| *back_faces)
    }
}
