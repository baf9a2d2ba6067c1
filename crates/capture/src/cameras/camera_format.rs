//! The format of a capture's cameras.

/// The program that computed a capture's cameras.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CameraFormat {
    /// COLMAP: `cameras` and `images` as .bin or .txt.
    Colmap,
    /// nerfstudio or instant-ngp: `transforms.json`.
    Nerfstudio,
    /// Bundler: `bundle.out` and a list of pictures.
    Bundler,
    /// VisualSFM: an .nvm file.
    Nvm,
    /// Agisoft Metashape: exported cameras as .xml.
    Metashape,
}

impl CameraFormat {
    /// The name of the program that writes this format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Colmap => "COLMAP",
            Self::Nerfstudio => "nerfstudio",
            Self::Bundler => "Bundler",
            Self::Nvm => "VisualSFM",
            Self::Metashape => "Metashape",
        }
    }
}
