//! A checksum of a scene's light: two scenes of the same one are lit, block and reflect light alike.

use scene::{Environment, ImageLevel, Scene};
use sha2::{Digest, Sha256};

/// A checksum of everything in a scene that gives, blocks or reflects light.
pub(crate) fn light_hash(scene: &Scene) -> [u8; 32] {
    let mut hash = Sha256::new();
    let mut arrays = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    arrays(bytemuck::cast_slice(&scene.positions));
    arrays(bytemuck::cast_slice(&scene.normals));
    scene.uv.iter().chain(&scene.further_uv).for_each(|uv| arrays(bytemuck::cast_slice(uv)));
    arrays(bytemuck::cast_slice(&scene.colors));
    arrays(bytemuck::cast_slice(&scene.tangents));
    for triangle in &scene.triangles {
        arrays(bytemuck::cast_slice(&triangle.vertices));
    }
    for image in &scene.images {
        arrays(format!("{} {}", image.width, image.height).as_bytes());
        match &image.texels {
            ImageLevel::Bits8(texels) => arrays(texels),
            ImageLevel::Bits16(texels) => arrays(bytemuck::cast_slice(texels)),
        }
    }
    for world in scene.own_world.iter().chain(&scene.world) {
        let Environment::Map(map) = &world.environment else { continue };
        arrays(format!("{} {}", map.width, map.height).as_bytes());
        arrays(bytemuck::cast_slice(&map.texels));
    }
    for view in &scene.views {
        // A picture is taken for the same where file, size and time of change are.
        let of_file = std::fs::metadata(&view.picture).map(|data| (data.len(), data.modified().ok())).ok();
        arrays(format!("{view:?} {of_file:?}").as_bytes());
    }
    // Written out, numbers are as exact as they are.
    arrays(
        format!(
            "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
            scene.parts,
            scene.materials,
            scene.lights,
            scene.back_faces,
            scene.own_world,
            scene.world,
            scene.single_scattering
        )
        .as_bytes(),
    );
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_in_another_light_is_another() {
        let mut scene = Scene::default();
        let dark = light_hash(&scene);
        assert_eq!(light_hash(&scene.clone()), dark);
        scene.path = "elsewhere.glb".into();
        assert_eq!(light_hash(&scene), dark, "wherever it lies");
        scene.positions.push(glam::DVec3::X);
        let moved = light_hash(&scene);
        assert_ne!(moved, dark);
        // Arrays do not run into each other.
        let uv = Scene { uv: [vec![glam::Vec2::ONE], Vec::new()], ..Scene::default() };
        let other = Scene { uv: [Vec::new(), vec![glam::Vec2::ONE]], ..Scene::default() };
        assert_ne!(light_hash(&uv), light_hash(&other));
        let brings = |light: f32| {
            let map = scene::EnvironmentMap {
                name: "light".into(),
                width: 2,
                height: 1,
                texels: vec![[light; 3]; 2],
            };
            let environment = Environment::Map(std::sync::Arc::new(map));
            let own = scene::World { environment, ..scene::World::studio() };
            light_hash(&Scene { own_world: Some(own), ..Scene::default() })
        };
        assert!(brings(1.0) != dark && brings(1.0) != brings(2.0));
        // Materials that are seen in another variant.
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("varied.glb");
        std::fs::write(&file, crate::tiny_glb::varied(&crate::tiny_glb::QUADS)).unwrap();
        let of = |variant: Option<&str>| {
            light_hash(&super::super::stage::load_variant(&file, variant, &progress::Unwatched).unwrap())
        };
        assert!(of(None) != of(Some("Blue")) && of(Some("Blue")) != of(Some("Green")));
        assert_eq!(of(None), of(Some("As painted")), "what looks alike has the same light");
        let further = |u: f32| Scene { further_uv: vec![vec![glam::Vec2::splat(u)]], ..Scene::default() };
        assert_ne!(light_hash(&further(0.0)), light_hash(&further(1.0)));
    }
}
