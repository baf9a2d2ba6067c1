//! EXT_lights_image_based: which way its faces look, what their texels shine, and files that tell it wrongly.

mod handmade;

use glam::{DQuat, DVec3, Vec3};
use handmade::{Glb, load_bytes};
use image::{ImageFormat, RgbImage, RgbaImage};
use scene::{Backdrop, Environment, LoadOptions, Scene, World};
use serde_json::{Value, json};

/// Texels of a side of a face.
const SIDE: u32 = 8;

/// Appends an image; its index.
fn add_image(glb: &mut Glb, picture: &image::DynamicImage, format: ImageFormat) -> usize {
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), format).unwrap();
    let view = json!({"buffer": 0, "byteOffset": glb.bin.len(), "byteLength": bytes.len()});
    glb.bin.extend(&bytes);
    glb.bin.resize(glb.bin.len().next_multiple_of(4), 0);
    glb.json["buffers"][0]["byteLength"] = json!(glb.bin.len());
    let views = glb.json["bufferViews"].as_array_mut().unwrap();
    views.push(view);
    let mime = if format == ImageFormat::Png { "image/png" } else { "image/jpeg" };
    let image = json!({"bufferView": views.len() - 1, "mimeType": mime});
    let mut images = glb.json["images"].as_array().cloned().unwrap_or_default();
    images.push(image);
    glb.json["images"] = json!(images);
    images.len() - 1
}

/// A light with these six faces.
fn lit(mut glb: Glb, faces: &[usize]) -> Glb {
    glb.json["extensionsUsed"] = json!(["EXT_lights_image_based"]);
    glb.json["scenes"][0]["extensions"] = json!({"EXT_lights_image_based": {"light": 0}});
    glb.json["extensions"] = json!({"EXT_lights_image_based": {"lights": [{
        "name": "six", "specularImageSize": SIDE, "specularImages": [faces],
        "irradianceCoefficients": vec![[0.0; 3]; 9]}]}});
    glb
}

/// A triangle in a light of which a direction's red, green and blue tell whether its x, y and z are positive. Faces are made by
/// OpenGL's table of cube maps (4.6, table 8.19), then mirrored left to right, as the extension says.
fn octants() -> Glb {
    let mut glb = Glb::triangle();
    let direction = |face: u32, s: f64, t: f64| match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    };
    let place = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0;
    let faces: Vec<usize> = (0..6)
        .map(|face| {
            let picture = RgbImage::from_fn(SIDE, SIDE, |column, row| {
                let direction = direction(face, place(SIDE - 1 - column), place(row));
                image::Rgb(direction.to_array().map(|x| if x > 0.0 { 255 } else { 0 }))
            });
            add_image(&mut glb, &picture.into(), ImageFormat::Png)
        })
        .collect();
    lit(glb, &faces)
}

/// A triangle in a light of one texel everywhere.
fn plain(texel: [u8; 4]) -> Glb {
    let mut glb = Glb::triangle();
    let picture = RgbaImage::from_pixel(SIDE, SIDE, image::Rgba(texel));
    let face = add_image(&mut glb, &picture.into(), ImageFormat::Png);
    lit(glb, &[face; 6])
}

fn light(glb: &mut Glb) -> &mut Value {
    &mut glb.json["extensions"]["EXT_lights_image_based"]["lights"][0]
}

fn world(scene: &Scene) -> &World {
    scene.embedded_world.as_ref().expect("a world of its own")
}

/// The middles of the octants.
fn corners() -> impl Iterator<Item = DVec3> {
    (0..8).map(|k| DVec3::from_array([1, 2, 4].map(|bit| if k & bit == 0 { -1.0 } else { 1.0 })))
}

/// Places in all octants that are away from their borders.
fn places() -> impl Iterator<Item = DVec3> {
    let lengths = [[3.0, 1.0, 1.0], [1.0, 3.0, 1.0], [1.0, 1.0, 3.0], [3.0, 2.0, 1.5], [1.5, 3.0, 2.0]];
    corners().flat_map(move |corner| lengths.map(|length| (corner * DVec3::from_array(length)).normalize()))
}

fn octant(direction: DVec3) -> Vec3 {
    Vec3::from_array(direction.to_array().map(|x| if x > 0.0 { 1.0 } else { 0.0 }))
}

