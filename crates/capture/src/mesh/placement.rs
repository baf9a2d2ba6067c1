//! Nerfstudio's own space: its meshes are in one that its data parser turned, moved and scaled.
//!
//! ```text
//! x_mesh = s·(R·x₀ + t)        (R | t) = `transform`, s = `scale` of `dataparser_transforms.json`
//! x_cameras = a·(A·x₀)         A = `applied_transform`, a = `applied_scale` of `transforms.json`
//! ```
//!
//! x₀ is the space of the program that solved the cameras, such as COLMAP's. Versions of nerfstudio differ in whether `transform` starts
//! from x₀ or from the space of `transforms.json`, the cameras may be those of either, and the mesh may be in any of the three: there are
//! several candidates, and the photographs decide.

use crate::CaptureError;
use crate::cameras::nerfstudio;
use crate::files::folder::Folder;
use crate::files::whole_file::whole_file;
use glam::DMat4;
use scene::Scene;
use serde_json::Value;
use std::path::{Path, PathBuf};

const NAME: &str = "dataparser_transforms.json";

/// A motion with a scale that may move a mesh to its cameras.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placement {
    /// The file that states it.
    pub file: PathBuf,
    /// From the mesh's space to that of the cameras.
    pub to_cameras: DMat4,
}

/// The candidates for a mesh of a capture, from the files beside the mesh, then from those in the capture's folder.
///
/// # Errors
/// A file is malformed.
pub(crate) fn find_placements(folder: &Folder, mesh: &Path) -> Result<Vec<Placement>, CaptureError> {
    /// As deep as nerfstudio's outputs are: outputs, capture, method, time.
    const MAX_DEPTH: usize = 4;
    const MAX_FILES: usize = 100_000;
    /// More are trainings of something else.
    const MAX_PARSERS: usize = 4;
    let beside = mesh.with_file_name(NAME);
    let mut parsers = folder.files(&folder.shown, MAX_DEPTH, MAX_FILES);
    parsers.retain(|file| file.file_name().is_some_and(|name| name == NAME) && *file != beside);
    // A mesh that was named explicitly may be outside.
    let is_there = beside.is_file() && (folder.has_file(&beside) || !beside.starts_with(&folder.shown));
    if is_there {
        parsers.insert(0, beside);
    }
    let transforms = folder.shown.join("transforms.json");
    let applied = match folder.has_file(&transforms) {
        true => nerfstudio::applied_transform(&transforms)?,
        false => None,
    };
    let mut placements: Vec<Placement> = Vec::new();
    let mut add = |file: &Path, to_cameras: DMat4| {
        let is_new = placements.iter().all(|other| !other.to_cameras.abs_diff_eq(to_cameras, 1e-9));
        if to_cameras.is_finite() && is_new && !to_cameras.abs_diff_eq(DMat4::IDENTITY, 1e-9) {
            placements.push(Placement { file: file.into(), to_cameras });
        }
    };
    for file in parsers.iter().take(MAX_PARSERS) {
        let to_parsed = parser_transform(file)?.inverse();
        add(file, to_parsed);
        if let Some(applied) = applied {
            add(file, applied * to_parsed);
            add(file, applied.inverse() * to_parsed);
        }
    }
    if let Some(applied) = applied {
        add(&transforms, applied);
        add(&transforms, applied.inverse());
    }
    Ok(placements)
}

/// From the space of the cameras to that of nerfstudio's meshes.
fn parser_transform(file: &Path) -> Result<DMat4, CaptureError> {
    const MAX_BYTES: u64 = 1 << 20;
    let malformed = |place: &str, what: &str| CaptureError::malformed(file, place, what);
    let bytes = whole_file(file, MAX_BYTES)?;
    let root: Value = serde_json::from_slice(&bytes).map_err(|error| {
        CaptureError::malformed(
            file,
            format!("line {}", error.line()),
            format!("its JSON is invalid: {error}"),
        )
    })?;
    let transform = root.get("transform").and_then(nerfstudio::matrix);
    let transform = transform.filter(|matrix| matrix.determinant().abs() > f64::MIN_POSITIVE);
    let transform = transform
        .ok_or_else(|| malformed("/transform", "is not an invertible matrix of 3 rows of 4 numbers"))?;
    let scale =
        root.get("scale").map_or(Some(1.0), Value::as_f64).filter(|scale| *scale > 0.0 && scale.is_finite());
    let scale = scale.ok_or_else(|| malformed("/scale", "is not a number above 0"))?;
    Ok(DMat4::from_scale(glam::DVec3::splat(scale)) * transform)
}

