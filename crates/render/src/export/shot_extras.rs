//! The shot camera's lens in a glTF document: what glTF cannot carry stands in the camera's `extras` under our key.
//!
//! It goes to the camera of the scene that stands where the shot camera stands and sees as much; where none does, a camera of its own
//! joins the document, and all others stay as they were.

use lens::{ApertureShape, Camera};
use project::camera_to_json;
use scene::{EXTRAS_KEY, EXTRAS_VERSION, Scene, SceneCamera};
use serde_json::{Map, Value, json};

/// What a camera of its own is called.
const CAMERA_NAME: &str = "Focus Brush shot";

/// What of a camera file glTF has itself.
const GLTF_KEYS: [&str; 3] = ["yfov", "camera_to_world", "background"];

/// Tells the lens of `shot` in the document of `scene`.
pub fn write_lens_extras(root: &mut Map<String, Value>, scene: &Scene, shot: &Camera) {
    let own = scene.cameras.iter().find(|camera| is_at(camera, shot)).and_then(|camera| camera.index);
    let index = own.map_or_else(|| add_camera(root, shot), |index| index as usize);
    let camera =
        root.get_mut("cameras").and_then(|cameras| cameras.get_mut(index)).and_then(Value::as_object_mut);
    let Some(camera) = camera else { return };
    let extras = camera.entry("extras").or_insert_with(|| json!({}));
    // Extras may be anything; what is no object has no room for a key.
    if let Some(extras) = extras.as_object_mut() {
        extras.insert(EXTRAS_KEY.into(), lens_json(shot));
    }
}

/// Whether a camera of the scene shows what the shot camera shows, as far as 32 bits tell.
fn is_at(camera: &SceneCamera, shot: &Camera) -> bool {
    let scale = 1.0 + shot.position().length();
    camera.camera_to_world.abs_diff_eq(shot.camera_to_world, 1e-6 * scale)
        && (camera.yfov - shot.yfov).abs() < 1e-6
}

fn lens_json(shot: &Camera) -> Value {
    let mut lens = camera_to_json(shot);
    if let Some(lens) = lens.as_object_mut() {
        GLTF_KEYS.iter().for_each(|name| drop(lens.remove(*name)));
        // A picture's path means nothing beside another file.
        if matches!(shot.aperture.shape, ApertureShape::Mask(_)) {
            lens.remove("aperture");
        }
        lens.insert("version".into(), EXTRAS_VERSION.into());
    }
    lens
}

/// Adds a camera in a node of its own; gives its index.
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
