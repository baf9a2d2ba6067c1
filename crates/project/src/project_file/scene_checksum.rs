//! Checksums that show whether a scene has changed.

use crate::ProjectError;
use crate::disk::read_bytes;
use crate::project_file::manifest::sha256_hex;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Extensions of the files that define a capture's cameras and surface, and thus what paint lies on; pictures are
/// many, and no paint lies on them.
const CAPTURE_EXTENSIONS: [&str; 12] =
    ["txt", "bin", "json", "xml", "out", "nvm", "ply", "obj", "glb", "pfm", "cfg", "dat"];

/// Maximum depth of such files in a capture's folder.
const MAX_DEPTH: usize = 3;

/// Maximum number of such files.
const MAX_FILES: usize = 1000;

/// Hex SHA-256 of a scene file; for a capture's folder, of its cameras and meshes.
pub(crate) fn scene_checksum(scene: &Path) -> Result<String, ProjectError> {
    if !scene.is_dir() {
        return Ok(sha256_hex(&read_bytes(scene)?));
    }
    let mut files = Vec::new();
    collect_files(scene, MAX_DEPTH, &mut files)?;
    files.sort();
    let mut hash = Sha256::new();
    for file in files {
        let unreadable = |source| ProjectError::Read { file: file.clone(), source };
        let name = file.strip_prefix(scene).unwrap_or(&file).as_os_str().as_encoded_bytes();
        let mut opened = File::open(&file).map_err(unreadable)?;
        let size = opened.metadata().map_err(unreadable)?.len();
        hash.update((name.len() as u64).to_le_bytes());
        hash.update(name);
        hash.update(size.to_le_bytes());
        let mut part = vec![0; 1 << 16];
        loop {
            match opened.read(&mut part).map_err(unreadable)? {
                0 => break,
                read => hash.update(&part[..read]),
            }
        }
    }
    Ok(hex::encode(hash.finalize()))
}

fn collect_files(
    folder: &Path,
    depth_left: usize,
    files: &mut Vec<std::path::PathBuf>,
) -> Result<(), ProjectError> {
    let unreadable = |source| ProjectError::Read { file: folder.to_owned(), source };
    for entry in std::fs::read_dir(folder).map_err(unreadable)?.flatten() {
        let path = entry.path();
        // Links are not followed: they may lead anywhere, and in circles.
        let Ok(kind) = entry.file_type() else { continue };
        if kind.is_dir() && depth_left > 0 {
            collect_files(&path, depth_left - 1, files)?;
        }
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let counts = extension.is_some_and(|extension| CAPTURE_EXTENSIONS.contains(&extension.as_str()));
        if kind.is_file() && counts && files.len() < MAX_FILES {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_capture_cameras_and_mesh_count() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let sum = || scene_checksum(folder.path()).unwrap();
        write("sparse/0/cameras.txt", "1");
        write("mesh.ply", "ply");
        let before = sum();
        write("images/a.jpg", "jpg");
        write("painted.fbrush", "project");
        assert_eq!(sum(), before);
        write("mesh.ply", "plY");
        let other_mesh = sum();
        assert_ne!(other_mesh, before);
        write("sparse/0/images.txt", "1");
        assert_ne!(sum(), other_mesh);
        assert!(scene_checksum(&folder.path().join("none")).is_err());
    }
}
