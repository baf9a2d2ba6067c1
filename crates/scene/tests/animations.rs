//! Scenes in motion: what is animated stands where its keys say, and the surface is that of the scene at rest.

mod data;
mod handmade;

use glam::{DVec3, Vec3};
use handmade::Glb;
use progress::Unwatched;
use scene::{AnimatedScene, AnimationTime, LoadOptions, PosedScene, SceneError, load};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// A file on the disk for as long as it is looked at.
struct Opened {
    scene: AnimatedScene,
    _folder: TempDir,
}

fn opened(glb: &Glb) -> Result<Opened, SceneError> {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("moving.glb");
    std::fs::write(&file, glb.bytes()).unwrap();
    let rest = Arc::new(load(&file, &LoadOptions::default(), &Unwatched)?);
    Ok(Opened { scene: AnimatedScene::open(rest, &LoadOptions::default(), &Unwatched)?, _folder: folder })
}

fn at(glb: &Glb, seconds: f64) -> PosedScene {
    opened(glb).unwrap().scene.pose_at(&AnimationTime { animation: None, seconds }, &Unwatched).unwrap()
}

impl Glb {
    /// Adds an animation of one channel.
    fn animate(&mut self, target: Value, keys: &[f32], values: &[f32], shape: &str, interpolation: &str) {
        let (input, output) = (self.accessor(keys, "SCALAR"), self.accessor(values, shape));
        let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
        let mut animations = self.json["animations"].as_array().cloned().unwrap_or_default();
        animations.push(json!({"name": format!("anim {}", animations.len()), "samplers": [sampler],
            "channels": [{"sampler": 0, "target": target}]}));
        self.json["animations"] = json!(animations);
    }

    fn animate_pointer(&mut self, pointer: &str, keys: &[f32], values: &[f32], shape: &str) {
        let target =
            json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
        self.animate(target, keys, values, shape, "STEP");
    }
}

const NODE: fn(&str) -> Value = |path| json!({"node": 0, "path": path});

#[test]
fn each_interpolation_passes_through_its_keys() {
    let positions = |interpolation: &str, values: &[f32], seconds: f64| {
        let mut glb = Glb::triangle();
        glb.animate(NODE("translation"), &[1.0, 3.0], values, "VEC3", interpolation);
        at(&glb, seconds).scene.positions[0]
    };
    let ends = [0.0, 0.0, 0.0, 4.0, 8.0, -2.0];
    assert_eq!(positions("LINEAR", &ends, 2.0), DVec3::new(2.0, 4.0, -1.0));
    assert_eq!(positions("LINEAR", &ends, 0.0), DVec3::ZERO, "before the first key");
    assert_eq!(positions("LINEAR", &ends, 99.0), DVec3::new(4.0, 8.0, -2.0), "after the last");
    assert_eq!(positions("STEP", &ends, 2.9), DVec3::ZERO);
    assert_eq!(positions("STEP", &ends, 3.0), DVec3::new(4.0, 8.0, -2.0));
    // Tangents of 0 make it 3u² − 2u³; one of (1, 0, 0)/s adds T·(u³ − 2u² + u).
    let spline = [[0.0; 9].as_slice(), &[0.0, 0.0, 0.0, 4.0, 8.0, -2.0, 0.0, 0.0, 0.0]].concat();
    assert_eq!(positions("CUBICSPLINE", &spline, 1.5), DVec3::new(4.0, 8.0, -2.0) * 0.15625);
    let mut pulled = spline;
    pulled[6] = 1.0;
    let more = positions("CUBICSPLINE", &pulled, 2.0) - DVec3::new(2.0, 4.0, -1.0);
    assert!((more - DVec3::X * 0.25).length() < 1e-12, "{more}");
}

#[test]
fn rotations_turn_at_an_even_pace() {
    let mut glb = Glb::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    glb.animate(NODE("rotation"), &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half], "VEC4", "LINEAR");
    let posed = at(&glb, 1.0 / 3.0);
    let turned = posed.scene.positions[1];
    let expected = DVec3::new((std::f64::consts::PI / 6.0).cos(), 0.5, 0.0);
    assert!((turned - expected).length() < 1e-6, "{turned}");
    assert!(posed.matches_rest());
}

