//! File names of frames: patterns in which `#` stands for a digit.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// A file name for each frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameFiles(Name);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Name {
    /// The same for all frames.
    Fixed(PathBuf),
    /// The frame number between two pieces of text.
    Numbered { folder: PathBuf, before: String, digits: usize, after: String },
}

impl FrameFiles {
    /// File names from a pattern with one run of `#`, one for each digit (the minimum number of digits): `out.####.exr`. Before the digits
    /// of a frame below 0 there is a minus sign, as in Blender: `out.-0003.exr`.
    ///
    /// # Errors
    /// The pattern has no run of `#`, or more than one, or is not UTF-8.
    pub fn new(pattern: &Path) -> Result<Self, String> {
        let name = pattern.file_name().unwrap_or(OsStr::new(""));
        let wrong = || {
            let what = "has no run of # for the frame number (write it as out.####.exr)";
            format!("{}: {what}", pattern.display())
        };
        let name = name.to_str();
        let name =
            name.ok_or_else(|| format!("{}: the name is not UTF-8 (choose another)", pattern.display()))?;
        let (before, rest) = name.split_once('#').ok_or_else(wrong)?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return Err(format!(
                "{}: has more than one run of # (write one, as in out.####.exr)",
                pattern.display()
            ));
        }
        let digits = 1 + rest.len() - after.len();
        let (before, after) = (before.to_string(), after.to_string());
        let folder = pattern.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self(Name::Numbered { folder, before, digits, after }))
    }

    /// The files of a single frame: one with a fixed name.
    pub fn single(file: &Path) -> Self {
        Self(Name::Fixed(file.to_owned()))
    }

    /// The path of the file of a frame.
    pub fn path_of(&self, frame: i32) -> PathBuf {
        match &self.0 {
            Name::Fixed(file) => file.clone(),
            Name::Numbered { folder, before, digits, after } => {
                let (sign, frame) = (if frame < 0 { "-" } else { "" }, frame.unsigned_abs());
                folder.join(format!("{before}{sign}{frame:0digits$}{after}"))
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
        assert_eq!(files.path_of(0), Path::new("shots/a.0000.exr"));
        assert_eq!(files.path_of(-3), Path::new("shots/a.-0003.exr"));
        assert_eq!(files.path_of(-12345), Path::new("shots/a.-12345.exr"));
        assert_eq!(FrameFiles::new(Path::new("#.png")).unwrap().path_of(3), Path::new("3.png"));
        for wrong in ["a.exr", "a.##.#.exr", "##/a.exr", ""] {
            assert!(FrameFiles::new(Path::new(wrong)).is_err(), "{wrong}");
        }
    }
}
