//! What was chosen of a capture: what it is, which mesh or depth, and which photographs no light is made of.

use crate::scene_path::ScenePath;
use relief::DepthStroke;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What was chosen of a capture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaptureChoices {
    /// The mesh; none: the one that is found in the capture's folder.
    pub mesh: Option<PathBuf>,
    /// Photographs that are only compared with, by name.
    pub leave_out: Vec<String>,
    /// What it is taken for, `photographs`, `lightfield` or `depth`; none: what it is found to be.
    pub kind: Option<String>,
    /// The disparity map of a light field's middle view, or of a picture; none: the one that is found.
    pub disparity: Option<PathBuf>,
    /// The depth map of a picture; none: the one that is found.
    pub depth: Option<PathBuf>,
    /// Which end of a relative depth map is near: `white`, `black`, or the distances of both.
    pub near: Option<String>,
    /// Strokes that repair the depth of a light field or picture, in their order.
    pub depth_strokes: Vec<DepthStroke>,
}

/// The same in a manifest.
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
    near: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    depth_strokes: Vec<DepthStroke>,
}

impl CaptureEntry {
    /// Of a project that lies in `project`.
    pub fn new(choices: &CaptureChoices, project: &Path) -> Self {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| ScenePath::new(path, project));
        Self {
            mesh: path(&choices.mesh),
            leave_out: choices.leave_out.clone(),
            kind: choices.kind.clone(),
            disparity: path(&choices.disparity),
            depth: path(&choices.depth),
            near: choices.near.clone(),
            depth_strokes: choices.depth_strokes.clone(),
        }
    }

    /// Whether depth was repaired.
    pub fn has_depth_strokes(&self) -> bool {
        !self.depth_strokes.is_empty()
    }

    /// What is meant, from where the project lies; else what is wrong.
    pub fn to_choices(&self, project: &Path) -> Result<CaptureChoices, &'static str> {
        if !self.depth_strokes.iter().all(DepthStroke::is_valid) {
            return Err("capture.depth_strokes has a stroke beyond all pictures");
        }
        self.with_absolute_paths(project).ok_or("capture.mesh.path_bytes is not in hex")
    }

    /// The same, `None` if what stands there is no path.
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
            near: self.near.clone(),
            depth_strokes: self.depth_strokes.clone(),
        })
    }
}
