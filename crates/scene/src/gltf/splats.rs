//! The Gaussian splats of a file: of all its nodes, as one cloud.

use crate::Scene;
use crate::error::Stop;
use crate::gltf::document::{Document, nonempty_name};
use crate::gltf::geometry::hierarchy::Hierarchy;
use crate::gltf::geometry::instancing;
use crate::gltf::geometry::splat_primitive::{is_splats, read_splats};
use gaussians::{GaussianCloud, Placement, SplatFormat, merge_clouds};
use glam::{DMat3, DMat4, DVec3};
use progress::Progress;
use std::path::Path;
use std::sync::Arc;

/// Adds the splats of all nodes that are shown to `scene`, behind its triangles. What stands where no splat can (mirrored, sheared) is left out with a
/// warning.
pub(crate) fn add_splats(
    scene: &mut Scene,
    document: &Document<'_>,
    hierarchy: &Hierarchy,
    progress: &dyn Progress,
) -> Result<(), Stop> {
    let path = scene.path.clone();
    let mut parts: Vec<(String, GaussianCloud, Placement)> = Vec::new();
    for &index in hierarchy.shown.iter().filter(|&&index| !hierarchy.hidden[index]) {
        let Some(node) = document.typed().nodes().nth(index) else { continue };
        let (Some(world), Some(mesh)) = (hierarchy.world[index], node.mesh()) else { continue };
        for primitive in mesh.primitives() {
            let place = format!("/meshes/{}/primitives/{}", mesh.index(), primitive.index());
            if !is_splats(document, &primitive, &place) {
                continue;
            }
            let cloud = read_cloud(document, &path, &place, progress)?;
            for instance in instancing::instance_matrices(document, &node)? {
                let Some(placement) = placement_of(world * instance) else {
                    let why = "its transform is no rotation with positive scales (apply it before exporting)";
                    document.warn(format!("/nodes/{index}: its splats are left out: {why}"));
                    continue;
                };
                document.budget.take_memory(cloud.bytes(), &place)?;
                let name = nonempty_name(node.name()).unwrap_or_else(|| format!("node {index}"));
                parts.push((name, cloud.clone(), placement));
            }
        }
    }
    document.budget.take_triangles(parts.iter().map(|(_, cloud, _)| cloud.len() as u64).sum())?;
    if parts.len() > 1 {
        let first = parts[0].1.traits().color_space;
        parts.retain(|(name, cloud, placement)| {
            let is_fit = cloud.traits().color_space == first && placement.is_similarity();
            if !is_fit {
                let why = "it differs from the others in colour space, or is not scaled alike along its axes";
                document.warn(format!("the splats of {name:?} are left out: {why}"));
            }
            is_fit
        });
    }
    let format = SplatFormat::Gltf.name();
    match parts.len() {
        0 => {}
        1 => {
            if let Some((name, cloud, placement)) = parts.pop() {
                scene.add_splats(name, Arc::new(cloud), placement, format);
            }
        }
        _ => {
            let name = parts[0].0.clone();
            let clouds: Vec<_> = parts.into_iter().map(|(_, cloud, placement)| (cloud, placement)).collect();
            if let Some(cloud) = merge_clouds(&clouds) {
                scene.add_splats(name, Arc::new(cloud), Placement::IDENTITY, format);
            }
        }
    }
    Ok(())
}

fn read_cloud(
    document: &Document<'_>,
    path: &Path,
    place: &str,
    progress: &dyn Progress,
) -> Result<GaussianCloud, Stop> {
    let file = read_splats(document, path, place, progress)?;
    let prefix = format!("{}: ", path.display());
    for warning in &file.warnings {
        document.warn(format!("{place}: {}", warning.strip_prefix(&prefix).unwrap_or(warning)));
    }
    Ok(file.cloud)
}

/// The placement of a node's transform; `None` if it cannot be parted into rotation and positive scales.
fn placement_of(world: DMat4) -> Option<Placement> {
    let linear = DMat3::from_mat4(world);
    let scale = DVec3::new(linear.x_axis.length(), linear.y_axis.length(), linear.z_axis.length());
    let rotation =
        DMat3::from_cols(linear.x_axis / scale.x, linear.y_axis / scale.y, linear.z_axis / scale.z);
    let placement = Placement { rotation, scale, translation: world.w_axis.truncate() };
    (placement.is_valid() && rotation.determinant() > 0.0).then_some(placement)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn transforms_that_are_no_placement_are_refused() {
        let turn = DQuat::from_rotation_x(0.4);
        let placed = DMat4::from_scale_rotation_translation(DVec3::new(1.0, 2.0, 3.0), turn, DVec3::ONE);
        let placement = placement_of(placed).unwrap();
        assert!((placement.scale - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!(placement.point(DVec3::X).distance(placed.transform_point3(DVec3::X)) < 1e-12);
        for scale in [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 1.0), DVec3::splat(f64::NAN)] {
            assert_eq!(placement_of(DMat4::from_scale(scale)), None, "{scale}");
        }
        let sheared = DMat4::from_scale(DVec3::new(1.0, 3.0, 1.0)) * DMat4::from_rotation_z(0.5);
        assert_eq!(placement_of(sheared), None);
    }
}
