//! KHR_node_visibility: what is hidden is not there, but for cameras and the places of joints.

mod handmade;

use glam::DVec3;
use handmade::Glb;
use serde_json::{Value, json};

const HIDDEN: &str = "KHR_node_visibility";

fn visible(value: Value) -> Value {
    json!({ HIDDEN: { "visible": value } })
}

/// A triangle at x = 0, and another node with the rest below it.
fn two_nodes(other: Value) -> Glb {
    let mut glb = Glb::triangle();
    glb.json["nodes"].as_array_mut().unwrap().push(other);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    glb.json["extensionsUsed"] = json!([HIDDEN]);
    glb
}

#[test]
fn hidden_nodes_are_not_there_nor_what_hangs_on_them() {
    let mut glb = two_nodes(json!({"children": [2], "extensions": visible(json!(false))}));
    let nodes = glb.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"mesh": 0, "children": [3], "extensions": visible(json!(true))}));
    nodes.push(json!({"mesh": 0}));
    for required in [false, true] {
        if required {
            glb.json["extensionsRequired"] = json!([HIDDEN]);
        }
        let scene = glb.clean();
        assert_eq!((scene.triangles.len(), scene.nodes.len()), (1, 1));
    }
    // The control: shown, all three are there.
    for shown in [visible(json!(true)), json!({HIDDEN: {}}), json!({})] {
        glb.json["nodes"][1]["extensions"] = shown;
        assert_eq!(glb.clean().triangles.len(), 3);
    }
}

#[test]
fn hidden_lights_are_off_and_hidden_cameras_stay() {
    let mut glb = two_nodes(json!({
        "translation": [0, 0, 5], "camera": 0,
        "extensions": {HIDDEN: {"visible": false}, "KHR_lights_punctual": {"light": 0}}
    }));
    glb.json["extensionsUsed"] = json!([HIDDEN, "KHR_lights_punctual"]);
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    glb.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    let scene = glb.clean();
    assert!(!scene.has_light_sources() && !scene.has_default_camera);
    assert_eq!(scene.cameras[0].camera_to_world.w_axis.truncate(), DVec3::new(0.0, 0.0, 5.0));
    glb.json["nodes"][1]["extensions"][HIDDEN]["visible"] = json!(true);
    assert!(glb.clean().has_light_sources());
}

#[test]
fn hidden_joints_carry_their_mesh() {
    let mut glb = two_nodes(json!({"translation": [7, 0, 0], "extensions": visible(json!(false))}));
    let joints = glb.raw_accessor(&[0; 12], 5121, "VEC4", 3);
    let weights = glb.accessor(&[1.0, 0.0, 0.0, 0.0].repeat(3), "VEC4");
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.json["skins"] = json!([{"joints": [1]}]);
    glb.json["nodes"][0]["skin"] = json!(0);
    assert_eq!(glb.clean().corners(0)[0], DVec3::new(7.0, 0.0, 0.0));
}

#[test]
fn a_file_of_hidden_meshes_reports_that() {
    let mut glb = Glb::triangle();
    glb.json["nodes"][0]["extensions"] = visible(json!(false));
    assert!(glb.error().contains("no triangle: 1 of its nodes are hidden"), "{}", glb.error());
}

#[test]
fn nonsense_hides_nothing() {
    for value in [json!("false"), json!(0), json!(null), json!([])] {
        let mut glb = two_nodes(json!({"mesh": 0, "extensions": visible(value.clone())}));
        let scene = glb.load().unwrap();
        assert_eq!(scene.triangles.len(), 2, "{value}");
        assert!(
            scene.warnings.iter().any(|w| w.contains("/nodes/1/extensions/KHR_node_visibility")),
            "{value}"
        );
        glb.json["nodes"][1]["extensions"][HIDDEN] = value.clone();
        assert_eq!(glb.load().unwrap().triangles.len(), 2, "{value}");
    }
}
