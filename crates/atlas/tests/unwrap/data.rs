//! Files from elsewhere: each that opens gets an atlas.

use crate::Test;
use crate::layout::{centres_in_two_triangles, unwrap};
use crate::surface::check_surface;
use atlas::UnwrapOptions;
use progress::Unwatched;
use scene::LoadOptions;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub const TESTS: &[Test] =
    &[("data::every_file_that_opens_gets_an_atlas", every_file_that_opens_gets_an_atlas)];

/// Where the files lie.
pub fn data_folder() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).to_owned()
}

pub fn gltf_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            gltf_files(&path, files);
        } else if path.extension().is_some_and(|e| e == "glb" || e == "gltf") {
            files.push(path);
        }
    }
    files.sort();
}

fn every_file_that_opens_gets_an_atlas() {
    let data = data_folder();
    let mut files = Vec::new();
    gltf_files(&data.join("gltf"), &mut files);
    gltf_files(&data.join("gltf-broken"), &mut files);
    if files.is_empty() {
        println!("SKIPPED: no test data at {}", data.display());
    }
    for path in files {
        let Ok(scene) = scene::load(&path, &LoadOptions::default(), &Unwatched) else { continue };
        let start = Instant::now();
        let child = Some(std::env::current_exe().unwrap());
        let atlas = unwrap(&scene, &UnwrapOptions { child, ..UnwrapOptions::default() });
        println!(
            "  {}: {} triangles, {} parts, {:.2?}: {}×{}, {} charts {:?}",
            path.file_name().unwrap_or_default().display(),
            scene.triangles.len(),
            scene.parts.len(),
            start.elapsed(),
            atlas.width,
            atlas.height,
            atlas.charts.len(),
            atlas.notes
        );
        check_surface(&scene, &atlas);
        assert_eq!(centres_in_two_triangles(&atlas), 0, "{}", path.display());
    }
}
