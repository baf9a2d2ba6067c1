//! Pictures of what was painted and spread, for a person to look at: in the folder `$SPREAD_PICTURES`, if it is set.

use crate::scene::TestScene;
use document::SurfaceHit;
use glam::Vec3;
use numerics::srgb_from_linear;
use std::path::PathBuf;

/// Writes a grey picture, one value for each pixel, as PGM.
pub fn write_grey(scene: &TestScene, name: &str, values: impl Iterator<Item = u8>) {
    save(scene, &format!("{name}.pgm"), "P5", values.collect());
}

/// Writes the colours of a scene's surfaces as PPM.
pub fn write_colors(scene: &TestScene, name: &str, hits: &[Option<SurfaceHit>]) {
    let light = scene.document.stage.lit.photograph_light(&progress::Unwatched).unwrap();
    let color = |hit: &Option<SurfaceHit>| {
        let color = hit.as_ref().map_or(Vec3::ZERO, |hit| match &light {
            Some(light) => light.constant(hit.point),
            None => scene.document.scene().base_color(hit.point).truncate(),
        });
        color.to_array().map(|x| (srgb_from_linear(x.clamp(0.0, 1.0)) * 255.0).round() as u8)
    };
    save(scene, &format!("{name}.ppm"), "P6", hits.iter().flat_map(color).collect());
}

/// Writes the active layer's t where it is painted, 100 times, and 0 elsewhere; t is at most 2.5. The value that keeps
/// out, (1, 0), is 50.
pub fn write_layer(scene: &TestScene, name: &str, hits: &[Option<SurfaceHit>]) {
    let value = |hit: &Option<SurfaceHit>| {
        let [t, anchor, mask] = hit.as_ref().map_or([0.0; 3], |hit| scene.layer_at(hit));
        match mask >= 0.5 {
            false => 0,
            true if (t, anchor) == (1.0, 0.0) => 50,
            true => (100.0 * t) as u8,
        }
    };
    write_grey(scene, name, hits.iter().map(value));
}

fn save(scene: &TestScene, name: &str, kind: &str, bytes: Vec<u8>) {
    let Some(folder) = std::env::var_os("SPREAD_PICTURES").map(PathBuf::from) else { return };
    let [width, height] = scene.size;
    let header = format!("{kind}\n{width} {height}\n255\n");
    std::fs::write(folder.join(name), [header.as_bytes(), &bytes].concat()).unwrap();
}
