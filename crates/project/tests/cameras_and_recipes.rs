//! Camera and recipe files: what they mean, and what is said of bad ones.

mod damage;
mod shared_data;

use damage::{damage, is_one_line};
use focus::RecipeEntry;
use glam::{DMat4, DQuat, DVec2, DVec3};
use lens::{Aperture, ApertureMask, ApertureShape, Camera, Character, FocusOffset, Rim};
use project::{FocusFile, read_camera, read_focus, read_recipe, write_camera, write_rgb};
use shared_data::shared;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

fn write(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    file
}

fn unusual_camera() -> Camera {
    let turn = DQuat::from_rotation_y(0.1) * DQuat::from_rotation_x(1.0 / 3.0);
    Camera {
        width: 321,
        height: 123,
        yfov: 0.1 + 0.2,
        focus_distance: f64::INFINITY,
        aperture_radius: 1.0 / 7.0,
        sensor_height: 0.027,
        shift: DVec2::new(0.125, -0.3),
        camera_to_world: DMat4::from_rotation_translation(turn, DVec3::new(0.1, -1e-17, 1e10)),
        background: Some([0.1, 0.7, 3.0]),
        aperture: Aperture {
            shape: ApertureShape::Polygon { blades: 5, rotation: 0.3, roundness: 0.6 },
            ratio: 1.33,
        },
        character: Character {
            widest_radius: Some(0.2),
            field_curvature: 1.0 / 3.0,
            longitudinal_colour: [1e-4, -3e-4],
            lateral_colour: [1e-3, 2e-3],
            edges: -0.7,
            rims: [Some(Rim { radius: 0.1, distance: 0.3 }), Some(Rim { radius: 0.2, distance: -0.1 })],
            has_cos4_falloff: true,
        },
    }
}

#[test]
fn cameras_come_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("camera.json");
    let shapes = [ApertureShape::Disc, ApertureShape::Square, unusual_camera().aperture.shape];
    for shape in shapes {
        let camera = Camera { aperture: Aperture { shape, ratio: 0.7 }, ..unusual_camera() };
        write_camera(&file, &camera).unwrap();
        assert_eq!(read_camera(&file, &Camera::default()).unwrap(), camera);
    }
    damage(&file, |file| read_camera(file, &Camera::default()));
}

#[test]
fn missing_fields_keep_the_defaults() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "camera.json", r#"{"yfov": 0.5, "focus_distance": 2}"#);
    let read = read_camera(&file, &unusual_camera()).unwrap();
    assert_eq!(read, Camera { yfov: 0.5, focus_distance: 2.0, ..unusual_camera() });
    let file = write(&folder, "camera.json", r#"{"aperture": {"shape": "polygon"}}"#);
    let shape = ApertureShape::Polygon { blades: 6, rotation: 0.0, roundness: 0.0 };
    assert_eq!(read_camera(&file, &unusual_camera()).unwrap().aperture, Aperture::from(shape));
}

