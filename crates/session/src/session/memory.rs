//! The memory that an open document takes, by part.

use super::Session;

/// Something that takes memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryPart {
    /// Its name.
    pub name: &'static str,
    /// What it is, a sentence.
    pub description: &'static str,
    /// Its memory, bytes.
    pub bytes: usize,
}

impl Session {
    /// The large parts of what the open document takes; empty without one. What is made for a while, such as the next light field beside the
    /// one shown, and what lies on a card are not counted.
    pub fn memory(&self) -> Vec<MemoryPart> {
        let Some(document) = &self.document else { return Vec::new() };
        let stage = &document.stage;
        let [fields, sums] = self.preview_thread.field_bytes();
        let pixels = self.preview.as_ref().map_or(0, |preview| {
            preview.camera.width as usize * preview.camera.height as usize * size_of::<[f32; 4]>()
        });
        let [undo, _] = document.undo_bytes();
        [
            ("Scene", "Geometry, images and environments.", stage.scene.bytes()),
            ("Rays", "The hierarchy in which rays are traced.", stage.tracer().bytes()),
            ("Light", "Irradiance cached on the surface.", stage.lit.irradiance_bytes()),
            ("Atlas", "Where triangles lie in the map, and what its texels cover.", {
                stage.atlas.bytes() + stage.texels.bytes()
            }),
            (
                "Brush",
                "The tree of texels in which a brush looks for those that it reaches.",
                stage.canvas.bytes(),
            ),
            (
                "Focus",
                "The maps of all layers and their composite.",
                document.layers.bytes_with(&document.map),
            ),
            ("Undo", "What the undo steps keep.", undo),
            (
                "Light field",
                "The samples that the picture is summed from, with their index; also those prepared for a wider aperture and for \
                 better light.",
                fields,
            ),
            (
                "Sums",
                "The picture's sums while you work, the exact ones, and the hierarchy of samples.",
                sums,
            ),
            ("Picture", "The picture shown.", pixels),
        ]
        .map(|(name, description, bytes)| MemoryPart { name, description, bytes })
        .to_vec()
    }
}
