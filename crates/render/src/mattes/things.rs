//! Named things that a picture shows: objects or materials.

use scene::{Part, Scene};
use std::collections::HashMap;

/// The things of one kind.
pub(crate) struct Things {
    /// The kind's name in Cryptomatte.
    pub kind: &'static str,
    /// The kind's plural name in messages.
    pub plural_name: &'static str,
    /// Names of the things. Objects or materials of the same name are one thing, as in recipes.
    pub names: Vec<String>,
    of_part: Vec<u32>,
}

impl Things {
    /// The scene's nodes as things.
    pub fn objects(scene: &Scene) -> Self {
        Self::new("Object", "objects", scene, |part| &scene.nodes[part.node as usize].name)
    }

    /// The scene's materials as things.
    pub fn materials(scene: &Scene) -> Self {
        Self::new("Material", "materials", scene, |part| &scene.materials[part.material as usize].name)
    }

    fn new<'a>(
        kind: &'static str,
        plural_name: &'static str,
        scene: &'a Scene,
        name_of: impl Fn(&'a Part) -> &'a String,
    ) -> Self {
        let (mut indices, mut names) = (HashMap::new(), Vec::new());
        let of_part = scene.parts.iter().map(|part| {
            let name = name_of(part);
            *indices.entry(name.as_str()).or_insert_with(|| {
                names.push(name.clone());
                names.len() as u32 - 1
            })
        });
        let of_part = of_part.collect();
        Self { kind, plural_name, names, of_part }
    }

    /// The index of the thing that a part of the scene belongs to.
    pub fn of_part(&self, part: u32) -> u32 {
        self.of_part[part as usize]
    }
}
