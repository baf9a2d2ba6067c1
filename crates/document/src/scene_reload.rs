//! Paint on a scene that is another by now: written again by another program, before the document was opened or while it is open.

use crate::input::Input;
use light::Resources;
use crate::open_document::Document;
use crate::scene_camera::shot_camera_from;
use crate::stage::atlas_error;
use crate::stage::load_variant;
use crate::input::VariantChoice;
use crate::paint_transfer::transfer_paint;
use crate::error::DocumentError;
use light::Steps;
use atlas::UnwrapOptions;
use lens::Camera;
use project::{ProjectFile, SceneState, surface_from_bytes, surface_to_bytes};
use scene::{Scene, SceneCamera};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Input {
    /// Has the paint of a project follow the surface, if the project's scene is another one by now.
    ///
    /// # Errors
    /// The project is damaged, the scene cannot be unwrapped, or the work was cancelled.
    pub fn transfer_paint_if_changed(
        &mut self,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<(), DocumentError> {
        let Some(project) = self.project.as_ref().filter(|project| project.capture.is_none()) else {
            return Ok(());
        };
        let Some(surface) = project.surface.as_ref().filter(|_| self.paint_transfer.is_none()) else {
            return Ok(());
        };
        if *surface == surface_to_bytes(&self.scene) {
            return Ok(());
        }
        let old = surface_from_bytes(surface);
        let old = old.ok_or_else(|| {
            DocumentError::bad_file(&self.path, "surface.bin is damaged (restore the file from a copy)")
        })?;
        self.transfer_paint_from(&project.clone(), &old, unwrap, steps)
    }

    /// Takes over what is painted in a project, which may be on another surface; its world and brush come along.
    ///
    /// # Errors
    /// The project cannot be read, or its surface is not known any more.
    pub fn import_paint_from(
        &mut self,
        file: &Path,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<(), DocumentError> {
        let mut project = ProjectFile::load(file)?;
        let old = match project.surface.as_deref().map(surface_from_bytes) {
            Some(Some(surface)) => surface,
            None if project.capture.is_none() && project.scene_state() == SceneState::Same => {
                Arc::unwrap_or_clone(load_variant(&project.scene, None, &*steps.begin("reading"))?)
            }
            _ => {
                let what =
                    "what it was painted on is not known any more (save it once with its scene as it was)";
                return Err(DocumentError::bad_file(file, what));
            }
        };
        let world = project.world.as_ref().map(|world| world.load(&self.scene)).transpose()?;
        self.set_world(world);
        self.set_back_faces(project.back_faces);
        let active = project.active_camera;
        project.cameras[active].camera = self.camera.clone();
        self.transfer_paint_from(&project, &old, unwrap, steps)
    }

    /// Gives the scene the paint of a project that was painted on `old`.
    fn transfer_paint_from(
        &mut self,
        project: &ProjectFile,
        old: &Scene,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<(), DocumentError> {
        let atlas = self.unwrap_scene(unwrap, steps).map_err(|error| atlas_error(&self.path, error))?;
        steps.begin("carrying paint over").check()?;
        let (project, transferred) = transfer_paint(project, old, &self.scene, &atlas)?;
        self.warnings.insert(0, transferred.summary(&self.scene.path));
        (self.project, self.paint_transfer) = (Some(project), Some(transferred));
        Ok(())
    }
}

impl Document {
    /// What was open, as `project`, on the scene as it is now; the paint follows the surface, and the shot camera the camera of the scene
    /// that it was, of those in `before`, unless it was changed here. `path` is the document's own file.
    ///
    /// # Errors
    /// The scene cannot be read or unwrapped, or the work was cancelled.
    pub fn reload(
        project: ProjectFile,
        previous_cameras: &[SceneCamera],
        path: Option<PathBuf>,
        (unwrap, resources): (&UnwrapOptions, &Resources),
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let display_path = path.clone().unwrap_or_else(|| project.scene.clone());
        let mut input = Input::open_project(&display_path, project, &VariantChoice::AsSaved, resources, steps)?;
        let shot = &input.camera;
        let previous = previous_cameras.iter().find(|camera| matches_scene_camera(shot, camera));
        let current = previous
            .and_then(|previous| input.scene.cameras.iter().find(|camera| camera.name == previous.name));
        if let Some(camera) = current {
            input.camera = shot_camera_from(camera, shot);
        }
        let mut document = Self::from_input(input, unwrap, steps)?;
        (document.path, document.revision) = (path, 1);
        Ok(document)
    }
}

/// Whether a shot camera is as the scene's camera has it.
fn matches_scene_camera(shot: &Camera, camera: &SceneCamera) -> bool {
    let from_scene = shot_camera_from(camera, shot);
    // The focus distance of a camera without one is a proposal.
    Camera { focus_distance: shot.focus_distance, ..from_scene.clone() } == *shot
        && camera.lens.focus_distance.is_none_or(|distance| distance == shot.focus_distance)
}