#[test]
fn morph_targets_take_normals_along() {
    let mut glb = Glb::triangle();
    let moved = glb.accessor(&[0.0, 0.0, 2.0].repeat(3), "VEC3");
    let bent = glb.accessor(&[1.0, 0.0, 0.0].repeat(3), "VEC3");
    glb.json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": moved, "NORMAL": bent}, {"POSITION": bent}]);
    glb.json["meshes"][0]["weights"] = json!([0.0, 0.0]);
    glb.animate(NODE("weights"), &[0.0, 1.0], &[0.0, 0.0, 1.0, 0.5], "SCALAR", "LINEAR");
    let scene = at(&glb, 0.5).scene;
    assert_eq!(scene.positions[0], DVec3::new(0.25, 0.0, 1.0));
    assert!((scene.normals[0] - Vec3::new(0.5, 0.0, 1.0).normalize()).length() < 1e-6);
    // A pointer to one of the weights leaves the other.
    let mut glb = Glb { json: glb.json, bin: glb.bin };
    glb.animate_pointer("/meshes/0/weights/1", &[0.0], &[1.0], "SCALAR");
    let moment = AnimationTime { animation: Some("anim 1".into()), seconds: 0.0 };
    let posed = opened(&glb).unwrap().scene.pose_at(&moment, &Unwatched).unwrap();
    assert_eq!(posed.scene.positions[0], DVec3::X);
}

#[test]
fn skins_carry_their_vertices() {
    let mut glb = Glb::triangle();
    let joints = glb.raw_accessor(&[1, 0, 0, 0].repeat(3), 5121, "VEC4", 3);
    let weights = glb.accessor(&[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (json!(joints), json!(weights));
    glb.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2]}, {}]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    glb.json["skins"] = json!([{"joints": [1, 2]}]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    glb.animate(json!({"node": 1, "path": "rotation"}), &[0.0], &[half, 0.0, 0.0, half], "VEC4", "LINEAR");
    let scene = at(&glb, 0.0).scene;
    assert!((scene.positions[2] - DVec3::Z).length() < 1e-6, "{}", scene.positions[2]);
    assert!((scene.normals[0] + Vec3::Y).length() < 1e-6, "{}", scene.normals[0]);
}

/// Two nodes of the triangle, and the first triangle of a third mesh node.
fn three_nodes() -> Glb {
    let mut glb = Glb::triangle();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    glb.json["nodes"] =
        json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}, {"mesh": 0, "extensions": hidden}]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    glb
}

#[test]
fn what_is_hidden_leaves_and_what_is_shown_comes() {
    let mut glb = three_nodes();
    glb.animate_pointer(
        "/nodes/0/extensions/KHR_node_visibility/visible",
        &[0.0, 1.0],
        &[1.0, 0.0],
        "SCALAR",
    );
    let found = |glb: &Glb, seconds| {
        let posed = at(glb, seconds);
        posed.rest_triangles.iter().map(|rest| rest.map(|rest| rest.triangle)).collect::<Vec<_>>()
    };
    assert_eq!(found(&glb, 0.5), [Some(0), Some(1)]);
    assert_eq!(found(&glb, 1.0), [Some(1)], "paint stays with its own triangle");
    let mut glb = three_nodes();
    glb.animate_pointer(
        "/nodes/2/extensions/KHR_node_visibility/visible",
        &[0.0, 1.0],
        &[0.0, 1.0],
        "SCALAR",
    );
    assert_eq!(found(&glb, 1.0), [Some(0), Some(1), None], "what was hidden at rest has no place there");
}

#[test]
fn a_mirrored_moment_turns_corners() {
    let mut glb = Glb::triangle();
    glb.animate(NODE("scale"), &[0.0, 1.0], &[1.0, 1.0, 1.0, -1.0, 1.0, 1.0], "VEC3", "STEP");
    let turned = |seconds| at(&glb, seconds).rest_triangles[0].unwrap().is_flipped;
    assert!(!turned(0.0) && turned(1.0));
}

#[test]
fn cameras_move_and_zoom() {
    let mut glb = Glb::triangle();
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    glb.json["nodes"].as_array_mut().unwrap().push(json!({"camera": 0, "translation": [0, 0, 4]}));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    glb.animate(
        json!({"node": 1, "path": "translation"}),
        &[0.0, 1.0],
        &[0.0, 0.0, 4.0, 0.0, 0.0, 8.0],
        "VEC3",
        "LINEAR",
    );
    let camera = at(&glb, 0.5).scene.cameras[0].clone();
    assert_eq!(camera.camera_to_world.w_axis.truncate(), DVec3::Z * 6.0);
    assert_eq!(camera.focus_distance, 4.0, "the lens stays as it is");
    glb.json["animations"] = json!([]);
    glb.animate_pointer("/cameras/0/perspective/yfov", &[0.0], &[0.5], "SCALAR");
    assert_eq!(at(&glb, 0.0).scene.cameras[0].yfov, 0.5);
}

#[test]
fn pointers_animate_materials() {
    let mut glb = Glb::triangle();
    glb.paint(json!({"emissiveFactor": [0, 0, 0]}));
    glb.animate_pointer("/materials/0/emissiveFactor", &[0.0, 1.0], &[0.0, 0.0, 0.0, 0.5, 0.25, 1.0], "VEC3");
    assert_eq!(at(&glb, 1.0).scene.materials[0].emissive, Vec3::new(0.5, 0.25, 1.0));
}

