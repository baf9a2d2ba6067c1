//! Which format a file has.

use super::{ksplat, raw_splat};
use std::path::Path;

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
    /// The format of a file's bytes, but for [`Self::Ply`] and [`Self::CompressedPly`], which their header tells apart. `.splat` has no
    /// signature and `.ksplat` a weak one: their numbers must be plausible, unless the name says it.
    pub(super) fn detect(bytes: &[u8], file: &Path) -> Option<Self> {
        let extension = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match bytes {
            [b'p', b'l', b'y', b'\n' | b'\r', ..] => Some(Self::Ply),
            [0x1f, 0x8b, ..] | [b'N', b'G', b'S', b'P', ..] => Some(Self::Spz),
            [b'P', b'K', 3, 4, ..] => Some(Self::Sog),
            [b'g', b'l', b'T', b'F', ..] => Some(Self::Gltf),
            _ if extension == "ksplat" || ksplat::is_plausible(bytes) => Some(Self::Ksplat),
            _ if extension == "splat" || raw_splat::is_plausible(bytes) => Some(Self::Splat),
            _ if bytes.trim_ascii_start().first() == Some(&b'{') => Some(Self::SogFolder),
            _ => None,
        }
    }

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
