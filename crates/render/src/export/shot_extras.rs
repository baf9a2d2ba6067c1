//! Writing the shot camera's lens to a glTF document: what glTF cannot express goes to the camera's `extras` under our key.
//!
//! The lens is written to the scene camera with the same pose and angle of view as the shot camera. If there is none, a camera is added;
//! all others are unchanged.

use lens::{ApertureShape, Camera};
use project::camera_to_json;
use scene::{EXTRAS_KEY, EXTRAS_VERSION, Scene, SceneCamera};
use serde_json::{Map, Value, json};

/// Name of an added camera.
const CAMERA_NAME: &str = "Focus Brush shot";

/// Keys of a camera file that glTF can express itself.
const GLTF_KEYS: [&str; 3] = ["yfov", "camera_to_world", "background"];

/// Writes the lens of `shot` into `root`, the glTF document of `scene`, as extras of its camera.
pub fn write_lens_extras(root: &mut Map<String, Value>, scene: &Scene, shot: &Camera) {
    let own = scene.cameras.iter().find(|camera| is_at(camera, shot)).and_then(|camera| camera.index);
    let index = own.map_or_else(|| add_camera(root, shot), |index| index as usize);
    let camera =
        root.get_mut("cameras").and_then(|cameras| cameras.get_mut(index)).and_then(Value::as_object_mut);
    let Some(camera) = camera else { return };
    let extras = camera.entry("extras").or_insert_with(|| json!({}));
    // Extras may be any JSON value; only objects can have a key.
    if let Some(extras) = extras.as_object_mut() {
        extras.insert(EXTRAS_KEY.into(), lens_json(shot));
    }
}

/// Whether a scene camera has the view of the shot camera, up to the precision of 32-bit floats.
fn is_at(camera: &SceneCamera, shot: &Camera) -> bool {
    let scale = 1.0 + shot.position().length();
    camera.camera_to_world.abs_diff_eq(shot.camera_to_world, 1e-6 * scale)
        && (camera.yfov - shot.yfov).abs() < 1e-6
}

fn lens_json(shot: &Camera) -> Value {
    let mut lens = camera_to_json(shot);
    if let Some(lens) = lens.as_object_mut() {
        GLTF_KEYS.iter().for_each(|name| drop(lens.remove(*name)));
        // A mask's path is relative to its own file, so it cannot be written to another.
        if matches!(shot.aperture.shape, ApertureShape::Mask(_)) {
            lens.remove("aperture");
        }
        lens.insert("version".into(), EXTRAS_VERSION.into());
    }
    lens
}

/// Adds a camera with its own node. Returns the camera's index.
fn add_camera(root: &mut Map<String, Value>, shot: &Camera) -> usize {
    let camera = json!({
        "name": CAMERA_NAME,
        "type": "perspective",
        "perspective": {"yfov": shot.yfov, "aspectRatio": shot.aspect(), "znear": 0.01},
    });
    let mut push = |list: &str, entry: Value| {
        let list = root.entry(list).or_insert_with(|| json!([])).as_array_mut()?;
        list.push(entry);
        Some(list.len() - 1)
    };
    let index = push("cameras", camera).unwrap_or(usize::MAX);
    let node = json!({"name": CAMERA_NAME, "camera": index, "matrix": shot.camera_to_world.to_cols_array()});
    let node = push("nodes", node);
    let scene = root.get("scene").and_then(Value::as_u64).unwrap_or(0) as usize;
    let scene =
        root.get_mut("scenes").and_then(|scenes| scenes.get_mut(scene)).and_then(Value::as_object_mut);
    if let (Some(scene), Some(node)) = (scene, node)
        && let Some(nodes) = scene.entry("nodes").or_insert_with(|| json!([])).as_array_mut()
    {
        nodes.push(json!(node));
    }
    index
}
