//! The path of a project's scene, relative to the project's folder, so that both may be moved together.
//!
//! JSON is UTF-8 and a path need not be: one that is not is stored twice, as readable text (with U+FFFD in place of
//! what is not text) and exactly, in hex.

use serde::{Deserialize, Serialize};
use std::path::{Component, Path, PathBuf};

/// A path in a manifest.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ScenePath {
    /// With forward slashes; absolute if the scene and the project share no folder.
    pub path: String,
    /// The bytes of a path that is not UTF-8, in hex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path_bytes: Option<String>,
}

impl ScenePath {
    /// The path of `scene` relative to the folder of `project`; absolute if they share no folder.
    pub fn new(scene: &Path, project: &Path) -> Self {
        let path = relative_path(scene, project);
        let text = path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/");
        let path_bytes = path.to_str().is_none().then(|| hex::encode(path.as_os_str().as_encoded_bytes()));
        Self { path: text, path_bytes }
    }

    /// The absolute path, from the project's location; `None` if malformed.
    pub fn resolve(&self, project: &Path) -> Option<PathBuf> {
        let path = match &self.path_bytes {
            Some(digits) => {
                path_from_bytes(hex::decode(digits).ok()?).unwrap_or_else(|| PathBuf::from(&self.path))
            }
            None => PathBuf::from(&self.path),
        };
        Some(absolute_path(&path, project))
    }
}

/// The path from the project's folder to the scene; absolute if they share no folder.
fn relative_path(scene: &Path, project: &Path) -> PathBuf {
    let scene = std::path::absolute(scene).unwrap_or_else(|_| scene.to_owned());
    let project = std::path::absolute(project).unwrap_or_else(|_| project.to_owned());
    let folder = project.parent().unwrap_or(Path::new(""));
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), scene.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // If only the root is common (or not even a drive), the two will hardly be moved together.
    let is_near = to[..shared].iter().any(|component| matches!(component, Component::Normal(_)));
    if !is_near {
        return scene;
    }
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - shared);
    up.chain(to[shared..].iter().copied()).collect()
}

/// The absolute path of one that is relative to the project's folder.
fn absolute_path(scene: &Path, project: &Path) -> PathBuf {
    let project = std::path::absolute(project).unwrap_or_else(|_| project.to_owned());
    let joined = project.parent().unwrap_or(Path::new("")).join(scene);
    // `..` is resolved by name, so that the path reads well, unless that is another file (through a link).
    let mut plain = PathBuf::new();
    for component in joined.components() {
        match component {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    if plain.exists() || !joined.exists() { plain } else { joined }
}

/// The path of these bytes, on systems where paths are bytes.
#[cfg(unix)]
fn path_from_bytes(bytes: Vec<u8>) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    Some(std::ffi::OsString::from_vec(bytes).into())
}

/// On other systems the text is used instead.
#[cfg(not(unix))]
fn path_from_bytes(_: Vec<u8>) -> Option<PathBuf> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_leads_from_the_project_to_the_scene_and_back() {
        let path = ScenePath::new("/a/geo/sc ene.glb".as_ref(), "/a/b/p.fbrush".as_ref());
        assert_eq!(path, ScenePath { path: "../geo/sc ene.glb".into(), path_bytes: None });
        assert_eq!(
            path.resolve("/else/where/b/p.fbrush".as_ref()),
            Some("/else/where/geo/sc ene.glb".into())
        );
        let far = ScenePath::new("/x/s.glb".as_ref(), "/a/p.fbrush".as_ref());
        assert_eq!(far.resolve("/else/p.fbrush".as_ref()), Some("/x/s.glb".into()));
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_not_utf8_is_preserved_byte_for_byte() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        let scene = Path::new(OsStr::from_bytes(b"/a/caf\xe9/sc\xe8ne \xff.glb"));
        for project in ["/a/p.fbrush", "/b/p.fbrush"] {
            let path = ScenePath::new(scene, project.as_ref());
            assert!(path.path.ends_with("caf\u{fffd}/sc\u{fffd}ne \u{fffd}.glb"), "{path:?}");
            assert_eq!(path.resolve(project.as_ref()).as_deref(), Some(scene));
            // Negative control: the text alone leads elsewhere.
            let text = ScenePath { path_bytes: None, ..path };
            assert_ne!(text.resolve(project.as_ref()).as_deref(), Some(scene));
        }
        // A backslash is a character like any other here.
        let odd = ScenePath::new("/x/a\\b.glb".as_ref(), "/a/p.fbrush".as_ref());
        assert_eq!(odd.resolve("/a/p.fbrush".as_ref()), Some("/x/a\\b.glb".into()));
    }

    #[test]
    fn bytes_that_are_none_are_refused() {
        for hex in ["0", "0g", "é"] {
            let path = ScenePath { path: "s.glb".into(), path_bytes: Some(hex.into()) };
            assert_eq!(path.resolve("/a/p.fbrush".as_ref()), None, "{hex}");
        }
    }
}
