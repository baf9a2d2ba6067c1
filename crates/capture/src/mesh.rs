//! The mesh of a capture: finding its file, and reading it.

mod obj;
pub(crate) mod placement;
mod ply;
mod polygon_fan;
mod triangle_strip;

use crate::files::folder::{EntryKind, Folder, extension};
use crate::{CaptureError, Remark};
use progress::Progress;
use scene::{LoadOptions, Scene};
use std::path::{Path, PathBuf};

/// Names of meshes, likelier ones first: ours, COLMAP's, OpenMVS's, Meshroom's, nerfstudio's, others.
const NAMES: [&str; 14] = [
    "mesh.ply",
    "meshed-poisson.ply",
    "meshed-delaunay.ply",
    "scene_dense_mesh_refine.ply",
    "scene_dense_mesh.ply",
    "scene_mesh.ply",
    "poisson_mesh.ply",
    "tsdf_mesh.ply",
    "mesh.obj",
    "texturedmesh.obj",
    "model.obj",
    "mesh.glb",
    "model.glb",
    "scene.glb",
];

/// How deep meshes lie in subfolders, and the most files that are considered.
const MAX_DEPTH: usize = 4;
const MAX_FILES: usize = 100_000;

/// Finds the most likely mesh of a capture; adds a remark if there are others.
pub(crate) fn find_mesh(folder: &Folder, remarks: &mut Vec<Remark>) -> Result<PathBuf, CaptureError> {
    let files = folder.files(&folder.shown, MAX_DEPTH, MAX_FILES);
    let is_mesh = |file: &&PathBuf| matches!(extension(file).as_str(), "ply" | "obj" | "glb" | "gltf");
    let (meshes, points): (Vec<&PathBuf>, Vec<&PathBuf>) =
        files.iter().filter(is_mesh).partition(|file| extension(file) != "ply" || ply::may_have_faces(file));
    let rank = |file: &&&PathBuf| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let size = std::fs::metadata(file).map_or(0, |data| data.len());
        (
            NAMES.iter().position(|candidate| **candidate == name).unwrap_or(NAMES.len()),
            file.iter().count(),
            u64::MAX - size,
        )
    };
    let Some(best) = meshes.iter().min_by_key(rank) else {
        let also = match (points.first(), outside(folder)) {
            (Some(points), _) => format!("; {} has points and no faces", points.display()),
            (None, Some(link)) => format!("; {} leads outside the folder", link.display()),
            (None, None) => String::new(),
        };
        return Err(CaptureError::NoMesh { folder: folder.shown.clone(), also });
    };
    let others: Vec<String> =
        meshes.iter().filter(|file| *file != best).map(|file| file.display().to_string()).collect();
    remarks.extend(Remark::about(others, false, |names| {
        format!(
            "{}: is used as the surface; there are also {names} (name one of those to use it instead)",
            best.display()
        )
    }));
    Ok(best.to_path_buf())
}

/// A mesh that is a link to somewhere else.
fn outside(folder: &Folder) -> Option<PathBuf> {
    let mut entries = folder.entries(&folder.shown).into_iter();
    entries
        .find(|(path, kind)| {
            *kind == EntryKind::Outside && matches!(extension(path).as_str(), "ply" | "obj" | "glb")
        })
        .map(|(path, _)| path)
}

/// Reads a mesh.
pub(crate) fn read_mesh(
    file: &Path,
    options: &LoadOptions,
    progress: &dyn Progress,
    remarks: &mut Vec<Remark>,
) -> Result<Scene, CaptureError> {
    let mesh = match extension(file).as_str() {
        "glb" | "gltf" => return Ok(scene::load(file, options, progress)?),
        "obj" => {
            let (mesh, notes) = obj::read(file, options)?;
            remarks.extend(notes.into_iter().map(|note| Remark::note(format!("{}: {note}", file.display()))));
            mesh
        }
        "ply" => ply::read(file, options)?,
        other => {
            let what = format!("meshes in {other:?} files cannot be read; use PLY, OBJ or glTF");
            return Err(CaptureError::malformed(file, "the name", what));
        }
    };
    progress.check()?;
    Ok(Scene::from_mesh(mesh, options)?)
}
