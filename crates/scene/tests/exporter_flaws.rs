//! What exporters get wrong in ways that leave no doubt what they mean: it opens, with a warning.

mod handmade;

use glam::Vec3;
use handmade::{Glb, load_bytes};
use progress::Unwatched;
use scene::{LightKind, LoadOptions, Scene, SceneError, load};
use serde_json::json;
use std::path::Path;
use tempfile::TempDir;

/// A .glb of these chunks.
fn glb_of(chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
    let chunks: Vec<u8> = (chunks.iter())
        .flat_map(|(kind, body)| [&(body.len() as u32).to_le_bytes()[..], kind, body].concat())
        .collect();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

#[test]
fn json_chunks_are_filled_up_by_anything() {
    let glb = Glb::triangle();
    let expected = glb.clean();
    let json = glb.json.to_string().into_bytes();
    for filling in [b'\0', b'\n', b'\t', 0x0c, 0xff, 0xcd] {
        let mut json = json.clone();
        json.resize(json.len().next_multiple_of(4) + 4, filling);
        let bytes = glb_of(&[(b"JSON", &json), (b"BIN\0", &glb.bin)]);
        let scene = load_bytes(&bytes, &LoadOptions::default()).unwrap_or_else(|e| panic!("{filling}: {e}"));
        assert_eq!(
            (scene.positions, scene.triangles),
            (expected.positions.clone(), expected.triangles.clone())
        );
        // Line ends and tabs are white space to JSON.
        let is_odd = !filling.is_ascii_whitespace() || filling == 0x0c;
        assert_eq!(!scene.warnings.is_empty(), is_odd, "{filling}: {:?}", scene.warnings);
    }
}

#[test]
fn chunks_may_be_more_and_files_longer() {
    let glb = Glb::triangle();
    let json = [b"\xEF\xBB\xBF", glb.json.to_string().as_bytes()].concat();
    let mut bytes = glb_of(&[(b"JSON", &json), (b"what", b"ever"), (b"BIN\0", &glb.bin), (b"more", b"")]);
    bytes.extend([0; 37]);
    let scene = load_bytes(&bytes, &LoadOptions::default()).unwrap();
    assert_eq!(scene.triangles.len(), 1);
    for what in ["byte order mark", "unknown type", "the GLB header declares", "after the last GLB chunk"] {
        assert!(scene.warnings.iter().any(|warning| warning.contains(what)), "{what}: {:?}", scene.warnings);
    }
}

/// Loads `folder/scene.gltf`, whose buffer is `uri`.
fn with_buffer(folder: &Path, uri: &str) -> Result<Scene, SceneError> {
    let mut glb = Glb::triangle();
    glb.json["buffers"][0]["uri"] = json!(uri);
    let file = folder.join("scene.gltf");
    std::fs::write(&file, glb.json.to_string()).unwrap();
    load(&file, &LoadOptions::default(), &Unwatched)
}

/// (the URI, the only file there is besides the scene, whether the URI is how that file is to be named)
const NAMES: &[(&str, &str, bool)] = &[
    ("a%20b.bin", "a b.bin", true),
    ("a b.bin", "a b.bin", true),
    ("100%25.bin", "100%.bin", true),
    ("%23%3F.bin", "#?.bin", true),
    ("caf%C3%A9/a+b.bin", "café/a+b.bin", true),
    ("a%20b.bin", "a%20b.bin", false),
    ("example 10%.bin", "example 10%.bin", false),
    ("example%2010%.bin", "example 10%.bin", false),
    ("%zz.bin", "%zz.bin", false),
    ("100%", "100%", false),
    ("%", "%", false),
    ("50%ab.bin", "50%ab.bin", false),
    ("caf%e9.bin", "caf%e9.bin", false),
    ("caf%e9.bin", "café.bin", false),
    ("a#1.bin", "a#1.bin", false),
    ("a?.bin", "a?.bin", false),
    ("a.bin?v=2", "a.bin", false),
    ("a%20b.bin#part", "a b.bin", false),
    ("a+b.bin", "a b.bin", false),
    ("a%2Bb+c.bin", "a+b c.bin", false),
    ("data\\a%20b.bin", "data/a b.bin", false),
    (".\\data\\100%.bin", "data/100%.bin", false),
];

#[test]
fn buffers_resolve_by_the_names_that_exporters_write() {
    for &(uri, name, is_proper) in NAMES {
        let folder = TempDir::new().unwrap();
        let file = folder.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        // Windows has no such names.
        let written = std::fs::write(&file, &Glb::triangle().bin);
        if cfg!(windows) && written.is_err() {
            continue;
        }
        let scene = with_buffer(folder.path(), uri).unwrap_or_else(|error| panic!("{uri}: {error}"));
        let told = scene.warnings.iter().any(|warning| warning.contains("/buffers/0/uri"));
        assert_eq!((scene.triangles.len(), told), (1, !is_proper), "{uri}: {:?}", scene.warnings);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn names_in_other_encodings_resolve() {
    use std::os::unix::ffi::OsStrExt;
    for (uri, name) in [("caf%e9.bin", &b"caf\xe9.bin"[..]), ("data\\a.bin", b"data\\a.bin")] {
        let folder = TempDir::new().unwrap();
        let file = folder.path().join(std::ffi::OsStr::from_bytes(name));
        std::fs::write(file, &Glb::triangle().bin).unwrap();
        let scene = with_buffer(folder.path(), uri).unwrap();
        assert!(scene.warnings[0].contains("is not a valid URI"), "{uri}: {:?}", scene.warnings);
    }
}

#[test]
fn the_proper_reading_wins() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("a b.bin"), &Glb::triangle().bin).unwrap();
    std::fs::write(folder.path().join("a%20b.bin"), b"").unwrap();
    let scene = with_buffer(folder.path(), "a%20b.bin").unwrap();
    assert_eq!((scene.triangles.len(), scene.warnings), (1, vec![]));
}

#[test]
fn images_resolve_like_buffers() {
    let mut glb = Glb::triangle();
    let uv = glb.accessor(&[0.0; 6], "VEC2");
    let primitive = &mut glb.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = json!(uv);
    primitive["material"] = json!(0);
    glb.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    glb.json["textures"] = json!([{"source": 0}]);
    glb.json["images"] = json!([{"uri": "wood 10%.png"}]);
    let folder = TempDir::new().unwrap();
    image::RgbaImage::from_pixel(1, 1, image::Rgba([255, 0, 0, 255]))
        .save(folder.path().join("wood 10%.png"))
        .unwrap();
    let file = folder.path().join("scene.glb");
    std::fs::write(&file, glb.bytes()).unwrap();
    let scene = load(&file, &LoadOptions::default(), &Unwatched).unwrap();
    assert_eq!((scene.images.len(), scene.warnings.len()), (1, 1), "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("/images/0/uri: wood 10%.png"), "{:?}", scene.warnings);
}

#[test]
fn no_reading_of_a_name_leaves_the_folder() {
    let outer = TempDir::new().unwrap();
    let inner = outer.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    for name in ["outside.bin", "out side.bin", "100%.bin"] {
        std::fs::write(outer.path().join(name), &Glb::triangle().bin).unwrap();
    }
    let absolute = outer.path().join("outside.bin").display().to_string();
    let encoded = absolute.replace('/', "%2F");
    for uri in [
        "../outside.bin",
        "..%2foutside.bin",
        "%2e%2e/outside.bin",
        "%2E%2E%2Foutside.bin",
        "..\\outside.bin",
        "..%5coutside.bin",
        ".%2e/100%.bin",
        "../100%.bin",
        "..%2f100%.bin",
        "../out+side.bin",
        "..%2fout+side.bin",
        "../outside.bin?v=1",
        "..%2foutside.bin#x",
        "x/..%2f..%2foutside.bin",
        "%252e%252e/outside.bin",
        "..%c0%afoutside.bin",
        "%e9/../../outside.bin",
        &absolute,
        &encoded,
        &format!("file://{absolute}"),
        &format!("{absolute}?100%"),
    ] {
        let error = with_buffer(&inner, uri).unwrap_err().to_string();
        assert!(error.contains("/buffers/0/uri"), "{uri}: {error}");
    }
    #[cfg(unix)]
    for (link, uri) in [("100%.bin", "100%.bin"), ("a%20b.bin", "a%20b.bin"), ("a b.bin", "a+b.bin")] {
        std::os::unix::fs::symlink(outer.path().join("outside.bin"), inner.join(link)).unwrap();
        assert!(with_buffer(&inner, uri).is_err(), "{uri}");
    }
    // What only looks like the way out is a name inside.
    #[cfg(unix)]
    {
        std::fs::write(inner.join("..%2foutside.bin"), &Glb::triangle().bin).unwrap();
        assert!(with_buffer(&inner, "..%2foutside.bin").unwrap().warnings[0].contains("is not a valid URI"));
    }
}

/// A triangle under one light with these properties.
fn lit_by(light: serde_json::Value) -> Glb {
    let mut glb = Glb::triangle();
    glb.json["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    glb.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    glb
}

#[test]
fn a_range_that_is_none_has_no_end() {
    assert_eq!(lit_by(json!({"type": "point", "range": 5})).clean().lights[0].range, 5.0);
    assert_eq!(lit_by(json!({"type": "point"})).clean().lights[0].range, f64::INFINITY);
    for kind in ["point", "spot"] {
        for range in [json!(0), json!(-0.0), json!(-3), json!("none"), json!(null), json!([]), json!(1e300)] {
            let glb = lit_by(json!({"type": kind, "spot": {}, "range": range}));
            let scene = glb.load().unwrap_or_else(|error| panic!("{kind} {range}: {error}"));
            assert_eq!(scene.lights[0].range, f64::INFINITY, "{kind} {range}");
            // A large number is a range.
            let told = scene.warnings.iter().any(|warning| warning.contains("/lights/0/range"));
            assert_eq!(told, range != json!(1e300), "{kind} {range}: {:?}", scene.warnings);
        }
    }
    // Light from infinity has no range to be wrong.
    let sun = lit_by(json!({"type": "directional", "range": 0})).load().unwrap();
    assert_eq!(sun.lights.len(), 1);
    // As Python and others write it, JSON or not.
    for number in ["NaN", "Infinity", "-Infinity"] {
        let glb = lit_by(json!({"type": "point", "range": "RANGE"}));
        let text = glb.json.to_string().replace("\"RANGE\"", number);
        let scene =
            load_bytes(&glb_of(&[(b"JSON", text.as_bytes()), (b"BIN\0", &glb.bin)]), &LoadOptions::default());
        let scene = scene.unwrap_or_else(|error| panic!("{number}: {error}"));
        assert_eq!(scene.lights[0].range, f64::INFINITY);
        assert!(
            scene.warnings.iter().any(|warning| warning.contains("NaN or Infinity")),
            "{:?}",
            scene.warnings
        );
    }
}

#[test]
fn cones_are_cones() {
    let right = std::f64::consts::FRAC_PI_2;
    for (inner, outer, expected, is_sound) in [
        (json!(0.25), json!(0.5), (0.25, 0.5), true),
        (json!(null), json!(std::f32::consts::FRAC_PI_2), (0.0, right), false),
        (json!(0), json!(std::f32::consts::FRAC_PI_2), (0.0, right), true),
        (json!(0.5), json!(0.5), (0.5, 0.5), false),
        (json!(0.75), json!(0.5), (0.5, 0.5), false),
        (json!(-1), json!(0.5), (0.0, 0.5), false),
        (json!(0), json!(0), (0.0, right / 2.0), false),
        (json!(0), json!(-0.5), (0.0, right / 2.0), false),
        (json!(0), json!("wide"), (0.0, right / 2.0), false),
        (json!("narrow"), json!(0.5), (0.0, 0.5), false),
        (json!(0.5), json!(3), (0.5, right), false),
        (json!(9), json!(9), (right, right), false),
    ] {
        let spot = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        let scene = lit_by(json!({"type": "spot", "spot": spot})).load().unwrap();
        let LightKind::Spot { inner, outer } = scene.lights[0].kind else { panic!("{:?}", scene.lights) };
        assert!((inner - expected.0).abs() + (outer - expected.1).abs() < 1e-6, "{spot}: {inner} {outer}");
        assert!((0.0..=outer).contains(&inner) && outer <= right, "{spot}: {inner} {outer}");
        assert_eq!(scene.warnings.is_empty(), is_sound, "{spot}: {:?}", scene.warnings);
    }
    for spot in [json!(null), json!({}), json!(3)] {
        let scene = lit_by(json!({"type": "spot", "spot": spot})).load().unwrap();
        assert_eq!(
            scene.lights[0].kind,
            LightKind::Spot { inner: 0.0, outer: f64::from(std::f32::consts::FRAC_PI_4) }
        );
    }
}

#[test]
fn light_is_not_negative() {
    for (light, expected) in [
        (json!({"type": "point", "intensity": 0}), Vec3::ZERO),
        (json!({"type": "point", "intensity": -2}), Vec3::ZERO),
        (json!({"type": "point", "intensity": 2, "color": [1, -1, 0.5]}), Vec3::new(2.0, 0.0, 1.0)),
    ] {
        let scene = lit_by(light.clone()).load().unwrap();
        assert_eq!(scene.lights[0].intensity, expected, "{light}");
        let is_dark =
            scene.warnings.iter().any(|warning| warning.contains("all of its lights have an intensity of 0"));
        assert_eq!(is_dark, expected == Vec3::ZERO, "{light}: {:?}", scene.warnings);
    }
    let endless = lit_by(json!({"type": "point", "intensity": 1e300})).load().unwrap();
    assert!(endless.warnings.iter().any(|warning| warning.contains("is not finite; the light is left out")));
}