#[test]
fn flaws_leave_the_rest_moving() {
    let mut glb = Glb::triangle();
    glb.animate(NODE("translation"), &[0.0, 1.0], &[1.0, 1.0, 1.0, f32::NAN, 0.0, 0.0], "VEC3", "LINEAR");
    let huge = glb.raw_accessor(&[0; 4], 5126, "SCALAR", 1);
    glb.json["accessors"][huge]["count"] = json!(4_000_000_000u64);
    glb.json["accessors"][huge].as_object_mut().unwrap().remove("bufferView");
    let one = glb.accessor(&[0.0], "SCALAR");
    let scale = glb.accessor(&[2.0, 2.0, 2.0], "VEC3");
    let animation = &mut glb.json["animations"][0];
    let samplers = animation["samplers"].as_array_mut().unwrap();
    samplers.push(json!({"input": one, "output": scale}));
    samplers.push(json!({"input": huge, "output": scale}));
    samplers.push(json!({"input": 77, "output": scale}));
    samplers.push(json!({"input": one, "output": scale, "interpolation": "WOBBLY"}));
    let channels = animation["channels"].as_array_mut().unwrap();
    for sampler in 1..6 {
        channels.push(json!({"sampler": sampler, "target": {"node": 0, "path": "scale"}}));
    }
    channels.push(json!({"sampler": 1, "target": {"node": 99, "path": "scale"}}));
    channels.push(json!({"sampler": 1, "target": {"node": 0, "path": "rotation"}}));
    let pointer =
        |to: &str| json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": to}}});
    channels.push(json!({"sampler": 1, "target": pointer("/accessors/0/count")}));
    channels.push(json!({"sampler": 1, "target": pointer("")}));
    let posed = at(&glb, 1.0);
    assert_eq!(posed.scene.positions[1], DVec3::X * 2.0, "{:?}", posed.scene.warnings);
    assert!(posed.scene.warnings.iter().any(|warning| warning.contains("is not finite at 1 s")));

    // So many weights do not fit.
    let weights = json!({"input": one, "output": huge});
    glb.json["animations"] =
        json!([{"samplers": [weights], "channels": [{"sampler": 0, "target": NODE("weights")}]}]);
    let opened = opened(&glb).unwrap();
    let error = opened.scene.pose_at(&AnimationTime::default(), &Unwatched).unwrap_err().to_string();
    assert!(
        error.contains("moving.glb") && error.contains("limit") || error.contains("too many steps"),
        "{error}"
    );
    let moment = AnimationTime { animation: Some("Gallop".into()), seconds: 0.0 };
    let error = opened.scene.pose_at(&moment, &Unwatched).unwrap_err().to_string();
    assert!(error.contains("no animation is called \"Gallop\"") && error.contains("animation 0"), "{error}");
}

#[test]
fn sample_files_move_on_their_own_surface() {
    let Some(folder) = data::folder("gltf") else { return };
    for (file, animation, seconds) in
        [("Fox.glb", Some("Run"), 1.1583333), ("MorphStressTest/MorphStressTest.gltf", Some("TheWave"), 0.0)]
    {
        let rest = Arc::new(load(&folder.join(file), &LoadOptions::default(), &Unwatched).unwrap());
        let moving = AnimatedScene::open(rest.clone(), &LoadOptions::default(), &Unwatched).unwrap();
        let names: Vec<_> = moving.animations().iter().map(|animation| animation.name.as_str()).collect();
        assert!(names.contains(&animation.unwrap()), "{names:?}");
        let end = moving.animations().iter().find(|a| Some(a.name.as_str()) == animation).unwrap().seconds;
        assert!(end > 0.1 && (seconds == 0.0 || (end - seconds).abs() < 1e-3), "{end}");
        let moment = |seconds| AnimationTime { animation: animation.map(String::from), seconds };
        let posed = |seconds| moving.pose_at(&moment(seconds), &Unwatched).unwrap();
        let (early, late) = (posed(end * 0.25), posed(end * 0.6));
        assert!(early.matches_rest() && late.matches_rest());
        assert_eq!(early.scene.triangles, rest.triangles);
        assert_ne!(early.scene.positions, late.scene.positions);
        let size = |scene: &scene::Scene| (scene.bounds().1 - scene.bounds().0).length();
        assert!(size(&late.scene) < 2.0 * size(&rest) && size(&late.scene) > 0.5 * size(&rest));
        assert_eq!(early.scene.positions, posed(end * 0.25).scene.positions);
        assert!(Path::new(&early.scene.path).ends_with(file));
    }
}
