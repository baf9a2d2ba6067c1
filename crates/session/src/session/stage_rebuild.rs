//! The scene seen or lit in another way: other faces, another world, another variant, splats moved or hidden, with a floor; or its surface made anew, of repaired depth.
//!
//! The stage is prepared anew in the background and taken up when it is ready. Of two changes of one kind the later counts; one
//! that was prepared from a stage that is no longer there, because another change came first, is prepared once more.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::job_outcome::JobOutcome;
use crate::session::stage_change::{ChangeCause, RebuiltStage, StageChange};
use crate::session::state::Session;
use relief::DepthStroke;
use std::sync::Arc;

impl Session {
    /// Prepares the stage anew in the background, in place of what goes on under the same label; not if nothing is new.
    pub(super) fn rebuild_stage(&mut self, change: StageChange) -> Result<(), SessionError> {
        let label = change.job_label();
        self.jobs.iter().filter(|job| job.label == label).for_each(|job| job.progress.cancel());
        let generation = self.generation;
        let base = self.document_mut()?.stage.clone();
        if change.differs_from(&base) {
            self.start_job(label.into(), move |progress| {
                let (stage, warnings) = change.apply_to(&base, progress)?;
                let rebuilt = RebuiltStage { change, base, generation, stage, warnings };
                Ok(JobOutcome::StageRebuilt(Box::new(rebuilt)))
            })?;
        }
        Ok(())
    }

    /// Takes up a stage that was prepared.
    pub(super) fn show_rebuilt_stage(&mut self, rebuilt: RebuiltStage) -> Result<(), SessionError> {
        let RebuiltStage { change, base, generation, stage, warnings } = rebuilt;
        if generation != self.generation {
            return Ok(());
        }
        self.commit_stroke()?;
        let document = self.document_mut()?;
        if !Arc::ptr_eq(&base, &document.stage) {
            return self.rebuild_stage(change);
        }
        let mut new_warnings = document.add_warnings_of(&stage.scene);
        new_warnings.extend(warnings);
        // The strokes that repair depth were counted as a change when they were made.
        document.revision += u64::from(!matches!(change, StageChange::Depth(_)));
        let is_another_surface = change.makes_surface();
        match change {
            StageChange::Variant { name, cause: ChangeCause::Command } => {
                document.undo.push_variant(base.scene.variant.clone(), name);
            }
            StageChange::Splats { name, edit, cause: ChangeCause::Command } => {
                let before = base.scene.splats.as_ref().map(|splats| splats.edit.clone());
                document.undo.push_splats(name, before.unwrap_or_default(), *edit);
            }
            StageChange::Floor { is_shown, cause: ChangeCause::Command } => {
                document.undo.push_floor("Floor", !is_shown, is_shown);
            }
            _ => {}
        }
        if is_another_surface {
            document.replace_surface(stage);
            document.recomposite(None);
            self.map_serial += 1;
        } else {
            document.stage = Arc::new(stage);
        }
        let document = self.document_mut()?;
        let (stage, map, shot_camera) =
            (document.stage.clone(), document.map.clone(), document.camera.clone());
        let camera = self.preview_camera_from(&shot_camera);
        (self.light_field, self.preview_camera) = (None, Some(camera.clone()));
        self.preview_thread.set_stage((stage, generation), (map, self.map_serial), camera);
        self.end_verification();
        self.events.extend(new_warnings.into_iter().map(Event::Notice));
        self.events.push(Event::SurfaceChanged);
        Ok(())
    }

    /// Hides the splats that are selected: a step of undo.
    pub(super) fn hide_selected_splats(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        match document.splat_edit_hiding_selection() {
            Some(edit) => {
                let (name, cause) = ("Hide splats", ChangeCause::Command);
                self.rebuild_stage(StageChange::Splats { name, edit: edit.into(), cause })
            }
            None => {
                let what = "no Gaussian splat is selected (select what is to be hidden)";
                Err(SessionError::bad_file(&document.scene().path, what))
            }
        }
    }

    /// Repairs the depth of a picture by another stroke: a step of undo. The surface follows in the background.
    pub(super) fn repair_depth(&mut self, stroke: DepthStroke) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        if document.scene().picture.is_none() {
            let what = "depth can only be repaired for light fields and pictures with depth (move surfaces in the program that made the scene)";
            return Err(SessionError::bad_file(&document.scene().path, what));
        }
        let before = document.depth_strokes.clone();
        let after = Arc::new([&before[..], &[stroke]].concat());
        document.undo.push_depth("Depth repair", before, after.clone());
        document.depth_strokes = after;
        document.revision += 1;
        self.rebuild_depth()
    }

    /// Has the surface made as the document's strokes say.
    pub(super) fn rebuild_depth(&mut self) -> Result<(), SessionError> {
        match self.document_mut()?.capture_choices() {
            Some(choices) => self.rebuild_stage(StageChange::Depth(choices)),
            None => Ok(()),
        }
    }
}
