//! Errors of opening a capture.

use progress::Cancelled;
use scene::{PictureError, SceneError};
use std::path::{Path, PathBuf};

/// Why a capture did not open. Displays as `FILE: what is wrong (what to do)`.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// A file or folder cannot be read.
    #[error("{}: cannot be read: {source} (check the path and its permissions)", file.display())]
    Unreadable {
        /// The file or folder.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No cameras of a supported format.
    #[error(
        "{}: no cameras of photographs (give the folder that holds COLMAP's cameras and images, transforms.json, bundle.out, an .nvm \
         or Metashape's cameras as .xml)",
        folder.display()
    )]
    NoCameras {
        /// The folder.
        folder: PathBuf,
    },
    /// A picture has no such layer.
    #[error("{}: has no layer {layer} with a picture and its depth (choose among {layers})", file.display())]
    NoLayer {
        /// The picture.
        file: PathBuf,
        /// The requested layer, in quotes.
        layer: String,
        /// Those that it has, in quotes.
        layers: String,
    },
    /// A picture cannot have layers.
    #[error("{}: is no EXR with several layers (leave out --layer)", file.display())]
    Unlayered {
        /// The picture.
        file: PathBuf,
    },
    /// The content of a file is invalid.
    #[error("{}: {place}: {what} (correct the file or export it again)", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// Line, byte or picture.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// A folder or file of the capture is a link to somewhere else.
    #[error("{}: is a link that leads outside the capture's folder ({cure})", file.display())]
    Outside {
        /// The link.
        file: PathBuf,
        /// What to do.
        cure: &'static str,
    },
    /// None of the pictures that have cameras can be used.
    #[error("{}: none of the pictures of its {cameras} cameras can be used: {why} (put them into the folder images, or name their folder)", file.display())]
    NoPictures {
        /// The file with the cameras.
        file: PathBuf,
        /// How many cameras there are.
        cameras: usize,
        /// What is wrong with the first.
        why: String,
    },
    /// There is no mesh.
    #[error(
        "{}: no mesh (make mesh.ply there, with COLMAP by `colmap delaunay_mesher --input_type sparse --input_path SPARSE --output_path \
         mesh.ply`, which needs no CUDA, or, after its dense steps, by `colmap poisson_mesher --input_path fused.ply --output_path \
         mesh.ply`; with OpenMVS, without CUDA too, by `InterfaceCOLMAP`, `DensifyPointCloud` and `ReconstructMesh`{also})",
        folder.display()
    )]
    NoMesh {
        /// The capture's folder.
        folder: PathBuf,
        /// What exists instead, as a continuation of the sentence.
        also: String,
    },
    /// A file exceeds the limits.
    #[error("{}: {what} (make it smaller, or raise the limit)", file.display())]
    TooBig {
        /// The file.
        file: PathBuf,
        /// What is too big, and the limit.
        what: String,
    },
    /// The path is no capture of any kind.
    #[error(
        "{}: contains neither photographs with cameras nor a light field nor a picture with depth{detail} (open a folder of COLMAP, nerfstudio, \
         Bundler, VisualSFM or Metashape; a folder of views named by row and column; a mosaic of micro-images; or a picture with its \
         depth inside or next to it, as NAME_depth.png)",
        path.display()
    )]
    NoCapture {
        /// The folder or file.
        path: PathBuf,
        /// What exists instead, as a continuation of the sentence.
        detail: String,
    },
    /// There are no views of a light field.
    #[error("{}: no views of a light field{detail} (name them by row and column, as 03_04.png, or list them in views.json)", path.display())]
    NoViews {
        /// The folder or picture.
        path: PathBuf,
        /// What is wrong, as a continuation of the sentence.
        detail: String,
    },
    /// Nothing says how many columns and rows a light field has.
    #[error(
        "{}: {what} (put a parameters.cfg beside them with the lines num_cams_x = COLUMNS and num_cams_y = ROWS, or list them in views.json)",
        folder.display()
    )]
    GridUnknown {
        /// The folder of the views.
        folder: PathBuf,
        /// What is known.
        what: String,
    },
    /// There is no depth of a picture.
    #[error(
        "{}: no depth{detail} (put it next to the picture as NAME_depth.png, .pfm or .exr, or name its file)",
        path.display()
    )]
    NoDepth {
        /// The picture.
        path: PathBuf,
        /// What is wrong, as a continuation of the sentence.
        detail: String,
    },
    /// Several files match.
    #[error("{}: has {what}: {names} (give one of them)", path.display())]
    Ambiguous {
        /// The folder.
        path: PathBuf,
        /// What there are several of.
        what: &'static str,
        /// Their names.
        names: String,
    },
    /// A depth map is relative, and its near end is unknown.
    #[error(
        "{}: does not specify which end is near (pass --near white, --near black, or the distances of black and white in metres, such as --near 0.5,20)",
        file.display()
    )]
    NearUnknown {
        /// The depth map.
        file: PathBuf,
    },
    /// Another program has to export the file first.
    #[error("{}: is {what} ({cure})", file.display())]
    UnsupportedFormat {
        /// The file.
        file: PathBuf,
        /// What it is.
        what: String,
        /// The program to use, and how.
        cure: &'static str,
    },
    /// Something is wrong with a picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Something is wrong with the mesh as a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// `progress` cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CaptureError {
    pub(crate) fn unreadable(file: &Path, source: std::io::Error) -> Self {
        Self::Unreadable { file: file.into(), source }
    }

    /// A limit in bytes is exceeded.
    pub(crate) fn too_big(file: &Path, what: impl std::fmt::Display, bytes: u64, limit: u64) -> Self {
        let what = format!("{what} {} MiB, the limit is {} MiB", bytes >> 20, limit >> 20);
        Self::TooBig { file: file.into(), what }
    }

    pub(crate) fn malformed(file: &Path, place: impl ToString, what: impl ToString) -> Self {
        let one_line = |text: String| text.replace(|c: char| c.is_control(), " ");
        Self::Malformed {
            file: file.into(),
            place: one_line(place.to_string()),
            what: one_line(what.to_string()),
        }
    }
}
