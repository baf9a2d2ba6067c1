//! The depth map of a picture in a file next to it, by its name.
//!
//! `NAME_depth.png`, `NAME.depth.png`, `NAME-disp.exr`, `depth_NAME.png`, `NAME.pfm`, `depth/NAME.png`; and if the folder holds a single
//! picture, any file that is named after depth: `depth.png`, `disp_rel.png`, `gt_disp_lowres.pfm`.

use crate::files::folder::extension;
use std::path::{Path, PathBuf};

/// Extensions of depth maps, likelier ones first.
const FORMS: [&str; 6] = ["pfm", "exr", "png", "webp", "jpg", "jpeg"];
/// Extensions of pictures.
const PICTURES: [&str; 5] = ["jpg", "jpeg", "png", "webp", "hdr"];
/// Words for depth, at the beginning of a word.
const WORDS: [&str; 5] = ["depth", "disp", "dpt", "midas", "zdepth"];
/// Names of folders of depth maps.
const FOLDERS: [&str; 6] = ["depth", "depths", "depth_maps", "disparity", "disparities", "disp"];

/// The name of a file without its extension, lower case.
fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Whether a word denotes depth.
fn is_word(text: &str) -> bool {
    let text = text.trim_start_matches("gt_");
    text == "z" || WORDS.iter().any(|word| text.starts_with(word))
}

/// Whether a picture is a depth map or a mask, by its name alone.
fn is_no_picture(file: &Path) -> bool {
    let stem = stem(file);
    let in_words = stem.split(['_', '-', '.', ' ']).any(|word| is_word(word) && word != "z");
    in_words || stem == "mask" || stem.ends_with("_mask") || stem.starts_with("confidence")
}

/// The files of a folder, sorted; at most `MAX_FILES`.
fn files(folder: &Path) -> Vec<PathBuf> {
    const MAX_FILES: usize = 20_000;
    let entries = std::fs::read_dir(folder).into_iter().flatten().take(MAX_FILES).flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// The pictures of a folder that are not depth maps.
pub(super) fn pictures(folder: &Path) -> Vec<PathBuf> {
    let is_picture = |file: &PathBuf| PICTURES.contains(&extension(file).as_str()) && !is_no_picture(file);
    files(folder).into_iter().filter(is_picture).collect()
}

/// Whether a file of a folder is inside it: no link leads elsewhere.
fn keeps_to(folder: &Path, file: &Path) -> bool {
    match (folder.canonicalize(), file.canonicalize()) {
        (Ok(folder), Ok(file)) => file.starts_with(folder),
        _ => false,
    }
}

/// The depth maps next to a picture, the likeliest first.
pub(super) fn depth_files(picture: &Path) -> Vec<PathBuf> {
    let folder = match picture.parent() {
        Some(folder) if folder.as_os_str().is_empty() => Path::new("."),
        Some(folder) => folder,
        None => return Vec::new(),
    };
    let name = stem(picture);
    let form = |file: &Path| FORMS.iter().position(|form| *form == extension(file));
    let all = files(folder);
    let is_single = pictures(folder) == [folder.join(picture.file_name().unwrap_or_default())];
    // How well a file's name fits: the lower the better.
    let fit = |file: &PathBuf| {
        let other = stem(file);
        let behind = other.strip_prefix(&name).and_then(|rest| rest.strip_prefix(['_', '-', '.', ' ']));
        let before = other.strip_suffix(&name).map(|rest| rest.trim_end_matches(['_', '-', '.', ' ']));
        match () {
            () if behind.is_some_and(is_word) => Some(0),
            () if before.is_some_and(|before| before.len() < other.len() - name.len() && is_word(before)) => {
                Some(1)
            }
            () if other == name && extension(file) == "pfm" => Some(2),
            () if is_single
                && is_no_picture(file)
                && !other.contains("mask")
                && !other.starts_with("confidence") =>
            {
                Some(4)
            }
            () => None,
        }
    };
    let itself = picture.file_name();
    let siblings = all.into_iter().filter(|file| file.file_name() != itself);
    let mut matches: Vec<(u32, usize, PathBuf)> =
        siblings.filter_map(|file| Some((fit(&file)?, form(&file)?, file))).collect();
    for inner in FOLDERS {
        let files = files(&folder.join(inner)).into_iter().filter(|file| stem(file) == name);
        matches.extend(files.filter_map(|file| Some((3, form(&file)?, file))));
    }
    matches.retain(|(.., file)| keeps_to(folder, file));
    matches.sort();
    matches.into_iter().map(|(.., file)| file).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matching_files(files: &[&str], picture: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        for file in files.iter().chain([&picture]) {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        let relative = |file: PathBuf| file.strip_prefix(folder.path()).unwrap().display().to_string();
        depth_files(&folder.path().join(picture)).into_iter().map(relative).collect()
    }

    #[test]
    fn names_that_people_use() {
        for name in [
            "cat_depth.png",
            "cat.depth.png",
            "cat-disp.exr",
            "cat_DISPARITY.PNG",
            "depth_cat.png",
            "cat.pfm",
            "depth/cat.png",
            "cat-dpt_beit_large_512.png",
            "cat_z.exr",
        ] {
            assert_eq!(matching_files(&[name, "dog.jpg", "dog_depth.png"], "cat.jpg"), [name]);
        }
        assert_eq!(matching_files(&["dog_depth.png", "cat_small.png", "cats_depth.png"], "cat.jpg"), [""; 0]);
        assert_eq!(
            matching_files(&["cat_depth.png", "cat_depth.pfm"], "cat.jpg"),
            ["cat_depth.pfm", "cat_depth.png"]
        );
    }

    #[test]
    fn one_picture_and_one_depth() {
        for name in ["depth.png", "disp_rel.png", "gt_disp_lowres.pfm", "depth_map.exr"] {
            assert_eq!(matching_files(&[name, "mask.png"], "photo.jpg"), [name]);
            assert_eq!(matching_files(&[name, "other.jpg"], "photo.jpg"), [""; 0]);
        }
    }
}
