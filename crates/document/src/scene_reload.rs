//! Paint on a scene whose file another program has changed, before the document was opened or while it is open.

use crate::error::DocumentError;
use crate::input::{Input, VariantChoice};
use crate::open_document::Document;
use crate::paint_transfer::transfer_paint;
use crate::scene_camera::shot_camera_from;
use crate::scene_file::{atlas_error, load_variant};
use atlas::UnwrapOptions;
use lens::Camera;
use light::{Resources, Steps};
use project::{ProjectFile, SceneState, surface_from_bytes, surface_to_bytes};
use scene::{Scene, SceneCamera};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Input {
    /// Transfers the paint of a project to the current surface, if the project's scene has changed.
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
            DocumentError::bad_file(&self.path, "surface.bin is damaged (restore the file from a backup)")
        })?;
        self.transfer_paint_from(&project.clone(), &old, unwrap, steps)
    }

    /// Takes over the paint of a project, which may be on another surface, together with its world, brush and back faces.
    ///
    /// # Errors
    /// The project cannot be read, the surface that it was painted on is unknown, or those of [`Self::transfer_paint_if_changed`].
    pub(crate) fn import_paint_from(
        &mut self,
        file: &Path,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<(), DocumentError> {
        let mut project = ProjectFile::load(file)?;
        let old = match project.surface.as_deref().map(surface_from_bytes) {
            Some(Some(surface)) => surface,
            None if project.capture.is_none() && project.scene_state() == SceneState::Same => {
                Arc::unwrap_or_clone(load_variant(
                    &project.scene,
                    None,
                    project.splats.as_ref(),
                    &*steps.begin("reading"),
                )?)
            }
            _ => {
                let message =
                    "the surface it was painted on is unknown (save it once with its original scene)";
                return Err(DocumentError::bad_file(file, message));
            }
        };
        let world = project.world.as_ref().map(|world| world.load(&self.scene)).transpose()?;
        let (world, faults) = world.unzip();
        self.set_world(world);
        self.warnings.extend(faults.into_iter().flatten());
        self.set_back_faces(project.back_faces);
        let active = project.active_camera;
        project.cameras[active].camera = self.camera.clone();
        self.transfer_paint_from(&project, &old, unwrap, steps)
    }

    /// Transfers the paint of a project from the surface of `old` to the scene.
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
    /// The open document, given as `project`, on the scene as its file is now: paint is transferred to the new surface. If the shot camera is
    /// an unchanged camera of the scene, of those in `previous_cameras`, it follows that camera. `path` is the document's own file.
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
        let mut input =
            Input::open_project(&display_path, project, &VariantChoice::AsSaved, resources, steps)?;
        let shot = &input.camera;
        let previous = previous_cameras.iter().find(|camera| matches_scene_camera(shot, camera));
        let current = previous
            .and_then(|previous| input.scene.cameras.iter().find(|camera| camera.name == previous.name));
        if let Some(camera) = current {
            input.camera = shot_camera_from(camera, shot);
        }
        let mut document = Self::from_input(input, unwrap, steps)?;
        document.path = path;
        document.revision = 0;
        document.note_unrecorded_change();
        Ok(document)
    }
}

/// Whether a shot camera is an unchanged camera of the scene.
fn matches_scene_camera(shot: &Camera, camera: &SceneCamera) -> bool {
    let from_scene = shot_camera_from(camera, shot);
    // The focus distance of a camera whose file does not specify one is only a default.
    Camera { focus_distance: shot.focus_distance, ..from_scene.clone() } == *shot
        && camera.lens.focus_distance.is_none_or(|distance| distance == shot.focus_distance)
}
