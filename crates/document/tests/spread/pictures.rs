//! Pictures of what was painted and spread, for a person to look at: in the folder `$SPREAD_PICTURES`, if it is set.

use crate::scene::TestScene;
use document::SurfaceHit;
use glam::Vec3;
use numerics::srgb_from_linear;
use serde_json::Value;
use std::path::PathBuf;

/// Writes colour, strokes, mask and result of a scene as PPM and PGM files.
pub fn write(
    scene: &TestScene,
    strokes: &Value,
    truth: &[Option<bool>],
    hits: &[Option<SurfaceHit>],
    spread: Option<&[bool]>,
    number: usize,
) {
    let Some(folder) = std::env::var_os("SPREAD_PICTURES").map(PathBuf::from) else { return };
    let [width, height] = scene.size;
    let save = |name: &str, kind: &str, bytes: Vec<u8>| {
        let header = format!("{kind}\n{width} {height}\n255\n");
        let path = folder.join(format!("{number}-{name}"));
        std::fs::write(path, [header.as_bytes(), &bytes].concat()).unwrap();
    };
    if let Some(spread) = spread {
        save("spread.pgm", "P5", spread.iter().map(|inside| u8::from(*inside) * 255).collect());
        return;
    }
    let light = scene.document.stage.lit.photograph_light(&progress::Unwatched).unwrap();
    let color = |hit: &Option<SurfaceHit>| {
        let color = hit.as_ref().map_or(Vec3::ZERO, |hit| match &light {
            Some(light) => light.constant(hit.point),
            None => scene.document.scene().base_color(hit.point).truncate(),
        });
        color.to_array().map(|x| (srgb_from_linear(x.clamp(0.0, 1.0)) * 255.0).round() as u8)
    };
    save("color.ppm", "P6", hits.iter().flat_map(color).collect());
    let truth = truth.iter().map(|inside| inside.map_or(0, |inside| u8::from(inside) * 255));
    save("truth.pgm", "P5", truth.collect());
    let painted = |hit: &Option<SurfaceHit>| match hit.as_ref().map(|hit| scene.layer_at(hit)) {
        Some([_, mask]) if mask < 0.5 => 128,
        Some([t, _]) if strokes["strokes"].is_array() && t == 1.0 => {
            let hit = hit.as_ref().map(|hit| anchor_at(scene, hit));
            if hit == Some(1.0) { 255 } else { 0 }
        }
        _ => 128,
    };
    save("strokes.pgm", "P5", hits.iter().map(painted).collect());
}

fn anchor_at(scene: &TestScene, hit: &SurfaceHit) -> f32 {
    let map = &scene.document.layers.active().map;
    let place = scene.document.stage.atlas.position_of(hit.point);
    map.texel((place.x as u32).min(map.width() - 1), (place.y as u32).min(map.height() - 1))[1]
}
