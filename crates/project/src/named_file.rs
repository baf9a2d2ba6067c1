//! Files that other files name: opening one must not read other parts of the disk.

use crate::ProjectError;
use std::path::{Path, PathBuf};

/// The file that `from` names, in the folder of `from` or below it. It may be missing.
///
/// # Errors
/// The name is absolute or a URL, or leads outside the folder, itself or by a link; or it is no regular file.
pub(crate) fn named_file(from: &Path, name: &str) -> Result<PathBuf, ProjectError> {
    let error = |problem: &str| {
        let file = from.file_name().unwrap_or_default().to_string_lossy();
        let problem = format!("names \"{}\", which {problem}", shortened(name));
        Err(ProjectError::content(
            from,
            problem,
            format!("put the file beside {file} and give its name alone"),
        ))
    };
    // A backslash separates on some systems, whatever it means here; a colon belongs to a scheme or a drive.
    let mut parts = name.split(['/', '\\']);
    if name.starts_with(['/', '\\']) || parts.any(|part| part == ".." || part.contains(':')) {
        return error("leads outside its folder");
    }
    let folder = from.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let path = folder.join(name);
    // What does not exist is reported by whoever reads it.
    let (Ok(real), Ok(real_folder)) = (path.canonicalize(), folder.canonicalize()) else { return Ok(path) };
    match (real.starts_with(real_folder), real.is_file()) {
        (false, _) => error("is a link that leads outside its folder"),
        (_, false) => error("is not a file"),
        _ => Ok(path),
    }
}

/// The beginning of a name, for a message.
fn shortened(name: &str) -> String {
    const LONGEST: usize = 80;
    let shown: String = name.chars().take(LONGEST).map(|c| if c.is_control() { '?' } else { c }).collect();
    if name.chars().nth(LONGEST).is_some() { shown + "…" } else { shown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("in");
        std::fs::create_dir_all(inside.join("sub")).unwrap();
        for file in ["in/a.png", "in/sub/b.png", "c.png"] {
            std::fs::write(folder.path().join(file), "").unwrap();
        }
        let from = inside.join("cam.json");
        for name in ["a.png", "./a.png", "sub/b.png", "missing.png"] {
            assert_eq!(named_file(&from, name).unwrap(), inside.join(name));
        }
        let absolute = folder.path().join("c.png");
        let url = format!("file://{}", absolute.display());
        let hostile =
            ["../c.png", "sub/../../c.png", "..\\c.png", "C:\\c.png", "//server/c.png", "sub", "/dev/zero"];
        for name in hostile.into_iter().chain([absolute.to_str().unwrap(), &url]) {
            let message = named_file(&from, name).unwrap_err().to_string();
            assert!(message.contains("cam.json: names"), "{name}: {message}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../c.png", inside.join("link.png")).unwrap();
            std::os::unix::fs::symlink("a.png", inside.join("good.png")).unwrap();
            assert!(named_file(&from, "link.png").is_err());
            assert!(named_file(&from, "good.png").is_ok());
        }
    }
}
