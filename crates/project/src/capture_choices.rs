//! What was chosen of a capture: which mesh, and which photographs no light is made of.

use crate::scene_path::ScenePath;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What was chosen of a capture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CaptureChoices {
    /// The mesh; none: the one that is found in the capture's folder.
    pub mesh: Option<PathBuf>,
    /// Photographs that are only compared with, by name.
    pub leave_out: Vec<String>,
}

/// The same in a manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CaptureRow {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mesh: Option<ScenePath>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leave_out: Vec<String>,
}

impl CaptureRow {
    /// Of a project that lies in `project`.
    pub fn new(choices: &CaptureChoices, project: &Path) -> Self {
        let mesh = choices.mesh.as_ref().map(|mesh| ScenePath::new(mesh, project));
        Self { mesh, leave_out: choices.leave_out.clone() }
    }

    /// What is meant, from where the project lies; `None` if what stands there is no path.
    pub fn choices(&self, project: &Path) -> Option<CaptureChoices> {
        let mesh = match &self.mesh {
            Some(mesh) => Some(mesh.from(project)?),
            None => None,
        };
        Some(CaptureChoices { mesh, leave_out: self.leave_out.clone() })
    }
}
