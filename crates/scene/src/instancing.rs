//! EXT_mesh_gpu_instancing: the same mesh many times under one node.

use crate::accessor::Accessor;
use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;
use glam::{DMat4, DQuat, DVec3};

/// Node-from-instance matrices; one identity for a node that is not instanced.
pub(crate) fn instances(document: &Document<'_>, node: &Object<'_>) -> Result<Vec<DMat4>, Fault> {
    let Some(extension) = node.extension("EXT_mesh_gpu_instancing")? else {
        return Ok(vec![DMat4::IDENTITY]);
    };
    let attributes = extension.required("attributes", extension.object("attributes")?)?;
    let open = |name: &str, components: usize| -> Result<Option<Accessor<'_>>, Fault> {
        let Some(index) = attributes.index(name)? else { return Ok(None) };
        let place = format!("{}/{name}", attributes.place);
        Ok(Some(Accessor::open(document, index, &place)?.expect_components(&[components], name)?))
    };
    let (translation, rotation, scale) = (open("TRANSLATION", 3)?, open("ROTATION", 4)?, open("SCALE", 3)?);
    let counts = [&translation, &rotation, &scale].into_iter().flatten().map(|accessor| accessor.count);
    let Some(count) = counts.clone().min() else { return Ok(vec![DMat4::IDENTITY]) };
    if counts.clone().max() != Some(count) {
        document.warn(format!(
            "{}: its attributes differ in length; {count} instances are shown",
            attributes.place
        ));
    }
    document.budget.work(10 * count as u64, &attributes.place)?;
    document.budget.memory(128 * count as u64, &attributes.place)?;
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
