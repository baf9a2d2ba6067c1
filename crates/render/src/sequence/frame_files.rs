//! Where frames are written: a name in which `#` stands for digits.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The name of a file for each frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameFiles(Name);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Name {
    /// The same whatever the frame.
    Fixed(PathBuf),
    /// The number between two pieces of text.
    Numbered { folder: PathBuf, before: String, digits: usize, after: String },
}

impl FrameFiles {
    /// A name with a row of `#` in it, as many as there are digits at least: `out.####.exr`.
    ///
    /// # Errors
    /// There is none, or more than one.
    pub fn new(pattern: &Path) -> Result<Self, String> {
        let name = pattern.file_name().unwrap_or(OsStr::new(""));
        let wrong = || {
            let what = "has no row of # for the frame's number (write it as out.####.exr)";
            format!("{}: {what}", pattern.display())
        };
        let name = name.to_str();
        let name =
            name.ok_or_else(|| format!("{}: its name is not UTF-8 (choose another)", pattern.display()))?;
        let (before, rest) = name.split_once('#').ok_or_else(wrong)?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return Err(format!("{}: has two rows of # (write one, as in out.####.exr)", pattern.display()));
        }
        let digits = 1 + rest.len() - after.len();
        let (before, after) = (before.to_string(), after.to_string());
        let folder = pattern.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self(Name::Numbered { folder, before, digits, after }))
    }

    /// One name, for one frame.
    pub fn single(file: &Path) -> Self {
        Self(Name::Fixed(file.to_owned()))
    }

    /// The file of a frame.
    pub fn path_of(&self, frame: u32) -> PathBuf {
        match &self.0 {
            Name::Fixed(file) => file.clone(),
            Name::Numbered { folder, before, digits, after } => {
                folder.join(format!("{before}{frame:0digits$}{after}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_the_place_of_the_row() {
        let files = FrameFiles::new(Path::new("shots/a.####.exr")).unwrap();
        assert_eq!(files.path_of(7), Path::new("shots/a.0007.exr"));
        assert_eq!(files.path_of(12345), Path::new("shots/a.12345.exr"));
        assert_eq!(FrameFiles::new(Path::new("#.png")).unwrap().path_of(3), Path::new("3.png"));
        for wrong in ["a.exr", "a.##.#.exr", "##/a.exr", ""] {
            assert!(FrameFiles::new(Path::new(wrong)).is_err(), "{wrong}");
        }
    }
}