/// Moves a mesh.
pub(crate) fn move_mesh(scene: &mut Scene, motion: DMat4) {
    let turn = glam::Mat3::from_mat4(motion.as_mat4());
    scene.positions.iter_mut().for_each(|position| *position = motion.transform_point3(*position));
    scene.normals.iter_mut().for_each(|normal| *normal = (turn * *normal).normalize_or_zero());
    for tangent in scene.tangents.iter_mut().flatten() {
        *tangent = (turn * tangent.truncate()).normalize_or_zero().extend(tangent.w);
    }
    scene.nodes.iter_mut().for_each(|node| node.world = motion * node.world);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    #[test]
    fn scale_is_applied_last_and_the_candidates_lead_back() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("exports/poisson_mesh.ply");
        let config = folder.path().join("outputs/a/nerfacto/2024");
        std::fs::create_dir_all(&config).unwrap();
        let write = |file: &Path, text: &str| std::fs::write(file, text).unwrap();
        let parser = config.join(NAME);
        write(&parser, "{\"transform\": [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], \"scale\": 0.5}");
        let found = || find_placements(&Folder::open(folder.path()).unwrap(), &mesh);
        let [only] = &found().unwrap()[..] else { panic!() };
        assert_eq!(only.file, parser);
        let original = DVec3::new(4.0, 5.0, 6.0);
        let in_mesh = 0.5 * DVec3::new(-5.0 + 1.0, 4.0 + 2.0, 6.0 + 3.0);
        assert!(only.to_cameras.transform_point3(in_mesh).abs_diff_eq(original, 1e-12));
        // With the cameras of a transforms.json that has a motion of its own.
        write(
            &folder.path().join("transforms.json"),
            "{\"frames\": [], \"applied_transform\": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]], \"applied_scale\": 2}",
        );
        let placements = found().unwrap();
        assert_eq!(placements.len(), 5);
        let expected = 2.0 * DVec3::new(4.0, 6.0, -5.0);
        assert!(placements[1].to_cameras.transform_point3(in_mesh).abs_diff_eq(expected, 1e-12));
        assert!(placements[3].to_cameras.transform_point3(original).abs_diff_eq(expected, 1e-12));
        for (text, what) in [
            ("{\"transform\": 3}", "/transform: is not an invertible matrix"),
            (
                "{\"transform\": [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]}",
                "/transform: is not an invertible matrix",
            ),
            ("{\"transform\": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], \"scale\": 0}", "/scale: is not"),
            ("{", "line 1: its JSON is invalid"),
        ] {
            write(&parser, text);
            let text = found().unwrap_err().to_string();
            assert!(text.contains(what), "{text}");
        }
    }

    #[test]
    fn a_moved_mesh_keeps_unit_normals() {
        let mesh = scene::SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: vec![glam::Vec3::Z; 3],
            triangles: vec![[0, 1, 2]],
            ..scene::SurfaceMesh::default()
        };
        let mut scene = Scene::from_mesh(mesh, &scene::LoadOptions::default()).unwrap();
        let turn = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let motion = DMat4::from_scale_rotation_translation(DVec3::splat(3.0), turn, DVec3::ONE);
        move_mesh(&mut scene, motion);
        assert!(scene.positions[1].abs_diff_eq(DVec3::new(1.0, 1.0, -2.0), 1e-12), "{}", scene.positions[1]);
        assert!(scene.normals[0].abs_diff_eq(glam::Vec3::X, 1e-6), "{}", scene.normals[0]);
    }
}
