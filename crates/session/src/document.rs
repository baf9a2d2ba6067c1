//! What is open: the scene, its focus and its camera.

use crate::Stage;
use crate::undo::Undo;
use focus::{Brush, FocusMap};
use lens::{Camera, Exposure};
use scene::{Scene, SceneCamera};
use std::path::PathBuf;
use std::sync::Arc;

/// An open document. Focus map and camera are saved and can be undone; brush, exposure and what is known of the
/// scene are not part of its history.
pub struct Document {
    /// Scene, atlas and what works on them.
    pub stage: Arc<Stage>,
    /// The focus as painted.
    pub map: FocusMap,
    /// The shot camera.
    pub camera: Camera,
    /// How the sum becomes the picture.
    pub exposure: Exposure,
    /// The brush of the strokes to come.
    pub brush: Brush,
    /// The project file; none before the first save.
    pub path: Option<PathBuf>,
    /// Steps of undo and redo.
    pub(crate) undo: Undo,
    /// Counts changes of what is saved.
    pub(crate) revision: u64,
    /// The revision that the project file holds.
    pub(crate) saved: u64,
}

impl Document {
    /// A scene just opened, nothing painted.
    pub fn new(stage: Arc<Stage>) -> Self {
        let camera = camera_of(&stage.scene, &stage.scene.cameras[0], &Camera::default());
        let map = FocusMap::new(stage.atlas.width, stage.atlas.height, lens::FocusOffset::STANDARD);
        let (low, high) = stage.scene.bounds();
        let brush = Brush { radius: brush_radius((high - low).length()), ..Brush::default() };
        Self {
            stage,
            map,
            camera,
            exposure: Exposure::Normalise,
            brush,
            path: None,
            undo: Undo::default(),
            revision: 0,
            saved: 0,
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.stage.scene
    }

    /// Whether the project file (or, before the first save, the scene as opened) differs from what is open.
    pub fn is_unsaved(&self) -> bool {
        self.revision != self.saved
    }

    /// What to call it: the project's file name, else the scene's.
    pub fn name(&self) -> String {
        crate::error::file_name(self.path.as_deref().unwrap_or(&self.stage.scene.path))
    }

    /// What undo would take back.
    pub fn undo_name(&self) -> Option<&str> {
        self.undo.undo_name()
    }

    /// What redo would do again.
    pub fn redo_name(&self) -> Option<&str> {
        self.undo.redo_name()
    }

    /// Bytes that the undo steps hold.
    pub fn undo_bytes(&self) -> usize {
        self.undo.bytes()
    }

    /// The cameras of the scene by name, as shot cameras: with the lens of the current one.
    pub fn scene_cameras(&self) -> impl Iterator<Item = (&str, Camera)> {
        let cameras = self.stage.scene.cameras.iter();
        cameras.map(|camera| (camera.name.as_str(), camera_of(&self.stage.scene, camera, &self.camera)))
    }
}

/// A twentieth of the scene, or 0.1 for a scene that is a point.
fn brush_radius(diagonal: f64) -> f64 {
    if diagonal > 0.0 && diagonal.is_finite() { diagonal / 20.0 } else { Brush::default().radius }
}

/// A camera of the scene with the size, lens and background of `lens`.
///
/// Where the camera says its aspect, the width follows it. The lens keeps its numbers: they are lengths of a
/// real camera, whatever the scene.
pub fn camera_of(_scene: &Scene, camera: &SceneCamera, lens: &Camera) -> Camera {
    let width = camera.aspect.map_or(lens.width, |aspect| {
        (lens.height as f64 * aspect).round().clamp(1.0, Camera::LARGEST_SIDE_PX as f64) as u32
    });
    Camera {
        width,
        yfov: camera.yfov,
        focus_distance: camera.focus_distance,
        camera_to_world: camera.camera_to_world,
        ..lens.clone()
    }
}
