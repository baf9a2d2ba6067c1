//! The world of a scene for which none was chosen.

use crate::{Material, Scene, World};
use glam::Vec3;

impl World {
    /// The world of a scene: the chosen one; else the one embedded in its file; else `background` everywhere, if
    /// given; else the studio, if nothing in the scene emits light; else darkness.
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
    /// Whether it contains a light source: a light or an emissive surface.
    pub fn has_light_sources(&self) -> bool {
        !self.lights.is_empty() || self.has_emissive_materials()
    }

    /// Whether no surface reflects light: all bring their own colours.
    pub fn is_unlit(&self) -> bool {
        self.parts.iter().all(|part| self.materials[part.material as usize].unlit)
    }

    /// Whether all its light comes from the world: nothing in it emits any, not even a weak glow, or brings its own colours.
    pub fn is_lit_by_world_alone(&self) -> bool {
        let emits = |material: &Material| material.unlit || material.emissive != Vec3::ZERO;
        let is_dark = !self.parts.iter().any(|part| emits(&self.materials[part.material as usize]));
        let is_photographed = self.picture.is_some() || !self.views.is_empty();
        is_dark && self.lights.is_empty() && self.splats.is_none() && !is_photographed
    }

    /// Whether a surface emits light: unlit, or emissive. A texture of emission up to 1 is a screen or a glow, not a
    /// light source for the scene.
    pub(crate) fn has_emissive_materials(&self) -> bool {
        let is_emitter = |material: &Material| {
            let is_weak_texture =
                material.emissive_texture.is_some() && material.emissive.max_element() <= 1.0;
            material.unlit || (material.emissive != Vec3::ZERO && !is_weak_texture)
        };
        self.parts.iter().any(|part| is_emitter(&self.materials[part.material as usize]))
    }
}
