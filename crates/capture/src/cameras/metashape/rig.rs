//! Rigs: several cameras on one mount, of which only the master has a pose of its own.
//!
//! A slave is a camera with the attribute `master_id` and no transform. Its sensor's rotation (row by row) and location map from its axes
//! to those of the rig, in the unit of the chunk; those of the master's sensor are the identity unless another sensor was made the master
//! afterwards:
//!
//! ```text
//! slave to chunk = (master to chunk) · (master's sensor to rig)⁻¹ · (slave's sensor to rig)
//! ```

use super::elements::{child, values};
use glam::{DMat3, DMat4, DVec3};
use roxmltree::Node;
use std::collections::HashMap;

/// The most cameras from a slave to one that has a transform; more are a circle.
const MAX_MASTERS: usize = 8;

/// The cameras of a chunk, by their id.
pub(super) struct Rigs<'a, 'b> {
    cameras: HashMap<&'a str, Node<'a, 'b>>,
}

impl<'a, 'b> Rigs<'a, 'b> {
    /// The rigs among these cameras, which are found by their ids.
    pub fn new(cameras: impl Iterator<Item = Node<'a, 'b>>) -> Self {
        Self { cameras: cameras.filter_map(|camera| Some((camera.attribute("id")?, camera))).collect() }
    }

    /// Whether the pose of a camera follows from another one's, its master.
    pub fn is_slave(camera: Node<'_, '_>) -> bool {
        let master = camera.attribute("master_id").filter(|master| Some(*master) != camera.attribute("id"));
        child(camera, "transform").is_none() && master.is_some()
    }

    /// The camera whose transform says where this one is: itself, unless it is a slave; `None` if its master has no pose.
    pub fn posed(&self, camera: Node<'a, 'b>) -> Option<Node<'a, 'b>> {
        let mut posed = camera;
        for _ in 0..MAX_MASTERS {
            if child(posed, "transform").is_some() {
                return Some(posed);
            }
            posed = *self.cameras.get(posed.attribute("master_id")?)?;
        }
        None
    }
}

/// From the axes of a sensor to those of its rig; what is absent or empty is the identity.
pub(super) fn sensor_to_rig(sensor: Node<'_, '_>) -> Result<DMat4, &'static str> {
    let stated =
        |name| child(sensor, name).filter(|node| node.text().is_some_and(|text| !text.trim().is_empty()));
    let rotation = match stated("rotation") {
        Some(node) => values(node).ok_or("its rotation is not 9 numbers")?,
        None => DMat3::IDENTITY.to_cols_array(),
    };
    let location: [f64; 3] = match stated("location") {
        Some(node) => values(node).ok_or("its location is not 3 numbers")?,
        None => [0.0; 3],
    };
    let rotation = DMat3::from_cols_array(&rotation).transpose();
    let deviation = rotation * rotation.transpose() - DMat3::IDENTITY;
    let is_rotation =
        rotation.determinant() > 0.0 && deviation.to_cols_array().iter().all(|entry| entry.abs() < 1e-2);
    is_rotation
        .then(|| DMat4::from_mat3_translation(rotation, DVec3::from(location)))
        .ok_or("its rotation does not turn the axes without stretching or mirroring them")
}
