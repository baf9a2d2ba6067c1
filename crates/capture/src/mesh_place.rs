//! Where the mesh of a capture is: in the space of its cameras, or in one that has to be moved there first.

use crate::cameras::pose::{Axes, from_camera_to_world};
use crate::files::folder::Folder;
use crate::mesh::placement::{Placement, find_placements, move_mesh};
use crate::mesh_fit::{MeshFit, MeshObservation, measure};
use crate::{CaptureError, Remark};
use glam::DMat4;
use progress::{Progress, Stage};
use scene::{LoadOptions, Scene, View};
use std::path::Path;

/// The mesh of a capture, and where files that say how it was moved may be.
pub(crate) struct MeshPlace<'a> {
    pub folder: &'a Folder,
    /// The file of the mesh.
    pub mesh: &'a Path,
    pub options: &'a LoadOptions,
}

impl MeshPlace<'_> {
    /// How well the mesh fits the photographs, after it was moved as a file says if it fits better then; remarks if it was moved, or does not
    /// fit.
    ///
    /// # Errors
    /// A photograph cannot be read, or the work was cancelled.
    pub fn fit_mesh(
        &self,
        scene: &mut Scene,
        views: &[View],
        progress: &dyn Progress,
        remarks: &mut Vec<Remark>,
    ) -> Result<Option<MeshFit>, CaptureError> {
        let shown = self.mesh.display();
        let as_read = measure(scene, views, self.options, &Stage::new(progress, 0.0, 0.5))?;
        let placements = match find_placements(self.folder, self.mesh) {
            Ok(placements) => placements,
            Err(error) => {
                remarks.push(Remark::note(error.to_string()));
                Vec::new()
            }
        };
        let mut best = (as_read, None);
        for (index, placement) in placements.iter().enumerate() {
            let [begin, end] = [index, index + 1].map(|n| 0.5 + 0.5 * n as f32 / placements.len() as f32);
            // Moving the cameras the other way is the same.
            let Some(moved) = moved_views(views, placement.to_cameras.inverse()) else { continue };
            let observation = measure(scene, &moved, self.options, &Stage::new(progress, begin, end))?;
            if observation.fits_better_than(&best.0) {
                best = (observation, Some(placement));
            }
        }
        let (observation, placement) = best;
        if let Some(Placement { file, to_cameras }) = placement {
            move_mesh(scene, *to_cameras);
            let fits = match observation.fit() {
                Some(fit) => format!("{fit}, {} before", as_read.share()),
                None => "no photograph shows it otherwise".into(),
            };
            remarks.push(Remark::note(format!(
                "{shown}: is in nerfstudio's space and was moved to that of the cameras as {} says, because it fits the photographs there: {fits}",
                file.display()
            )));
        }
        let misfit = match observation {
            MeshObservation::NotVisible => Some("no picture shows anything of it".into()),
            MeshObservation::OnBlanks => {
                Some("does not fit the photographs: they are blank where it is, and not elsewhere".into())
            }
            MeshObservation::Visible(Some(fit)) if fit.is_contradicted() => {
                Some(format!("does not fit the photographs: only {fit}"))
            }
            MeshObservation::Visible(_) => None,
        };
        remarks.extend(misfit.map(|what: String| Remark {
            text: format!(
                "{shown}: {what} (its axes or scale are not those of the cameras, or it is another place: export both from one program; \
                 for a mesh of nerfstudio put its dataparser_transforms.json beside it)"
            ),
            names: vec![shown.to_string()],
            is_incomplete: true,
        }));
        Ok(observation.fit())
    }
}

/// The views after a motion with a scale; `None` if it is none.
fn moved_views(views: &[View], motion: DMat4) -> Option<Vec<View>> {
    let moved = |view: &View| {
        let camera_to_world = from_camera_to_world(motion * view.camera_to_world, Axes::Gltf)?;
        Some(View { camera_to_world, ..view.clone() })
    };
    views.iter().map(moved).collect()
}
