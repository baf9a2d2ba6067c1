//! EXT_mesh_gpu_instancing: the same mesh many times under one node.

use crate::error::Fault;
use crate::gltf::container::json_object::as_whole_number;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::Accessor;
use glam::{DMat4, DQuat, DVec3};

/// The extension's name.
pub(crate) const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// Node-from-instance matrices; a single identity for a node that is not instanced.
pub(crate) fn instance_matrices(document: &Document<'_>, node: &gltf::Node<'_>) -> Result<Vec<DMat4>, Fault> {
    let place = format!("/nodes/{}/extensions", node.index());
    document.check_at(&place)?;
    let place = format!("{place}/{EXTENSION}");
    document.check_at(&place)?;
    let Some(extension) = node.extension_value(EXTENSION) else {
        return Ok(vec![DMat4::IDENTITY]);
    };
    let place = format!("{place}/attributes");
    document.check_at(&place)?;
    let open_attribute = |name: &str, components: usize| -> Result<Option<Accessor<'_>>, Fault> {
        let place = format!("{place}/{name}");
        document.check_at(&place)?;
        let index = extension.get("attributes").and_then(|attributes| as_whole_number(attributes.get(name)?));
        let Some(index) = index else { return Ok(None) };
        Ok(Some(Accessor::open(document, index as usize, &place)?.expect_components(&[components], name)?))
    };
    let (translation, rotation, scale) =
        (open_attribute("TRANSLATION", 3)?, open_attribute("ROTATION", 4)?, open_attribute("SCALE", 3)?);
    let counts = [&translation, &rotation, &scale].into_iter().flatten().map(|accessor| accessor.count);
    let Some(count) = counts.clone().min() else { return Ok(vec![DMat4::IDENTITY]) };
    if counts.clone().max() != Some(count) {
        document.warn(format!("{place}: its attributes differ in length; {count} instances are shown"));
    }
    document.budget.take_work(10 * count as u64, &place)?;
    document.budget.take_memory(128 * count as u64, &place)?;
    let matrix = |i: usize| {
        let vector = |accessor: &Option<Accessor<'_>>, default| {
            accessor.as_ref().map_or(default, |accessor| DVec3::from_array(accessor.doubles(i)))
        };
        let rotation =
            rotation.as_ref().map_or(DQuat::IDENTITY, |accessor| DQuat::from_array(accessor.doubles(i)));
        let rotation = match rotation.length() {
            length if length > 0.0 && length.is_finite() => rotation / length,
            _ => DQuat::IDENTITY,
        };
        DMat4::from_scale_rotation_translation(
            vector(&scale, DVec3::ONE),
            rotation,
            vector(&translation, DVec3::ZERO),
        )
    };
    Ok((0..count).map(matrix).collect())
}
