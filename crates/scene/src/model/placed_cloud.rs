//! Gaussian splats as a part of a scene: the cloud, where it stands, and which triangles stand for its splats.

use super::splat_edit::SplatEdit;
use gaussians::{GaussianCloud, Placement};
use glam::DVec3;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// A cloud of splats, and where it stands.
#[derive(Clone, Debug)]
pub struct PlacedCloud {
    /// The splats.
    pub cloud: Arc<GaussianCloud>,
    /// From the axes of their file to the world.
    pub placement: Placement,
    /// The same when their file was opened: what an edit moves.
    pub original_placement: Placement,
    /// How they were moved, and which of them are hidden.
    pub edit: SplatEdit,
    /// The file that was added to the scene; `None`: they are in the scene's own file.
    pub file: Option<PathBuf>,
    /// The format of their file, for messages.
    pub format: &'static str,
    pub(crate) first_triangle: u32,
    pub(crate) bounds: (DVec3, DVec3),
}

impl PlacedCloud {
    /// Its triangles, one a splat, in the order of the cloud.
    pub fn triangles(&self) -> Range<u32> {
        self.first_triangle..self.first_triangle + self.cloud.len() as u32
    }

    /// The splat whose triangle has this index; `None` if that is of something else.
    pub fn splat_of(&self, triangle: u32) -> Option<u32> {
        self.triangles().contains(&triangle).then(|| triangle - self.first_triangle)
    }

    /// The lower and upper corner of the box in which most means lie (world): a few lie far away in most clouds.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }
}