#[test]
fn a_character_replaces_that_of_before_and_knows_its_widest_radius() {
    let folder = TempDir::new().unwrap();
    let file = write(&folder, "camera.json", r#"{"aperture_radius": 0.03, "character": {"edges": 0.5}}"#);
    let character = Character { widest_radius: Some(0.03), edges: 0.5, ..Character::default() };
    assert_eq!(read_camera(&file, &unusual_camera()).unwrap().character, character);
    let file = write(&folder, "camera.json", r#"{"character": {}}"#);
    assert!(read_camera(&file, &unusual_camera()).unwrap().character.is_neutral());
}

#[test]
fn rows_of_the_pose_are_rows() {
    let folder = TempDir::new().unwrap();
    let text = r#"{"camera_to_world": [[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]}"#;
    let camera = read_camera(&write(&folder, "c.json", text), &Camera::default()).unwrap();
    assert_eq!(camera.position(), DVec3::new(5.0, 6.0, 7.0));
}

#[test]
fn masks_lie_beside_the_camera_and_are_not_decoded() {
    let folder = TempDir::new().unwrap();
    let grey = image::RgbImage::from_raw(2, 1, vec![0, 51, 102, 255, 255, 255]).unwrap();
    grey.save(folder.path().join("bokeh.png")).unwrap();
    let text = r#"{"aperture": {"shape": "mask", "mask": "bokeh.png", "ratio": 2}}"#;
    let file = write(&folder, "camera.json", text);
    let camera = read_camera(&file, &Camera::default()).unwrap();
    let transmission = vec![0.2, 1.0];
    let mask = ApertureMask { width: 2, height: 1, transmission, file: "bokeh.png".into() };
    assert_eq!(camera.aperture, Aperture { shape: ApertureShape::Mask(Arc::new(mask)), ratio: 2.0 });
    write_camera(&file, &camera).unwrap();
    assert_eq!(read_camera(&file, &Camera::default()).unwrap(), camera);
    std::fs::remove_file(folder.path().join("bokeh.png")).unwrap();
    let error = read_camera(&file, &Camera::default()).unwrap_err().to_string();
    is_one_line(&error, &folder.path().join("bokeh.png"));
}

#[test]
fn bad_cameras_are_reported_with_file_and_field() {
    let folder = TempDir::new().unwrap();
    let cases = [
        (r#"{"width": 0}"#, "width"),
        (r#"{"width": 1.5}"#, "width: is 1.5"),
        (r#"{"heigth": 100}"#, "heigth: is not a valid field"),
        (r#"{"yfov": "wide"}"#, "yfov: is the text \"wide\""),
        (r#"{"yfov": NaN}"#, "in \"yfov\""),
        (r#"{"yfov": 1e999}"#, "in \"yfov\""),
        (r#"{"focus_distance": "far"}"#, "focus_distance"),
        (r#"{"focus_distance": -1}"#, "focus_distance"),
        (r#"{"background": [1, 2]}"#, "background: has 2 numbers"),
        (r#"{"camera_to_world": [1, 2]}"#, "camera_to_world"),
        (r#"{"camera_to_world": [[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]}"#, "camera_to_world"),
        (r#"{"aperture": {"shape": "star"}}"#, "aperture.shape: \"star\" is not a shape"),
        (r#"{"aperture": {"shape": "polygon", "blades": 2}}"#, "aperture.blades"),
        (r#"{"aperture": {"shape": "mask"}}"#, "no mask is given"),
        (r#"{"aperture": {"blads": 2}}"#, "aperture.blads"),
        (r#"{"aperture": 6}"#, "aperture: is a number"),
        (r#"{"character": 6}"#, "character: is a number"),
        (r#"{"character": {"edge": 1}}"#, "character.edge: is not a valid field"),
        (r#"{"character": {"edges": 1.5}}"#, "character.edges: cannot be used"),
        (r#"{"character": {"edges": NaN}}"#, "in \"edges\""),
        (r#"{"character": {"lateral_colour": [1]}}"#, "character.lateral_colour: has 1 numbers"),
        (r#"{"character": {"longitudinal_colour": [0, 9]}}"#, "character.longitudinal_colour"),
        (r#"{"character": {"rims": [{"radius": 0.1}]}}"#, "has no \"distance\""),
        (r#"{"character": {"rims": [{"radius": 0, "distance": 1}]}}"#, "character.rims.radius"),
        (r#"{"character": {"rims": [{}, {}, {}]}}"#, "character.rims: has 3 rims"),
        (r#"{"character": {"cos4": 1}}"#, "character.cos4: is a number"),
        (r#"[1, 2]"#, "the whole file: is a list"),
        ("{\"width\": 100,\n \"height\" 100}", "line 2"),
    ];
    for (text, expected) in cases {
        let file = write(&folder, "camera.json", text);
        let error = read_camera(&file, &Camera::default()).unwrap_err().to_string();
        is_one_line(&error, &file);
        assert!(error.contains(expected), "{error} should contain {expected}");
    }
    is_one_line(
        &read_camera(Path::new("/no/such"), &Camera::default()).unwrap_err().to_string(),
        Path::new("/no/such"),
    );
}

/// Found by the fuzz target `camera`.
#[test]
fn errors_that_quote_line_breaks_are_one_line() {
    let folder = TempDir::new().unwrap();
    for text in [
        "{\"a\":[[1,0],[\n0,1],[0,\":{\"b\":1}",
        r#"{"field\nof two lines": 1}"#,
        r#"{"aperture": {"shape": "of\r\ntwo lines"}}"#,
    ] {
        let file = write(&folder, "camera.json", text);
        let error = read_camera(&file, &Camera::default()).unwrap_err().to_string();
        assert!(!error.contains(char::is_control), "{error:?}");
    }
}

#[test]
fn recipes_keep_order_and_repetition() {
    let folder = TempDir::new().unwrap();
    let text =
        r#"{"nodes": {"b": {"t": 2}, "a": {"anchor": 1}, "b": {}}, "default": {"t": 1.5, "anchor": 0.25}}"#;
    let file = write(&folder, "focus.json", text);
    let recipe = read_recipe(&file).unwrap();
    let value = |t, anchor| RecipeEntry::Value(FocusOffset::new(t, anchor));
    let nodes = [("b", value(2.0, 0.0)), ("a", value(1.0, 1.0)), ("b", value(1.0, 0.0))];
    assert_eq!(recipe.nodes, nodes.map(|(name, entry)| (name.to_string(), entry)));
    assert_eq!((recipe.default, recipe.background), (value(1.5, 0.25), None));
    let text = r#"{"default": {"t": 1.5, "gloss": 0.25}}"#;
    let glossy = read_recipe(&write(&folder, "glossy.json", text)).unwrap();
    assert_eq!(glossy.default, RecipeEntry::Value(FocusOffset::new(1.5, 0.0).with_gloss(0.25)));
    damage(&file, read_recipe);
}

#[test]
fn bad_recipes_are_reported_with_their_key() {
    let folder = TempDir::new().unwrap();
    write_rgb(&folder.path().join("colour.exr"), 1, 1, &[[0.0; 3]]).unwrap();
    let cases = [
        (r#"{"materials": {"wall": {"t": NaN}}}"#, "in \"t\""),
        (r#"{"materials": {"wall": {"t": 1e999}}}"#, "in \"t\""),
        (r#"{"materials": {"wall": {"t": "NaN"}}}"#, "materials.wall.t: is the text"),
        (r#"{"materials": {"wall": {"anchor": 1.5}}}"#, "materials.wall.anchor: is 1.5"),
        (r#"{"materials": {"wall": {"gloss": -0.1}}}"#, "materials.wall.gloss: is -0.1"),
        (r#"{"nodes": {"car": {"gloss": true}}}"#, "nodes.car.gloss: is"),
        (r#"{"nodes": {"car": {"gloss": 1, "map": "x.exr"}}}"#, "nodes.car: has a map and a value"),
        (r#"{"materials": {"wall": {"blur": 1}}}"#, "materials.wall.blur: is not a valid field"),
        (r#"{"materials": {"wall": {"t": 1, "map": "x.exr"}}}"#, "materials.wall: has a map and a value"),
        (r#"{"material": {}}"#, "material: is not a valid field"),
        (r#"{"nodes": []}"#, "nodes: is a list"),
    ];
    for (text, expected) in cases {
        let file = write(&folder, "focus.json", text);
        let error = read_recipe(&file).unwrap_err().to_string();
        is_one_line(&error, &file);
        assert!(error.contains(expected), "{error} should contain {expected}");
    }
    for (map, expected) in [("missing.exr", "cannot be read"), ("colour.exr", "focus.t")] {
        let file = write(&folder, "focus.json", &format!(r#"{{"default": {{"map": "{map}"}}}}"#));
        let error = read_recipe(&file).unwrap_err().to_string();
        is_one_line(&error, &folder.path().join(map));
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn the_reference_scenes_are_read_as_they_are() {
    let Some(scenes) = shared("peers/scenes") else { return };
    let camera = read_camera(&scenes.join("hard.camera.json"), &unusual_camera()).unwrap();
    assert_eq!((camera.width, camera.height, camera.sensor_height), (640, 360, 0.1));
    assert_eq!(camera.camera_to_world, unusual_camera().camera_to_world);

    let recipe = read_recipe(&scenes.join("hard.focus.json")).unwrap();
    let names: Vec<_> = recipe.materials.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["sphere", "sphere2", "lamps2", "ground"]);
    assert_eq!(recipe.materials[3].1, RecipeEntry::Value(FocusOffset::new(1.01, 0.0)));

    // As its maker computes it: t = 1 + 0.06 cos(2πx), x = column/64; anchor 1.
    let Ok(FocusFile::Recipe(recipe)) = read_focus(&scenes.join("brush.focus.json")) else { panic!() };
    let RecipeEntry::Map(map) = &recipe.materials[0].1 else { panic!("wall has a map") };
    assert_eq!((map.width, map.height), (64, 64));
    for (i, [t, anchor]) in map.texels.iter().enumerate() {
        let expected = 1.0 + 0.06 * (std::f64::consts::TAU * (i % 64) as f64 / 64.0).cos();
        assert!((*t as f64 - expected).abs() < 1e-6 && *anchor == 1.0);
    }
    assert_eq!(map.offset_range(), [0.94, 1.06]);
    // A map by itself is one in the mesh's UVs.
    let Ok(FocusFile::Map(map)) = read_focus(&scenes.join("hard.sphere.focus.exr")) else { panic!() };
    assert_eq!((map.atlas_hash, map.background), (None, None));
    let error = read_focus(&scenes.join("brush.glb")).unwrap_err().to_string();
    is_one_line(&error, &scenes.join("brush.glb"));
}
