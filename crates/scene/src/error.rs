//! Errors of reading a scene file.

use gaussians::GaussianError;
use progress::Cancelled;
use std::path::PathBuf;

/// Why a scene did not open. Displays as `FILE: what is wrong (what to do)`.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file was read, but has no triangle, so there is nothing to render. [`crate::inspect`] still opens it.
    #[error("{}: no triangle: {why} (export at least one visible mesh made of triangles)", file.display())]
    NoTriangles {
        /// The scene file.
        file: PathBuf,
        /// What it contains instead.
        why: String,
    },
    /// The file cannot be read as a scene.
    #[error("{}: {}", file.display(), on_one_line(&fault.to_string()))]
    Bad {
        /// The scene file.
        file: PathBuf,
        /// What is wrong with it, where, and what to do.
        fault: Fault,
    },
    /// A file of Gaussian splats did not open.
    #[error(transparent)]
    Splats(GaussianError),
    /// Loading was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<GaussianError> for SceneError {
    fn from(error: GaussianError) -> Self {
        match error {
            GaussianError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Splats(other),
        }
    }
}

/// A fault inside a scene file.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The file itself cannot be read.
    #[error("cannot be read: {0} (check the path and its permissions)")]
    Unreadable(std::io::Error),
    /// The file is not glTF.
    #[error("not a glTF 2.0 file: {0} (export it again as .glb or .gltf)")]
    NotGltf(String),
    /// A part of the document that the picture needs is missing or malformed.
    #[error("{place}: {what} (correct the file or export it again)")]
    Malformed {
        /// JSON pointer to the place.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// A file that the scene refers to cannot be read.
    #[error("{place}: {uri}: {what}")]
    Resource {
        /// JSON pointer to what refers to it.
        place: String,
        /// The reference, shortened.
        uri: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// A buffer has neither a URI nor a binary chunk: its data comes from elsewhere, as glTF allows.
    #[error("{place}: the file does not contain its data (export the scene with its buffers)")]
    NoData {
        /// JSON pointer to the buffer.
        place: String,
    },
    /// The file requires an unsupported extension.
    #[error("it requires the extension {extension}, which is not supported ({cure})")]
    Extension {
        /// The extension's name.
        extension: String,
        /// What to do.
        cure: String,
    },
    /// Splats were to be added to a scene that has some.
    #[error("has Gaussian splats already, so that those of {} cannot be added (use a scene of meshes alone)", added.display())]
    SplatsTwice {
        /// The file that was to be added.
        added: PathBuf,
    },
    /// The requested variant does not exist.
    #[error("no variant is called {name:?} ({available})")]
    NoVariant {
        /// The requested name.
        name: String,
        /// The existing names, as a phrase.
        available: String,
    },
    /// The requested animation does not exist.
    #[error("no animation is called {name:?} ({available})")]
    NoAnimation {
        /// The requested name.
        name: String,
        /// The existing names, as a phrase.
        available: String,
    },
    /// A limit of [`crate::LoadOptions`] was exceeded.
    #[error("{what} (simplify the scene or raise the limit)")]
    TooBig {
        /// What is too big, and the limit.
        what: String,
    },
    /// A decoder panicked.
    #[error("the decoder failed: {0} (export the file again; this is a bug in the importer)")]
    Panicked(String),
}

/// Why loading stops, at levels that do not have the file's name.
#[derive(Debug)]
pub(crate) enum Stop {
    /// A fault of the file.
    Fault(Fault),
    /// Loading was cancelled.
    Cancelled,
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl From<Cancelled> for Stop {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// A text that may be a library's, with a space in the place of line breaks and what stands around them.
fn on_one_line(text: &str) -> String {
    let parts = text.split(char::is_control).map(str::trim).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_whatever_a_library_says() {
        let what =
            "cannot be decoded: 7 corrections, more than the \n                 1628 bytes left".into();
        let fault = Fault::Malformed { place: "/meshes/0".into(), what };
        let text = SceneError::Bad { file: "scene.glb".into(), fault }.to_string();
        assert!(
            text.starts_with(
                "scene.glb: /meshes/0: cannot be decoded: 7 corrections, more than the 1628 bytes left"
            ),
            "{text}"
        );
    }
}
