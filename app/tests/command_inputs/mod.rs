//! Files that commands read, for the scene of `tiny_glb`.

/// A camera.
pub const CAMERA: &str =
    r#"{"width": 64, "height": 40, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1}"#;
/// Focus by node and material.
pub const RECIPE: &str = r#"{"background": {"t": 0.9, "anchor": 0.5},
    "nodes": {"card": {"t": 1.2, "anchor": 1}}, "materials": {"wall paint": {"t": 0.8, "anchor": 0.5}}}"#;
/// One recorded fill.
pub const STROKES: &str = r#"{"format": "focus-brush strokes", "version": 3, "steps": [
    {"fill": {"layer": "Paint", "targets": [{"node": 1}], "focus": {"t": 1.1, "anchor": 0.5}}}]}"#;
