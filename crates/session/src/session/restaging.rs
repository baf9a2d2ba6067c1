//! The scene seen or lit in another way: other faces, another world, another variant; or its surface made anew, of repaired depth.
//!
//! The stage is prepared anew in the background and taken up when it is ready. Of two changes of one kind the later counts; one
//! that was prepared from a stage that is no longer there, because another change came first, is prepared once more.

use super::outcome::Outcome;
use super::restaged::{Cause, Restaged, Restaging};
use super::state::Session;
use crate::commands::Event;
use crate::error::SessionError;
use relief::DepthStroke;
use std::sync::Arc;

impl Session {
    /// Prepares the stage anew in the background, in place of what goes on under the same label; not if nothing is new.
    pub(super) fn restage(&mut self, restaging: Restaging) -> Result<(), SessionError> {
        let label = restaging.label();
        self.jobs.iter().filter(|job| job.label == label).for_each(|job| job.progress.cancel());
        let generation = self.generation;
        let base = self.opened()?.stage.clone();
        if restaging.is_new_to(&base) {
            self.start(label.into(), move |progress| {
                let stage = restaging.of(&base, progress)?;
                Ok(Outcome::Restaged(Box::new(Restaged { restaging, base, generation, stage })))
            })?;
        }
        Ok(())
    }

    /// Takes up a stage that was prepared.
    pub(super) fn take_restaged(&mut self, restaged: Restaged) -> Result<(), SessionError> {
        let Restaged { restaging, base, generation, stage } = restaged;
        if generation != self.generation {
            return Ok(());
        }
        self.commit_stroke()?;
        let document = self.opened()?;
        if !Arc::ptr_eq(&base, &document.stage) {
            return self.restage(restaging);
        }
        let warned = document.note_warnings_of(&stage.scene);
        if let Restaging::Depth(_) = restaging {
            // The strokes were counted as a change when they were made.
            document.take_surface(stage);
            document.recomposite(None);
            self.map_serial += 1;
        } else {
            if let Restaging::Variant { name, cause: Cause::Command } = restaging {
                document.undo.push_variant(base.scene.variant.clone(), name);
            }
            document.stage = Arc::new(stage);
            document.revision += 1;
        }
        let document = self.opened()?;
        let (stage, map, shot) = (document.stage.clone(), document.map.clone(), document.camera.clone());
        let camera = self.shown_camera(&shot);
        (self.field, self.preview_camera) = (None, Some(camera.clone()));
        self.preview_thread.set_stage((stage, generation), (map, self.map_serial), camera);
        self.end_verification();
        self.events.extend(warned.into_iter().map(Event::Notice));
        self.events.push(Event::SurfaceChanged);
        Ok(())
    }

    /// Repairs the depth of a picture by another stroke: a step of undo. The surface follows in the background.
    pub(super) fn repair_depth(&mut self, stroke: DepthStroke) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        if document.scene().picture.is_none() {
            let what = "depth can be repaired of light fields and pictures with depth alone (move the scene's surfaces in the program that made them)";
            return Err(SessionError::bad(&document.scene().path, what));
        }
        let before = document.depth_strokes.clone();
        let after = Arc::new([&before[..], &[stroke]].concat());
        document.undo.push_depth("Depth repair", before, after.clone());
        document.depth_strokes = after;
        document.revision += 1;
        self.follow_depth()
    }

    /// Has the surface made as the document's strokes say.
    pub(super) fn follow_depth(&mut self) -> Result<(), SessionError> {
        match self.opened()?.capture() {
            Some(choices) => self.restage(Restaging::Depth(choices)),
            None => Ok(()),
        }
    }
}
