//! SHA-256 fingerprints of inputs: stored measurements of changed inputs are not reused.

use focus::{Focus, FocusSource};
use lens::{ApertureShape, Camera};
use light::LightOptions;
use scene::{Environment, ImageLevel, Scene};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Accumulates values into a single fingerprint.
pub struct Fingerprint(Sha256);

impl Fingerprint {
    /// An empty fingerprint.
    pub fn new() -> Self {
        Self(Sha256::new())
    }

    /// Adds bytes, preceded by their number, so that the boundaries between values count.
    pub fn add(mut self, bytes: &[u8]) -> Self {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    /// Adds a value, in its debug form, to what is fingerprinted.
    pub fn add_debug(self, value: &dyn std::fmt::Debug) -> Self {
        self.add(format!("{value:?}").as_bytes())
    }

    /// The fingerprint as 24 hexadecimal digits (96 bits).
    pub fn hex_name(self) -> String {
        hex::encode(&self.0.finalize()[..12])
    }
}

/// Fingerprint of the contents of a scene, independent of file locations.
pub fn scene_fingerprint(scene: &Scene, light: LightOptions) -> String {
    let numbers = |values: &[u32]| bytemuck::cast_slice::<u32, u8>(values).to_vec();
    let triangles: Vec<u32> =
        scene.triangles.iter().flat_map(|t| [&t.vertices[..], &[t.part]].concat()).collect();
    let mut fingerprint = Fingerprint::new()
        .add(bytemuck::cast_slice(&scene.positions))
        .add(bytemuck::cast_slice(&scene.normals))
        .add(bytemuck::cast_slice(&scene.uv[0]))
        .add(bytemuck::cast_slice(&scene.uv[1]))
        .add(bytemuck::cast_slice(&scene.colors))
        .add(&numbers(&triangles))
        .add_debug(&scene.parts)
        .add_debug(&scene.nodes)
        .add_debug(&scene.materials)
        .add_debug(&scene.lights)
        .add_debug(&scene.back_faces)
        .add_debug(&scene.embedded_world)
        .add_debug(&scene.world)
        .add_debug(&light)
        .add(bytemuck::cast_slice(&scene.tangents));
    for world in scene.embedded_world.iter().chain(&scene.world) {
        if let Environment::Map(map) = &world.environment {
            fingerprint = fingerprint.add(bytemuck::cast_slice(&map.texels));
        }
    }
    for uv in &scene.further_uv {
        fingerprint = fingerprint.add(bytemuck::cast_slice(uv));
    }
    for image in &scene.images {
        let texels = match &image.texels {
            ImageLevel::Bits8(texels) => texels.as_slice(),
            ImageLevel::Bits16(texels) => bytemuck::cast_slice(texels),
            ImageLevel::Float(texels) => bytemuck::cast_slice(texels),
        };
        fingerprint = fingerprint.add_debug(&[image.width, image.height]).add(texels);
    }
    fingerprint.hex_name()
}

/// Fingerprint of a camera with its lens, aperture mask and picture size.
pub fn camera_fingerprint(camera: &Camera) -> String {
    let fingerprint = Fingerprint::new();
    match &camera.aperture.shape {
        // A mask may have millions of texels, which are added as bytes instead of text.
        ApertureShape::Mask(mask) => {
            let aperture = lens::Aperture { shape: ApertureShape::Disc, ..camera.aperture.clone() };
            let rest = Camera { aperture, ..camera.clone() };
            fingerprint
                .add_debug(&rest)
                .add_debug(&[mask.width, mask.height])
                .add(bytemuck::cast_slice(&mask.transmission))
        }
        _ => fingerprint.add_debug(camera),
    }
    .hex_name()
}

/// Fingerprint of a focus. It refers to parts by index, so it is meaningful only together with the scene's.
pub fn focus_fingerprint(focus: &Focus) -> String {
    let mut fingerprint = Fingerprint::new().add_debug(&focus.background);
    // Painted parts share one map, or the values of triangles, which are added once.
    let (mut last_map, mut last_values) = (None, None);
    for part in &focus.parts {
        fingerprint = match part {
            FocusSource::Constant(value) => fingerprint.add_debug(value),
            FocusSource::Triangles(values) if last_values == Some(values.as_ptr()) => fingerprint,
            FocusSource::Triangles(values) => {
                last_values = Some(values.as_ptr());
                fingerprint.add_debug(values)
            }
            FocusSource::Uv { image, wrap } => fingerprint
                .add_debug(wrap)
                .add_debug(&[image.width, image.height])
                .add(bytemuck::cast_slice(&image.texels)),
            FocusSource::Atlas { atlas, map } if last_map == Some(Arc::as_ptr(map)) => {
                fingerprint.add(atlas.hash.as_bytes())
            }
            FocusSource::Atlas { atlas, map } => {
                last_map = Some(Arc::as_ptr(map));
                fingerprint.add(atlas.hash.as_bytes()).add(bytemuck::cast_slice(&map.to_rows()))
            }
        };
    }
    fingerprint.hex_name()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::{ApertureMask, FocusOffset};

    #[test]
    fn any_change_of_a_scene_shows() {
        let scene = Scene { positions: vec![glam::DVec3::ONE; 3], ..Scene::default() };
        let moved = Scene { positions: vec![glam::DVec3::splat(1.0 + 1e-15); 3], ..scene.clone() };
        let elsewhere = Scene { path: "other.glb".into(), ..scene.clone() };
        let print = |scene: &Scene| scene_fingerprint(scene, LightOptions::default());
        assert_ne!(print(&scene), print(&moved));
        assert_eq!(print(&scene), print(&elsewhere), "where it lies does not matter");
    }

    #[test]
    fn any_change_of_a_camera_shows() {
        let camera = Camera::default();
        assert_ne!(camera_fingerprint(&camera), camera_fingerprint(&Camera { width: 961, ..camera.clone() }));
        let masked = |value: f32| {
            let mask =
                ApertureMask { width: 2, height: 1, transmission: vec![value, 1.0], file: String::new() };
            let shape = ApertureShape::Mask(Arc::new(mask));
            Camera { aperture: lens::Aperture { shape, ..Default::default() }, ..Camera::default() }
        };
        assert_ne!(camera_fingerprint(&masked(0.0)), camera_fingerprint(&masked(1.0)));
        assert_eq!(camera_fingerprint(&masked(1.0)), camera_fingerprint(&masked(1.0)));
    }

    #[test]
    fn any_change_of_a_focus_shows() {
        let scene = Arc::new(Scene::default());
        let standard = Focus::constant(scene.clone(), FocusOffset::STANDARD);
        let painted = Focus::constant(scene, FocusOffset::new(1.0, 1.0));
        assert_ne!(focus_fingerprint(&standard), focus_fingerprint(&painted));
        let by_triangle = |ts: [f64; 2]| {
            let values = ts.map(|t| FocusOffset::new(t, 0.5)).into_iter().collect();
            Focus { parts: vec![FocusSource::Triangles(values); 2], ..standard.clone() }
        };
        assert_eq!(focus_fingerprint(&by_triangle([1.0, 2.0])), focus_fingerprint(&by_triangle([1.0, 2.0])));
        assert_ne!(focus_fingerprint(&by_triangle([1.0, 2.0])), focus_fingerprint(&by_triangle([2.0, 1.0])));
    }

    #[test]
    fn what_is_taken_up_keeps_its_bounds() {
        let name = |a: &str, b: &str| Fingerprint::new().add(a.as_bytes()).add(b.as_bytes()).hex_name();
        assert_ne!(name("ab", "c"), name("a", "bc"));
        assert_eq!(name("ab", "c").len(), 24);
    }
}
