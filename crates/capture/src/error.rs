//! What can be wrong with a capture.

use progress::Cancelled;
use scene::SceneError;
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
    /// There are no cameras of any kind that is known.
    #[error(
        "{}: no cameras of photographs (give the folder that holds COLMAP's cameras and images, transforms.json, bundle.out, an .nvm \
         or Metashape's cameras as .xml)",
        folder.display()
    )]
    NoCameras {
        /// The folder.
        folder: PathBuf,
    },
    /// A file does not say what its kind has to.
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
    /// Of all the pictures that have cameras none can be used.
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
        /// What there is instead, as a continuation of the sentence.
        also: String,
    },
    /// A file is beyond the limits.
    #[error("{}: {what} (make it smaller, or raise the limit)", file.display())]
    TooBig {
        /// The file.
        file: PathBuf,
        /// What is too big, and the limit.
        what: String,
    },
    /// Something is wrong with the mesh as a scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Opening was called off.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CaptureError {
    pub(crate) fn unreadable(file: &Path, source: std::io::Error) -> Self {
        Self::Unreadable { file: file.into(), source }
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
