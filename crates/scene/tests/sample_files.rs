//! The public sample models open as their authors meant them.

mod data;

use progress::Unwatched;
use scene::{LoadOptions, Scene, SceneError, inspect, load};
use std::path::Path;
use std::time::Instant;

fn open(path: &Path) -> Result<Scene, SceneError> {
    load(path, &LoadOptions::default(), &Unwatched)
}

#[test]
fn every_model_opens() {
    let Some(folder) = data::folder("gltf") else { return };
    let files = data::scenes(&folder);
    assert!(files.len() >= 20, "{}", files.len());
    for file in files {
        let start = Instant::now();
        let name = file.strip_prefix(&folder).unwrap().display().to_string();
        let inspection = inspect(&file).unwrap_or_else(|error| panic!("{error}"));
        let only_points_or_lines =
            ["00", "01", "02", "03", "07"].iter().any(|n| name.contains(&format!("Mode_{n}")));
        match open(&file) {
            Ok(scene) => {
                assert!(!only_points_or_lines);
                assert_eq!(scene.triangles.len(), inspection.triangles);
                println!(
                    "{name}: {} triangles, {} parts, {} materials, {} images, {} lights{}, {} cameras{}, {:?}, {:.2?}",
                    scene.triangles.len(),
                    scene.parts.len(),
                    scene.materials.len(),
                    scene.images.len(),
                    scene.lights.len(),
                    if scene.lights_are_invented { " (invented)" } else { "" },
                    scene.cameras.len(),
                    if scene.camera_is_invented { " (invented)" } else { "" },
                    scene.warnings,
                    start.elapsed()
                );
            }
            Err(error @ SceneError::NoTriangles { .. }) => {
                assert!(only_points_or_lines, "{error}");
                println!("{error}");
            }
            Err(error) => panic!("{error}"),
        }
    }
}