#[test]
fn faces_have_the_directions_of_the_extension() {
    let scene = octants().clean();
    let world = world(&scene);
    assert_eq!((world.backdrop, world.rotation, world.strength), (Backdrop::Environment, 0.0, 1.0));
    let Environment::Map(map) = &world.environment else { panic!("no picture") };
    assert_eq!(map.name, "image-based light six");
    for direction in places() {
        let seen = world.radiance(direction);
        assert!(seen.abs_diff_eq(octant(direction), 1e-3), "{direction}: {seen}");
    }
    // It is the world where none was chosen, whatever background the camera has.
    assert_eq!(World::from_scene(&scene, Some(Vec3::ONE)), *world);
    let chosen = Scene { world: Some(World::studio()), ..scene.clone() };
    assert_eq!(World::from_scene(&chosen, None), World::studio());
    assert!(Glb::triangle().clean().embedded_world.is_none());
}

#[test]
fn a_rotation_rotates_the_radiance() {
    let rotation = DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(-0.4);
    let mut glb = octants();
    // Of any length but 0.
    light(&mut glb)["rotation"] = json!((rotation * 0.5).to_array());
    let scene = glb.clean();
    for direction in places() {
        let seen = world(&scene).radiance(rotation * direction);
        assert!(seen.abs_diff_eq(octant(direction), 1e-3), "{direction}: {seen}");
    }
    let unturned =
        places().filter(|&direction| world(&scene).radiance(direction).abs_diff_eq(octant(direction), 1e-3));
    assert!(unturned.count() < 30, "negative control");
}

#[test]
fn texels_are_srgb_over_their_opacity_times_the_intensity() {
    // sRGB 188 is 0.503 linear.
    let half = 0.502_886;
    for (texel, intensity, expected) in [
        ([188, 255, 0, 255], None, [half, 1.0, 0.0]),
        ([188, 255, 0, 51], None, [5.0 * half, 5.0, 0.0]),
        ([188, 255, 0, 1], Some(json!(3)), [765.0 * half, 765.0, 0.0]),
        ([188, 255, 0, 255], Some(json!(0.0)), [0.0; 3]),
    ] {
        let mut glb = plain(texel);
        if let Some(intensity) = intensity {
            light(&mut glb)["intensity"] = intensity;
        }
        let seen = world(&glb.clean()).radiance(DVec3::new(0.3, -0.4, 0.5).normalize());
        assert!(
            seen.abs_diff_eq(Vec3::from_array(expected), 1e-3 * seen.max_element().max(1.0)),
            "{texel:?}: {seen}"
        );
    }
    let mut jpeg = Glb::triangle();
    let picture = RgbImage::from_pixel(SIDE, SIDE, image::Rgb([188; 3]));
    let face = add_image(&mut jpeg, &picture.into(), ImageFormat::Jpeg);
    let seen = world(&lit(jpeg, &[face; 6]).clean()).radiance(DVec3::X);
    assert!(seen.abs_diff_eq(Vec3::splat(half), 0.02), "{seen}");
}

