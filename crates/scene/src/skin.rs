//! Skins in their default pose: a vertex stands where its joints carry it.
//!
//! ```text
//! world from mesh = Σ weight · (world from joint) · (inverse bind matrix)
//! ```
//!
//! The transform of the skinned node itself does not count (glTF 2.0 §3.7.3.3).

use crate::accessor::{Accessor, Component};
use crate::document::Document;
use crate::error::Fault;
use crate::hierarchy::Hierarchy;
use glam::DMat4;

/// World-from-mesh matrix of every joint of skin `index`, which `place` refers to.
pub(crate) fn joint_matrices(
    document: &Document<'_>,
    hierarchy: &Hierarchy,
    index: usize,
    place: &str,
) -> Result<Vec<DMat4>, Fault> {
    let skin = document.item("skins", index, place)?;
    let joints = skin.indices("joints")?;
    document.budget.work(64 * joints.len() as u64, &skin.place)?;
    if joints.is_empty() {
        return Err(skin.malformed("joints", "is empty"));
    }
    let bind = match skin.index("inverseBindMatrices")? {
        Some(accessor) => {
            let place = format!("{}/inverseBindMatrices", skin.place);
            let bind = Accessor::open(document, accessor, &place)?;
            if bind.shape.components() != 16 || bind.component != Component::F32 {
                return Err(bind.malformed("inverse bind matrices must be MAT4 of floats"));
            }
            if bind.count < joints.len() {
                return Err(bind.malformed(format!(
                    "has {} matrices for {} joints",
                    bind.count,
                    joints.len()
                )));
            }
            Some(bind)
        }
        None => None,
    };
    let matrix = |(i, &joint): (usize, &usize)| {
        let world = hierarchy.world.get(joint).copied().flatten();
        let world = world.ok_or_else(|| skin.malformed("joints", format!("nodes[{joint}] is not there")))?;
        let inverse_bind =
            bind.as_ref().map_or(DMat4::IDENTITY, |bind| DMat4::from_cols_array(&bind.doubles(i)));
        Ok(world * inverse_bind)
    };
    joints.iter().enumerate().map(matrix).collect()
}

/// The matrix of a vertex: the weighted sum over its joints. A joint that does not exist is left out.
pub(crate) fn blended(joints: &[DMat4], influences: &[(u32, f64)]) -> DMat4 {
    let sum = influences
        .iter()
        .filter(|&&(_, weight)| weight > 0.0)
        .filter_map(|&(joint, weight)| joints.get(joint as usize).map(|&matrix| matrix * weight));
    sum.fold(DMat4::ZERO, |sum, matrix| sum + matrix)
}
