//! The public sample models open as their authors meant them.

mod data;

use glam::{DVec3, Vec3};
use progress::Unwatched;
use scene::{ImageLevel, LightKind, LoadOptions, MeshHealth, Scene, SceneError, inspect, load};
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
        let inspection = inspect(&file, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let only_points_or_lines =
            ["00", "01", "02", "03", "07"].iter().any(|n| name.contains(&format!("Mode_{n}")));
        match open(&file) {
            Ok(scene) => {
                assert!(!only_points_or_lines);
                assert_eq!(scene.triangles.len(), inspection.triangles);
                println!(
                    "{name}: {} triangles, {} parts, {} materials, {} images, {} lights, {} cameras{}, {:?}, {:.2?}",
                    scene.triangles.len(),
                    scene.parts.len(),
                    scene.materials.len(),
                    scene.images.len(),
                    scene.lights.len(),
                    scene.cameras.len(),
                    if scene.has_default_camera { " (invented)" } else { "" },
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

fn sample(name: &str) -> Option<Scene> {
    let folder = data::folder("gltf")?;
    Some(open(&folder.join(name)).unwrap())
}

#[test]
fn sparse_positions_are_the_dense_ones() {
    let (Some(sparse), Some(dense)) = (sample("derived/portal_sparse.glb"), sample("portal.glb")) else {
        return;
    };
    assert_eq!(sparse.positions, dense.positions);
    assert_eq!(sparse.triangles, dense.triangles);
}

#[test]
fn sixteen_bit_images_are_the_eight_bit_ones() {
    let (Some(deep), Some(plain)) = (sample("derived/Fox_png16.glb"), sample("Fox.glb")) else { return };
    let (deep, plain) = (&deep.images[0], &plain.images[0]);
    assert!(matches!(deep.texels, ImageLevel::Bits16(_)) && matches!(plain.texels, ImageLevel::Bits8(_)));
    for (x, y) in (0..plain.height).flat_map(|y| (0..plain.width).map(move |x| (x, y))) {
        assert!(deep.texel(x, y, true).abs_diff_eq(plain.texel(x, y, true), 1e-7), "{x} {y}");
    }
}

#[test]
fn quantised_geometry_is_the_plain_one() {
    let (Some(quantised), Some(plain)) = (sample("derived/house_quantized.glb"), sample("house.glb")) else {
        return;
    };
    let (q, p) = (MeshHealth::measure(&quantised), MeshHealth::measure(&plain));
    assert!((q.area / p.area - 1.0).abs() < 2e-3, "{} {}", q.area, p.area);
    let size = (plain.bounds().1 - plain.bounds().0).max_element();
    assert!((quantised.bounds().0 - plain.bounds().0).abs().max_element() < 2e-4 * size);
    assert!((quantised.bounds().1 - plain.bounds().1).abs().max_element() < 2e-4 * size);
}

#[test]
fn the_fox_is_in_its_bind_pose() {
    // 154.7 units long and 78.9 high in its bind pose, which the default pose of its joints nearly is.
    let Some(fox) = sample("Fox.glb") else { return };
    let size = fox.bounds().1 - fox.bounds().0;
    assert!((size - DVec3::new(25.0, 79.0, 154.0)).abs().max_element() < 15.0, "{size}");
}

#[test]
fn texture_rotation_points_at_the_green_marker() {
    // The arrow of the image points along the diagonal; the marker lies at 67.5° from u, seen from the quad's
    // upper left corner; the red one, for the wrong sense, at 22.5°.
    let Some(scene) = sample("TextureTransformTest/TextureTransformTest.gltf") else { return };
    let rotation = scene.materials.iter().find(|material| material.name == "Rotation").unwrap();
    let transform = rotation.base_color_texture.unwrap().transform;
    let at = |u: f32, v: f32| transform * Vec3::new(u, v, 1.0);
    let (correct, wrong) = (at(0.42095, 1.01627), at(1.01627, 0.42095));
    assert!((correct.x - correct.y).abs() < 1e-4, "{correct}");
    assert!((wrong.x - wrong.y).abs() > 0.5, "{wrong}");
}

#[test]
fn the_framing_camera_sees_everything() {
    for name in ["FlightHelmet/FlightHelmet.gltf", "terrain.glb", "MorphStressTest/MorphStressTest.gltf"] {
        let Some(scene) = sample(name) else { return };
        assert!(scene.has_default_camera);
        let camera = &scene.cameras[0];
        let view = camera.camera_to_world.inverse();
        let tan = (0.5 * camera.yfov).tan();
        let mut extent: f64 = 0.0;
        for &position in &scene.positions {
            let p = view.transform_point3(position);
            assert!(p.z < 0.0);
            extent = extent.max(p.x.abs().max(p.y.abs()) / -p.z / tan);
        }
        assert!(extent < 1.0 && extent > 0.6, "{name}: {extent}");
        assert!(camera.focus_distance > 0.0 && camera.focus_distance.is_finite());
    }
}

#[test]
fn lights_and_cameras_of_the_file() {
    let Some(scene) = sample("geometry-camera-light.glb") else { return };
    assert!(scene.has_light_sources() && !scene.has_default_camera);
    assert_eq!(scene.cameras.len(), 1);
    assert!(scene.lights.iter().any(|light| light.kind == LightKind::Point));
    assert!(scene.lights.iter().any(|light| matches!(light.kind, LightKind::Spot { .. })));
    assert!(scene.lights.iter().all(|light| (light.direction.length() - 1.0).abs() < 1e-12));
}

#[test]
fn a_scene_of_unlit_materials_needs_no_light() {
    let Some(gallery) = sample("vr-gallery.glb") else { return };
    assert!(gallery.lights.is_empty() && gallery.has_light_sources());
}
