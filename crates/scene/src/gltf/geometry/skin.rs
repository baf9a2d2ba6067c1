//! Skins in their default pose: a vertex follows its joints.
//!
//! ```text
//! world from mesh = Σ weight · (world from joint) · (inverse bind matrix)
//! ```
//!
//! The transform of the skinned node itself is ignored (glTF 2.0 §3.7.3.3).

use crate::error::Fault;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};
use crate::gltf::geometry::hierarchy::Hierarchy;
use glam::DMat4;

/// World-from-mesh matrix of every joint of a skin.
pub(crate) fn joint_matrices(
    document: &Document<'_>,
    hierarchy: &Hierarchy,
    skin: &gltf::Skin<'_>,
) -> Result<Vec<DMat4>, Fault> {
    let place = format!("/skins/{}", skin.index());
    document.check_below(&place)?;
    let joints: Vec<usize> = skin.joints().map(|joint| joint.index()).collect();
    document.budget.take_work(64 * joints.len() as u64, &place)?;
    let malformed = |what: String| Fault::Malformed { place: format!("{place}/joints"), what };
    if joints.is_empty() {
        return Err(malformed("is empty".into()));
    }
    let bind = match skin.inverse_bind_matrices() {
        Some(accessor) => {
            let place = format!("{place}/inverseBindMatrices");
            let bind = Accessor::open(document, accessor.index(), &place)?;
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
        let world = world.ok_or_else(|| malformed(format!("nodes[{joint}] does not exist")))?;
        let inverse_bind =
            bind.as_ref().map_or(DMat4::IDENTITY, |bind| DMat4::from_cols_array(&bind.doubles(i)));
        Ok(world * inverse_bind)
    };
    joints.iter().enumerate().map(matrix).collect()
}

/// The matrix of a vertex: the weighted sum over its joints. A joint that does not exist is left out.
pub(crate) fn blend_joints(joints: &[DMat4], influences: &[(u32, f64)]) -> DMat4 {
    let sum = influences
        .iter()
        .filter(|&&(_, weight)| weight > 0.0)
        .filter_map(|&(joint, weight)| joints.get(joint as usize).map(|&matrix| matrix * weight));
    sum.fold(DMat4::ZERO, |sum, matrix| sum + matrix)
}
