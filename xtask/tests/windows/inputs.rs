//! Small files of every kind that the program opens.

use crate::command_inputs::{CAMERA, RECIPE, STROKES};
use crate::{card_light_field, tiny_glb, wall_capture};
use std::path::Path;

/// Writes all of them into a new folder.
pub fn write(folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    tiny_glb::write(&folder.join("scene.glb"));
    std::fs::write(folder.join("metal.glb"), tiny_glb::metal(&tiny_glb::QUADS)).unwrap();
    put("camera.json", CAMERA);
    put("recipe.json", RECIPE);
    put("strokes.json", STROKES);
    gltf(&folder.join("folder"));
    wall_capture::write(&folder.join("photos"));
    card_light_field::write(&folder.join("views"));
    card_light_field::view([0.0; 2]).save(folder.join("cat.png")).unwrap();
    card_light_field::write_depth(&folder.join("cat_depth.png"));
    splats(&folder.join("splats.ply"));
    std::fs::create_dir_all(folder.join("demo")).unwrap();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/demo");
    for entry in std::fs::read_dir(demo).unwrap().flatten() {
        std::fs::copy(entry.path(), folder.join("demo").join(entry.file_name())).unwrap();
    }
}

/// The scene as a `.gltf` whose buffer lies in another folder, named as programs on Windows do.
fn gltf(folder: &Path) {
    let (mut document, buffer) = tiny_glb::parts(&tiny_glb::glb(&tiny_glb::QUADS));
    std::fs::create_dir_all(folder.join("buffers")).unwrap();
    std::fs::write(folder.join("buffers/all.bin"), buffer).unwrap();
    document["buffers"][0]["uri"] = "buffers\\all.bin".into();
    std::fs::write(folder.join("scene.gltf"), document.to_string()).unwrap();
}

/// A hundred splats on a sphere before the camera.
fn splats(file: &Path) {
    const PROPERTIES: [&str; 14] = [
        "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0",
        "rot_1", "rot_2", "rot_3",
    ];
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 100\n".to_vec();
    PROPERTIES.iter().for_each(|name| bytes.extend(format!("property float {name}\n").bytes()));
    bytes.extend(b"end_header\n");
    for k in 0..100u8 {
        let turn = f32::from(k) * 2.4;
        let height = f32::from(k) / 50.0 - 1.0;
        let radius = (1.0 - height * height).max(0.0).sqrt();
        let place = [0.6 * radius * turn.cos(), 0.6 * height, -2.5 + 0.6 * radius * turn.sin()];
        let color = [turn.sin(), height, 0.5];
        let rest = [2.0, -2.5, -2.0, -3.0, 1.0, 0.1, 0.2, 0.3];
        place.iter().chain(&color).chain(&rest).for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    std::fs::write(file, bytes).unwrap();
}
