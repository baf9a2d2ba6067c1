//! Camera files of the program, for figures.

use glam::DMat4;
use lens::Camera;
use serde_json::Value;
use std::path::Path;

pub fn read_json(file: &Path) -> Value {
    let text = std::fs::read(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    serde_json::from_slice(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

pub fn read_camera(file: &Path) -> Camera {
    let json = read_json(file);
    let pose = &json["camera_to_world"];
    let rows: Vec<f64> = (0..16).map(|k| number(&pose[k / 4][k % 4])).collect();
    Camera {
        width: number(&json["width"]) as u32,
        height: number(&json["height"]) as u32,
        yfov: number(&json["yfov"]),
        focus_distance: json["focus_distance"].as_f64().unwrap_or(f64::INFINITY),
        aperture_radius: number(&json["aperture_radius"]),
        sensor_height: number(&json["sensor_height"]),
        camera_to_world: DMat4::from_cols_slice(&rows).transpose(),
        background: Some([0, 1, 2].map(|k| number(&json["background"][k]))),
        ..Camera::default()
    }
}