#[test]
fn what_cannot_be_a_light_is_an_error_that_names_its_place() {
    let lights = "/extensions/EXT_lights_image_based/lights/0";
    for (key, wrong, place) in [
        ("rotation", json!([0, 0, 0, 0]), "rotation: [0.0, 0.0, 0.0, 0.0] is not a rotation"),
        ("rotation", json!([1e200, 0, 0, 1e200]), "is not a rotation"),
        ("rotation", json!([0, 0, 1]), "rotation: is not an array of 4 numbers"),
        ("intensity", json!(-1), "intensity: -1 is negative"),
        ("intensity", json!(1e38), "more than can be computed with"),
        ("intensity", json!("bright"), "intensity: is not a number"),
        ("specularImages", Value::Null, "specularImages: is missing"),
        ("specularImages", json!([]), "specularImages: is missing or empty"),
        ("specularImages", json!([[0, 1, 2, 3, 4]]), "specularImages/0: has 5 faces, a cube has 6"),
        ("specularImages", json!([[0, 1, 2, 3, 4, "z"]]), "specularImages/0: is not an array of 6 images"),
        ("specularImages", json!([7]), "specularImages/0: is not an array of 6 images"),
        (
            "specularImages",
            json!([[0, 1, 2, 3, 4, 9]]),
            "specularImages/0/5: refers to images[9], which does not exist",
        ),
        ("name", json!(7), "name: is not a text"),
    ] {
        let mut glb = octants();
        light(&mut glb)[key] = wrong.clone();
        let error = glb.error();
        assert!(error.contains(lights) && error.contains(place), "{key} {wrong}: {error}");
        assert!(error.contains("handmade.glb: ") && error.ends_with(')') && !error.contains('\n'), "{error}");
    }
    for (place, wrong, what) in [
        ("/scenes/0/extensions/EXT_lights_image_based", json!({}), "light: is missing"),
        ("/scenes/0/extensions/EXT_lights_image_based", json!({"light": 1}), "refers to lights[1]"),
        ("/scenes/0/extensions/EXT_lights_image_based", json!(0), "is not an object"),
        ("/extensions/EXT_lights_image_based/lights", json!([3]), "lights/0: is not an object"),
        ("/extensions/EXT_lights_image_based/lights", json!(3), "lights: is not an array"),
        ("/extensions", json!({}), "refers to lights[0]"),
        ("/images/2", json!({"uri": "nowhere.png"}), "nowhere.png"),
    ] {
        let mut glb = octants();
        *glb.json.pointer_mut(place).unwrap() = wrong.clone();
        let error = glb.error();
        assert!(error.contains(what), "{place} {wrong}: {error}");
    }
    // What nobody can tell from infinity is no number of JSON.
    let text = octants().json.to_string().replace("\"name\":\"six\"", "\"intensity\":1e999");
    assert!(load_bytes(text.as_bytes(), &LoadOptions::default()).is_err());
}

#[test]
fn faces_are_square_of_one_size_and_opaque_somehow() {
    for (width, height, what) in [
        (8, 4, "has 8 × 4 texels, the faces of a cube are square"),
        (4, 4, "has 4 × 4 texels, another face 8 × 8"),
    ] {
        let mut glb = octants();
        let odd = add_image(&mut glb, &RgbImage::new(width, height).into(), ImageFormat::Png);
        light(&mut glb)["specularImages"][0][3] = json!(odd);
        let error = glb.error();
        assert!(error.contains(&format!("/images/{odd}: {what}")), "{error}");
    }
    let error = plain([255, 255, 255, 0]).error();
    assert!(error.contains("/images/0: has an opacity of 0 in column 0 of row 0"), "{error}");
}

#[test]
fn what_is_not_needed_is_a_warning() {
    for (key, wrong, what) in [
        ("specularImageSize", json!(16), "is 16, but the first faces have 8"),
        ("specularImageSize", Value::Null, "is missing"),
        ("irradianceCoefficients", json!([[0, 0]]), "is not an array of 9 arrays of 3 numbers"),
        ("irradianceCoefficients", Value::Null, "is not an array of 9 arrays of 3 numbers"),
    ] {
        let mut glb = octants();
        light(&mut glb)[key] = wrong;
        let scene = glb.load().unwrap();
        assert!(scene.warnings.len() == 1 && scene.warnings[0].contains(what), "{key}: {:?}", scene.warnings);
        assert_eq!(world(&scene).radiance(DVec3::ONE.normalize()), Vec3::ONE);
    }
    let mut glb = octants();
    let mips = light(&mut glb)["specularImages"].as_array_mut().unwrap();
    mips.push(json!([0, 1, 2, 3, 4, 77]));
    let scene = glb.load().unwrap();
    assert!(
        scene.warnings.len() == 1 && scene.warnings[0].contains("specularImages/1"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn memory_is_accounted_for() {
    let glb = octants();
    let load = |max_memory| load_bytes(&glb.bytes(), &LoadOptions { max_memory, ..LoadOptions::default() });
    // A picture of 256 × 128 texels, 12 bytes each.
    let error = load(256 * 128 * 12).unwrap_err().to_string();
    assert!(error.contains("lights/0 takes") && error.contains("raise the limit"), "{error}");
    assert!(load(256 * 128 * 12 + 100_000).is_ok());
}
