//! Matching of picture names to files.
//!
//! Programs write names as they were on another machine: with folders that do not exist here, with backslashes, in another case, with
//! another extension or none. Names are looked up among the existing files; none is ever opened as a path. Stricter comparisons are tried
//! first, for all names, and no file is the picture of two.

use std::collections::HashMap;

/// Files by their paths relative to a folder, with `/`.
pub(crate) struct PictureFiles {
    paths: Vec<String>,
}

/// The key by which a path is compared.
type KeyFunction = fn(&str) -> String;

impl PictureFiles {
    /// The files with these paths, to be found by name.
    pub fn new(paths: Vec<String>) -> Self {
        Self { paths }
    }

    /// The file that each name refers to, an index of the paths, if there is one.
    pub fn resolve(&self, names: &[String]) -> Vec<Option<usize>> {
        let names: Vec<Vec<&str>> = names.iter().map(|name| parts(name)).collect();
        let names = self.without_foreign_folders(&names);
        let mut matches = vec![None; names.len()];
        let mut is_taken = vec![false; self.paths.len()];
        const KEY_FUNCTIONS: [KeyFunction; 5] =
            [str::to_owned, str::to_lowercase, without_extension, file_name, |path| {
                without_extension(&file_name(path))
            }];
        for key_of in KEY_FUNCTIONS {
            // The file for each key; `None` if several have it.
            let mut by_key: HashMap<String, Option<usize>> = HashMap::new();
            for (file, path) in self.paths.iter().enumerate().filter(|(file, _)| !is_taken[*file]) {
                by_key.entry(key_of(path)).and_modify(|entry| *entry = None).or_insert(Some(file));
            }
            let mut claimants: HashMap<usize, Vec<usize>> = HashMap::new();
            for (name, text) in names.iter().enumerate().filter(|(name, _)| matches[*name].is_none()) {
                if let Some(Some(file)) = by_key.get(&key_of(text)) {
                    claimants.entry(*file).or_default().push(name);
                }
            }
            for (file, claimants) in claimants {
                // Two names with the same key cannot be distinguished: neither gets the file.
                if let [name] = claimants[..] {
                    matches[name] = Some(file);
                    is_taken[file] = true;
                }
            }
        }
        matches
    }

    /// The names without as many of their common leading folders as makes most of them existing paths.
    fn without_foreign_folders(&self, names: &[Vec<&str>]) -> Vec<String> {
        /// The most folders of a path.
        const DEEPEST: usize = 32;
        let Some((first, others)) = names.split_first() else { return Vec::new() };
        let in_common =
            |depth: &usize| others.iter().all(|name| name.len() > depth + 1 && name[*depth] == first[*depth]);
        let common = (0..first.len().saturating_sub(1).min(DEEPEST)).take_while(in_common).count();
        let files: HashMap<String, usize> =
            self.paths.iter().enumerate().map(|(file, path)| (without_extension(path), file)).collect();
        let stripped =
            |strip: usize| -> Vec<String> { names.iter().map(|name| name[strip..].join("/")).collect() };
        let hits = |strip: usize| {
            let is_there = |name: &&String| files.contains_key(&without_extension(name));
            stripped(strip).iter().filter(is_there).count()
        };
        // The first of the best.
        let best = (0..=common)
            .map(|strip| (hits(strip), strip))
            .max_by_key(|&(hits, strip)| (hits, usize::MAX - strip));
        stripped(best.map_or(0, |(_, strip)| strip))
    }
}

/// The folders and the file name of a path of any system.
fn parts(path: &str) -> Vec<&str> {
    let parts: Vec<&str> = path.split(['/', '\\']).filter(|part| !part.is_empty() && *part != ".").collect();
    if parts.is_empty() { vec![""] } else { parts }
}

/// Lower case, without the extension of a picture; other endings may be part of a name ("IMG.0001").
fn without_extension(path: &str) -> String {
    let path = path.to_lowercase();
    match path.rsplit_once('.') {
        Some((stem, extension)) if EXTENSIONS.contains(&extension) => stem.to_owned(),
        _ => path,
    }
}

/// Lower case, without the folders.
fn file_name(path: &str) -> String {
    path.rsplit_once('/').map_or(path, |(_, name)| name).to_lowercase()
}

/// Extensions of pictures. Not all formats can be read, but all are distinguished from other files.
pub(crate) const EXTENSIONS: [&str; 12] =
    ["jpg", "jpeg", "png", "webp", "hdr", "tif", "tiff", "exr", "bmp", "heic", "dng", "pgm"];

#[cfg(test)]
mod tests {
    use super::*;

    fn resolved(files: &[&str], names: &[&str]) -> Vec<Option<usize>> {
        let owned = |texts: &[&str]| texts.iter().copied().map(String::from).collect::<Vec<_>>();
        PictureFiles::new(owned(files)).resolve(&owned(names))
    }

    #[test]
    fn names_of_other_machines() {
        let files = ["a/1.jpg", "a/2.JPG", "b/1.jpg"];
        for names in [
            ["a/1.jpg", "a/2.JPG", "b/1.jpg"],
            ["a\\1.jpg", "a\\2.JPG", "b\\1.jpg"],
            ["A/1.JPG", "A/2.jpg", "B/1.JPG"],
            ["./a/1.jpg", "a//2.JPG", "b/1.jpg"],
            ["C:\\x\\a\\1.jpg", "C:\\x\\a\\2.JPG", "C:\\x\\b\\1.jpg"],
            ["../images/a/1", "../images/a/2", "../images/b/1"],
            ["a/1.png", "a/2.png", "b/1.png"],
        ] {
            assert_eq!(resolved(&files, &names), [Some(0), Some(1), Some(2)], "{names:?}");
        }
        // Labels without folders, where they match one file.
        assert_eq!(resolved(&["x/p.jpg", "y/q.jpg"], &["q", "p.JPG"]), [Some(1), Some(0)]);
    }

    #[test]
    fn no_picture_is_mistaken_for_another() {
        // A missing picture is missing, though another of its name exists.
        assert_eq!(resolved(&["cam0/1.jpg"], &["cam0/1.jpg", "cam1/1.jpg"]), [Some(0), None]);
        // Two candidates.
        assert_eq!(resolved(&["a/1.jpg", "b/1.jpg"], &["1.jpg"]), [None]);
        // The same name twice.
        assert_eq!(resolved(&["1.jpg"], &["1.jpg", "1.jpg"]), [None, None]);
        // Names that only differ in case.
        assert_eq!(resolved(&["p.jpg", "P.jpg"], &["P.jpg", "p.jpg"]), [Some(1), Some(0)]);
        assert_eq!(resolved(&["1.jpg"], &["", "/", "../.."]), [None, None, None]);
    }
}
