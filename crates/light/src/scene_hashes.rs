//! SHA-256 checksums of parts of a scene: of the inputs of an atlas, of light from photographs, and of all light.

use crate::options::LightOptions;
use glam::Vec3;
use scene::{Environment, ImageLevel, Scene, View, World};
use sha2::{Digest, Sha256};
use slf::Scattering;
use std::path::Path;

/// A checksum of byte strings in which each is preceded by its length, so that moving bytes from one to the next changes it.
struct LengthPrefixedHash(Sha256);

impl LengthPrefixedHash {
    fn add(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn add_surface(&mut self, scene: &Scene) {
        self.add(bytemuck::cast_slice(&scene.positions));
        self.add(bytemuck::cast_slice(&scene.normals));
        scene.uv.iter().chain(&scene.further_uv).for_each(|uv| self.add(bytemuck::cast_slice(uv)));
        for triangle in &scene.triangles {
            self.add(bytemuck::cast_slice(&triangle.vertices));
        }
        self.add(format!("{:?}", scene.parts).as_bytes());
    }

    fn add_views(&mut self, views: &[View]) {
        // Pictures count as equal if their path, size and modification time are.
        let file_stamp = |path: &Path| {
            std::fs::metadata(path).map(|metadata| (metadata.len(), metadata.modified().ok())).ok()
        };
        for view in views {
            let mask = view.mask.as_deref().and_then(file_stamp);
            self.add(format!("{view:?} {:?} {mask:?}", file_stamp(&view.picture)).as_bytes());
        }
    }

    /// Adds views by the contents of their pictures, regardless of path and modification time.
    fn add_view_contents(&mut self, views: &[View]) {
        for view in views {
            let View { name, orientation, exif_orientation, lens, camera_to_world, exposure_hint, .. } = view;
            let description = format!(
                "{name:?} {orientation} {exif_orientation} {lens:?} {camera_to_world:?} {exposure_hint:?}"
            );
            self.add(description.as_bytes());
            for file in [Some(&view.picture), view.mask.as_ref()].into_iter().flatten() {
                // A file that cannot be read is an error later, when the light is solved for.
                self.add(&std::fs::read(file).unwrap_or_default());
            }
        }
    }

    fn finish(self) -> [u8; 32] {
        self.0.finalize().into()
    }
}

/// A checksum of the triangles of a scene: their geometry and parts.
pub(crate) fn surface_hash(scene: &Scene) -> [u8; 32] {
    let mut hash = LengthPrefixedHash(Sha256::new());
    hash.add_surface(scene);
    hash.finish()
}

/// A checksum of the triangles of a scene and of the photographs that light it.
pub(crate) fn photographs_hash(scene: &Scene) -> [u8; 32] {
    let mut hash = LengthPrefixedHash(Sha256::new());
    hash.add_surface(scene);
    hash.add_views(&scene.views);
    hash.finish()
}

/// A checksum of everything in a scene that emits, blocks or reflects light, and of how light is modelled: scenes with equal checksums
/// have the same light.
pub fn light_hash(scene: &Scene, options: LightOptions) -> [u8; 32] {
    let mut hash = LengthPrefixedHash(Sha256::new());
    hash.add_lit_scene(scene, options);
    hash.add_views(&scene.views);
    hash.add(format!("{:?} {:?}", scene.embedded_world, scene.world).as_bytes());
    hash.finish()
}

/// Like [`light_hash`], but from file contents alone, regardless of paths and modification times: the same on every machine.
pub fn content_hash(scene: &Scene, options: LightOptions) -> [u8; 32] {
    let mut hash = LengthPrefixedHash(Sha256::new());
    hash.add_lit_scene(scene, options);
    hash.add_view_contents(&scene.views);
    for world in [&scene.embedded_world, &scene.world] {
        // The texels of a map are added already, and its name does not matter.
        let without_texels = world.clone().map(|world| match world.environment {
            Environment::Map(_) => World { environment: Environment::Uniform(Vec3::ZERO), ..world },
            Environment::Uniform(_) => world,
        });
        hash.add(format!("{without_texels:?}").as_bytes());
    }
    hash.finish()
}

impl LengthPrefixedHash {
    /// Adds everything except photographs and the settings of worlds.
    fn add_lit_scene(&mut self, scene: &Scene, options: LightOptions) {
        let hash = self;
        hash.add_surface(scene);
        hash.add(bytemuck::cast_slice(&scene.colors));
        hash.add(bytemuck::cast_slice(&scene.tangents));
        for image in &scene.images {
            hash.add(format!("{} {}", image.width, image.height).as_bytes());
            match &image.texels {
                ImageLevel::Bits8(texels) => hash.add(texels),
                ImageLevel::Bits16(texels) => hash.add(bytemuck::cast_slice(texels)),
                ImageLevel::Float(texels) => hash.add(bytemuck::cast_slice(texels)),
            }
        }
        for world in scene.embedded_world.iter().chain(&scene.world) {
            let Environment::Map(map) = &world.environment else { continue };
            hash.add(format!("{} {}", map.width, map.height).as_bytes());
            hash.add(bytemuck::cast_slice(&map.texels));
        }
        if let Some(gloss) = scene.picture.as_ref().and_then(|picture| picture.gloss.as_ref()) {
            hash.add(
                format!("{} {:?} {:?}", gloss.block_size, gloss.block_counts, gloss.aperture_half_extent)
                    .as_bytes(),
            );
            hash.add(bytemuck::cast_slice(&gloss.polynomial_of_block));
            hash.add(bytemuck::cast_slice(gloss.polynomials.as_flattened()));
        }
        if let Some(splats) = &scene.splats {
            hash.add(format!("{:?}", splats.placement).as_bytes());
            splats.cloud.each_byte_string(|bytes| hash.add(bytes));
        }
        hash.add(format!("{:?}", options.photo_lookup).as_bytes());
        // Debug formatting writes numbers exactly.
        let is_single = options.scattering == Scattering::Single;
        hash.add(
            format!("{:?} {:?} {:?} {is_single:?}", scene.materials, scene.lights, scene.back_faces)
                .as_bytes(),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::LoadOptions;

    fn light_hash(scene: &Scene) -> [u8; 32] {
        super::light_hash(scene, LightOptions::default())
    }

    fn content_hash(scene: &Scene) -> [u8; 32] {
        super::content_hash(scene, LightOptions::default())
    }

    #[test]
    fn the_light_hash_depends_on_everything_that_affects_light() {
        let mut scene = Scene::default();
        let dark = light_hash(&scene);
        assert_eq!(light_hash(&scene.clone()), dark);
        scene.path = "elsewhere.glb".into();
        assert_eq!(light_hash(&scene), dark, "the path does not matter");
        scene.positions.push(glam::DVec3::X);
        let moved = light_hash(&scene);
        assert_ne!(moved, dark);
        // Arrays do not run into each other.
        let uv = Scene { uv: [vec![glam::Vec2::ONE], Vec::new()], ..Scene::default() };
        let other = Scene { uv: [Vec::new(), vec![glam::Vec2::ONE]], ..Scene::default() };
        assert_ne!(light_hash(&uv), light_hash(&other));
        let hash_with_light = |light: f32| {
            let map = scene::EnvironmentMap {
                name: "light".into(),
                width: 2,
                height: 1,
                texels: vec![[light; 3]; 2],
            };
            let environment = Environment::Map(std::sync::Arc::new(map));
            let own = scene::World { environment, ..scene::World::studio() };
            light_hash(&Scene { embedded_world: Some(own), ..Scene::default() })
        };
        assert!(hash_with_light(1.0) != dark && hash_with_light(1.0) != hash_with_light(2.0));
        // Another variant has other materials.
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("varied.glb");
        std::fs::write(&file, crate::tiny_glb::varied(&crate::tiny_glb::QUADS)).unwrap();
        let hash_of_variant = |variant: Option<&str>| {
            let options = LoadOptions { variant: variant.map(String::from), ..LoadOptions::default() };
            light_hash(&scene::load(&file, &options, &progress::Unwatched).unwrap())
        };
        assert!(
            hash_of_variant(None) != hash_of_variant(Some("Blue"))
                && hash_of_variant(Some("Blue")) != hash_of_variant(Some("Green"))
        );
        assert_eq!(
            hash_of_variant(None),
            hash_of_variant(Some("As painted")),
            "the same appearance has the same light"
        );
        let single = LightOptions { scattering: Scattering::Single, ..LightOptions::default() };
        assert_ne!(super::light_hash(&Scene::default(), single), light_hash(&Scene::default()));
        let further = |u: f32| Scene { further_uv: vec![vec![glam::Vec2::splat(u)]], ..Scene::default() };
        assert_ne!(light_hash(&further(0.0)), light_hash(&further(1.0)));
    }

    #[test]
    fn the_photographs_hash_depends_on_files_and_cameras() {
        let folder = tempfile::tempdir().unwrap();
        let picture = folder.path().join("a.jpg");
        std::fs::write(&picture, "one").unwrap();
        let intrinsics =
            lens::Intrinsics { size_px: [4, 3], focal_px: [4.0; 2], principal_px: [2.0, 1.5], skew_px: 0.0 };
        let lens =
            lens::CalibratedLens::new(intrinsics, lens::Projection::Perspective, lens::Distortion::default());
        let view = View {
            name: "a.jpg".into(),
            picture: picture.clone(),
            orientation: 1,
            exif_orientation: 1,
            lens: lens.unwrap(),
            camera_to_world: glam::DMat4::IDENTITY,
            mask: None,
            exposure_hint: None,
        };
        let scene = Scene { views: vec![view], ..Scene::default() };
        let before = photographs_hash(&scene);
        assert_eq!(photographs_hash(&Scene { world: Some(scene::World::studio()), ..scene.clone() }), before);
        assert_ne!(photographs_hash(&Scene::default()), before);
        std::fs::write(&picture, "another").unwrap();
        assert_ne!(photographs_hash(&scene), before);
        assert_eq!(surface_hash(&scene), surface_hash(&Scene::default()));
        // For the content hash, only the file's contents count.
        let content = content_hash(&scene);
        let elsewhere = folder.path().join("copy.jpg");
        std::fs::copy(&picture, &elsewhere).unwrap();
        let mut copied = scene.clone();
        copied.views[0].picture = elsewhere;
        assert!(content_hash(&copied) == content && light_hash(&copied) != light_hash(&scene));
        std::fs::write(&picture, "changed").unwrap();
        assert_ne!(content_hash(&scene), content);
    }
}
