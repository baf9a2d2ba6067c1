//! The user's choices for a capture: its kind, its mesh or depth, and which photographs are excluded.

use crate::scene_path::ScenePath;
use relief::DepthStroke;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The user's choices for a capture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureChoices {
    /// The mesh; `None`: the one found in the capture's folder.
    pub mesh: Option<PathBuf>,
    /// Names of the photographs that are excluded from lighting and only compared with.
    pub leave_out: Vec<String>,
    /// Its kind, `photographs`, `lightfield` or `depth`; `None`: detected.
    pub kind: Option<String>,
    /// The disparity map of a light field's middle view, or of a picture; `None`: the one found beside it.
    pub disparity: Option<PathBuf>,
    /// The depth map of a picture; `None`: the one found beside it.
    pub depth: Option<PathBuf>,
    /// The layer of an EXR with several pictures, by name; `None`: the first one with depth.
    pub layer: Option<String>,
    /// Which end of a relative depth map is near: `white`, `black`, or the distances of both ends.
    pub near: Option<String>,
    /// Strokes that repair the depth of a light field or picture, in order.
    pub depth_strokes: Vec<DepthStroke>,
}

/// The same as stored in a manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CaptureEntry {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mesh: Option<ScenePath>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    leave_out: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    disparity: Option<ScenePath>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth: Option<ScenePath>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layer: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    near: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    depth_strokes: Vec<DepthStroke>,
}

impl CaptureEntry {
    /// The entry of these choices in a project file at `project`: its paths become relative.
    pub fn new(choices: &CaptureChoices, project: &Path) -> Self {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| ScenePath::new(path, project));
        Self {
            mesh: path(&choices.mesh),
            leave_out: choices.leave_out.clone(),
            kind: choices.kind.clone(),
            disparity: path(&choices.disparity),
            depth: path(&choices.depth),
            layer: choices.layer.clone(),
            near: choices.near.clone(),
            depth_strokes: choices.depth_strokes.clone(),
        }
    }

    /// Whether a layer of the picture's file was chosen.
    pub fn has_layer(&self) -> bool {
        self.layer.is_some()
    }

    /// Whether depth was repaired by hand.
    pub fn has_depth_strokes(&self) -> bool {
        !self.depth_strokes.is_empty()
    }

    /// The choices, with paths resolved from the project's location.
    ///
    /// # Errors
    /// What is wrong with them, as text.
    pub fn to_choices(&self, project: &Path) -> Result<CaptureChoices, &'static str> {
        if !self.depth_strokes.iter().all(DepthStroke::is_valid) {
            return Err("capture.depth_strokes has a stroke beyond all pictures");
        }
        self.with_absolute_paths(project).ok_or("capture.mesh.path_bytes is not in hex")
    }

    /// Resolves the paths; `None` if one is malformed.
    fn with_absolute_paths(&self, project: &Path) -> Option<CaptureChoices> {
        let path = |path: &Option<ScenePath>| match path {
            Some(path) => path.resolve(project).map(Some),
            None => Some(None),
        };
        Some(CaptureChoices {
            mesh: path(&self.mesh)?,
            leave_out: self.leave_out.clone(),
            kind: self.kind.clone(),
            disparity: path(&self.disparity)?,
            depth: path(&self.depth)?,
            layer: self.layer.clone(),
            near: self.near.clone(),
            depth_strokes: self.depth_strokes.clone(),
        })
    }
}
