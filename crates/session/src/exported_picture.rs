//! What is exported of the picture.

use lens::Camera;
use render::Aov;

/// Size and layers of an exported picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureExport {
    /// Columns and rows, px; `None`: the camera's.
    pub size: Option<[u32; 2]>,
    /// Layers of an EXR beside picture and coverage.
    pub layers: Vec<Aov>,
}

impl PictureExport {
    /// The camera whose picture is exported.
    pub(crate) fn camera(&self, camera: &Camera) -> Camera {
        let [width, height] = self.size.unwrap_or([camera.width, camera.height]);
        Camera { width, height, ..camera.clone() }
    }
}
