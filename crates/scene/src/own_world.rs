//! Which world a scene has that nobody gave one.

use crate::{Material, Scene, World};
use glam::Vec3;

impl World {
    /// The world of a scene: the one that was chosen for it; else that of its file; else `background` everywhere, if that was
    /// chosen; else the studio, if nothing in the scene shines; else darkness.
    pub fn from_scene(scene: &Scene, background: Option<Vec3>) -> Self {
        if let Some(world) = scene.world.as_ref().or(scene.embedded_world.as_ref()) {
            return world.clone();
        }
        match background {
            Some(radiance) => Self::uniform(radiance),
            None if scene.has_light_sources() => Self::uniform(Vec3::ZERO),
            None => Self::studio(),
        }
    }
}

impl Scene {
    /// Whether anything in it sends light: a light or a surface.
    pub fn has_light_sources(&self) -> bool {
        !self.lights.is_empty() || self.has_emissive_materials()
    }

    /// Whether a surface sends light: one that is unlit, or emissive. A texture of emission up to 1 is a screen or a glow, not
    /// what a scene is lit by.
    pub(crate) fn has_emissive_materials(&self) -> bool {
        let is_emitter = |material: &Material| {
            let is_weak_texture =
                material.emissive_texture.is_some() && material.emissive.max_element() <= 1.0;
            material.unlit || (material.emissive != Vec3::ZERO && !is_weak_texture)
        };
        self.parts.iter().any(|part| is_emitter(&self.materials[part.material as usize]))
    }
}
