//! Writing light fields to files, atomically.

use crate::error::RenderError;
use atomic_file::AtomicFile;
use salf::{Salf, SalfFile};
use std::io::BufWriter;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Writes a light field that was baked from `source`, a scene or project. An existing file is replaced only once the new one is
/// complete. Returns the number of bytes written.
///
/// # Errors
/// The file cannot be written.
pub fn write_salf(
    path: &Path,
    source: &Path,
    scene: &scene::Scene,
    salf: &Arc<Salf>,
) -> Result<u64, RenderError> {
    let failed = |error: std::io::Error| RenderError::io(path, &error);
    let file = SalfFile {
        source: relative_to(source, path),
        triangles: scene.triangles.len() as u32,
        salf: salf.clone(),
    };
    let mut new = AtomicFile::create(path).map_err(failed)?;
    file.write(BufWriter::with_capacity(1 << 20, &mut new)).map_err(failed)?;
    let bytes = new.byte_len().map_err(failed)?;
    new.commit().map_err(failed)?;
    Ok(bytes)
}

/// The path of `file` relative to the folder of `from`; absolute if the two have no common ancestor.
fn relative_to(file: &Path, from: &Path) -> PathBuf {
    let absolute = |path: &Path| {
        let path = dunce::canonicalize(path).or_else(|_| std::path::absolute(path));
        path.unwrap_or_else(|_| file.to_owned())
    };
    let file = absolute(file);
    let folder = from.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = absolute(folder);
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 || file.components().nth(1).is_none() {
        return file;
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_file_to_its_scene() {
        let lead = |file: &str, from: &str| relative_to(Path::new(file), Path::new(from));
        assert_eq!(lead("/none/a/scene.glb", "/none/a/x.salf"), Path::new("scene.glb"));
        assert_eq!(lead("/none/a/scene.glb", "/none/b/c/x.salf"), Path::new("../../a/scene.glb"));
    }
}
