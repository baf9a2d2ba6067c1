//! Visibility of back faces.

/// Whether the backs of faces that are not double-sided are visible to the camera. Light is blocked from either side
/// in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BackFaces {
    /// Hidden, as glTF specifies: a wall seen from outside opens the view into the room.
    #[default]
    Hide,
    /// Visible, as if every material were double-sided: for files with inverted faces, and for comparison with
    /// renderers that show them.
    Show,
}

impl BackFaces {
    /// Both, with their names in files and on the command line.
    pub const ALL: [(&'static str, Self); 2] = [("hide", Self::Hide), ("show", Self::Show)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, candidate)| *candidate == self).map_or("", |(name, _)| name)
    }

    /// The setting with this name in files and on the command line; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, back_faces)| *back_faces)
    }
}
