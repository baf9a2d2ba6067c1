//! Which format a file has.

/// A format of splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplatFormat {
    /// `.ply` as 3D Gaussian Splatting writes it.
    Ply,
    /// `.ply` with packed integers in chunks of 256, as SuperSplat writes it.
    CompressedPly,
    /// `.spz`, version 1 to 4.
    Spz,
    /// `.sog`: pictures and a `meta.json` in a zip archive, version 1 or 2.
    Sog,
    /// The same in a folder.
    SogFolder,
    /// `.splat`: 32 bytes each, without a header.
    Splat,
    /// `.ksplat`: sections and buckets.
    Ksplat,
    /// glTF with `KHR_gaussian_splatting`.
    Gltf,
}

impl SplatFormat {
    /// The usual name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "3DGS PLY",
            Self::CompressedPly => "compressed PLY",
            Self::Spz => "SPZ",
            Self::Sog | Self::SogFolder => "SOG",
            Self::Splat => "splat",
            Self::Ksplat => "ksplat",
            Self::Gltf => "glTF (KHR_gaussian_splatting)",
        }
    }
}
