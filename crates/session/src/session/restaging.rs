//! The scene seen or lit in another way: other faces, another world, another variant.
//!
//! The stage is prepared anew in the background and taken up when it is ready. Of two changes of one kind the later counts; one
//! that was prepared from a stage that is no longer there, because another change came first, is prepared once more.

use super::outcome::Outcome;
use super::restaged::{Cause, Restaged, Restaging};
use super::state::Session;
use crate::commands::Event;
use crate::error::SessionError;
use std::sync::Arc;

impl Session {
    /// Prepares the stage anew in the background, in place of what goes on under the same label; not if nothing is new.
    pub(super) fn restage(&mut self, restaging: Restaging) -> Result<(), SessionError> {
        let label = restaging.label();
        self.jobs.iter().filter(|job| job.label == label).for_each(|job| job.progress.cancel());
        let generation = self.generation;
        let base = self.opened()?.stage.clone();
        if restaging.is_new_to(&base.scene) {
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
        if let Restaging::Variant { name, cause: Cause::Command } = restaging {
            document.undo.push_variant(base.scene.variant.clone(), name);
        }
        let warned = document.note_warnings_of(&stage.scene);
        document.stage = Arc::new(stage);
        document.revision += 1;
        let (stage, map, shot) = (document.stage.clone(), document.map.clone(), document.camera.clone());
        let camera = self.shown_camera(&shot);
        (self.field, self.preview_camera) = (None, Some(camera.clone()));
        self.preview_thread.set_stage((stage, generation), (map, self.map_serial), camera);
        self.end_verification();
        self.events.extend(warned.into_iter().map(Event::Notice));
        self.events.push(Event::SurfaceChanged);
        Ok(())
    }
}
