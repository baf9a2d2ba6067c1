//! KHR_materials_variants: a scene in one of its file's variants, and files that tell them wrongly.

mod handmade;

use handmade::{Glb, MIDDLE, load_bytes};
use scene::{LoadOptions, Scene, SceneError};
use serde_json::{Value, json};

/// A triangle that is grey, red or green; its material in "Red" has a texture in a UV set of its own, and a normal map.
fn varied() -> Glb {
    let mut glb = Glb::triangle();
    let texture = glb.texture(&[[255, 0, 0, 255]]);
    glb.put_uv(0, 0.5, 0.5);
    glb.put_uv(1, 0.5, 0.5);
    glb.put_uv(2, 0.5, 0.5);
    let plain = |name: &str, color: [f32; 4]| json!({"name": name, "pbrMetallicRoughness": {"baseColorFactor": color}});
    glb.json["materials"] = json!([
        plain("grey", [0.5, 0.5, 0.5, 1.0]),
        {"name": "red", "pbrMetallicRoughness": {"baseColorTexture": {"index": texture, "texCoord": 2}},
         "normalTexture": {"index": texture}},
        plain("green", [0.0, 1.0, 0.0, 1.0]),
    ]);
    glb.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    glb.json["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "Red"}, {"name": "Green"}, {"name": "As it was"}]}});
    let primitive = &mut glb.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] = json!({"KHR_materials_variants": {"mappings": [
        {"material": 2, "variants": [1]}, {"material": 1, "variants": [0], "name": "in red"}]}});
    glb
}

fn load_in(glb: &Glb, variant: &str) -> Result<Scene, SceneError> {
    load_bytes(&glb.bytes(), &LoadOptions { variant: Some(variant.into()), ..LoadOptions::default() })
}

fn material(scene: &Scene) -> &str {
    &scene.material_of(0).name
}

/// The mappings of the primitive.
fn mappings(glb: &mut Glb) -> &mut Value {
    &mut glb.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"]
}

#[test]
fn a_variant_selects_materials_and_changes_nothing_else() {
    let glb = varied();
    let own = glb.clean();
    assert_eq!(own.variants, ["Red", "Green", "As it was"]);
    assert_eq!((material(&own), own.variant.as_deref(), own.images.len()), ("grey", None, 0));
    for (variant, expected) in [("Red", "red"), ("Green", "green"), ("As it was", "grey")] {
        let scene = load_in(&glb, variant).unwrap();
        assert_eq!(scene.warnings, [""; 0]);
        assert_eq!((material(&scene), scene.variant.as_deref()), (expected, Some(variant)));
        assert_eq!((&scene.positions, &scene.triangles), (&own.positions, &own.triangles));
        assert_eq!(scene.variants, own.variants);
    }
    // What the variant's material needs is there: its texture, in its UV set, and tangents.
    let red = load_in(&glb, "Red").unwrap();
    assert_eq!(red.base_color(MIDDLE).to_array(), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!((red.images.len(), red.further_uv.len(), red.tangents.len()), (1, 1, 1));
    assert_eq!((own.further_uv.len(), own.tangents.len()), (0, 0), "and what nobody chose is not");
}

#[test]
fn a_name_that_is_not_there_is_an_error_that_names_those_that_are() {
    let error = load_in(&varied(), "Blue").unwrap_err().to_string();
    assert!(
        error.contains(
            "handmade.glb: no variant is called \"Blue\" (there are \"Red\", \"Green\", \"As it was\")"
        ),
        "{error}"
    );
    let error = load_in(&Glb::triangle(), "Blue").unwrap_err().to_string();
    assert!(error.contains("\"Blue\" (the file has no variants"), "{error}");
    let mut many = varied();
    let variants: Vec<_> = (0..100).map(|k| json!({"name": format!("line\nbreak {k}")})).collect();
    many.json["extensions"]["KHR_materials_variants"]["variants"] = json!(variants);
    let error = load_in(&many, "Blue").unwrap_err().to_string();
    assert!(error.contains("and 70 more)") && !error.contains('\n'), "{error}");
}

#[test]
fn names_that_are_missing_or_alike_are_made_up() {
    let mut glb = varied();
    glb.json["extensions"]["KHR_materials_variants"]["variants"] =
        json!([{"name": "Red"}, {}, {"name": "Red"}, {"name": ""}, 7]);
    let scene = glb.load().unwrap();
    assert_eq!(scene.variants, ["Red", "variant 1", "Red (2)", "variant 3", "variant 4"]);
    for flaw in [
        "/variants/1: its name is missing",
        "/variants/2/name: \"Red\" is already taken",
        "/variants/4: is not an object",
    ] {
        assert!(scene.warnings.iter().any(|warning| warning.contains(flaw)), "{flaw}: {:?}", scene.warnings);
    }
    assert_eq!(material(&load_in(&glb, "variant 1").unwrap()), "green");
}

#[test]
fn what_is_wrong_with_the_chosen_variant_is_an_error_and_with_another_a_warning() {
    const PLACE: &str = "/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings/1/material";
    for (wrong, what) in [
        (json!(9), "refers to materials[9], which does not exist"),
        (json!("red"), "is not a whole number"),
        (json!(-1), "is not a whole number"),
        (Value::Null, "is missing"),
    ] {
        let mut glb = varied();
        mappings(&mut glb)[1]["material"] = wrong.clone();
        let error = load_in(&glb, "Red").unwrap_err().to_string();
        assert!(error.contains(PLACE) && error.contains(what), "{wrong}: {error}");
        for other in [load_in(&glb, "Green").unwrap(), glb.load().unwrap()] {
            let told = other.warnings.iter().any(|warning| warning.contains("mappings/1"));
            assert!(told, "{wrong}: {:?}", other.warnings);
        }
    }
}

#[test]
fn mappings_of_nothing_leave_the_material_as_it_is() {
    for (wrong, flaw) in [
        (json!([{"material": 1, "variants": [7]}]), "refers to variants[7], which does not exist"),
        (json!([{"material": 1, "variants": "all"}]), "variants: is not an array"),
        (json!([{"material": 1}]), "its variants is missing"),
        (json!([3]), "mappings/0: is not an object"),
        (json!({}), "mappings: is not an array"),
    ] {
        let mut glb = varied();
        *mappings(&mut glb) = wrong.clone();
        let scene = load_in(&glb, "Red").unwrap();
        assert_eq!(material(&scene), "grey", "{wrong}");
        assert!(scene.warnings.iter().any(|warning| warning.contains(flaw)), "{wrong}: {:?}", scene.warnings);
    }
    let mut twice = varied();
    *mappings(&mut twice) = json!([{"material": 2, "variants": [0]}, {"material": 1, "variants": [0]}]);
    let scene = load_in(&twice, "Red").unwrap();
    assert_eq!(material(&scene), "green", "the first counts");
    assert!(
        scene.warnings.iter().any(|w| w.contains("mappings/1/variants: variant 0 has")),
        "{:?}",
        scene.warnings
    );
    // A primitive whose own material is broken opens where a variant gives it another.
    let mut broken = varied();
    broken.json["meshes"][0]["primitives"][0]["material"] = json!(12);
    assert!(broken.load().is_err());
    assert_eq!(material(&load_in(&broken, "Red").unwrap()), "red");
}
