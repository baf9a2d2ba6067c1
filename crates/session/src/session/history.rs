//! Undo and redo: steps taken back and done again, and shown.

use super::restaged::{Cause, Restaging};
use super::state::Session;
use crate::commands::Event;
use crate::document::{Document, Undoable, Undone};
use crate::error::SessionError;
use focus::Changed;
use std::cmp::Ordering;

impl Session {
    pub(super) fn step_back(&mut self) -> Result<(), SessionError> {
        if self.underway.is_some() {
            return self.abort_stroke();
        }
        let document = self.opened()?;
        let Document { undo, layers, camera, lens_motion, selection, depth_strokes, .. } = document;
        let undone = undo.undo(Undoable { layers, camera, lens_motion, selection, depth_strokes });
        self.after_step(undone)
    }

    pub(super) fn step_forward(&mut self) -> Result<(), SessionError> {
        if self.underway.is_some() {
            return Ok(());
        }
        let document = self.opened()?;
        let Document { undo, layers, camera, lens_motion, selection, depth_strokes, .. } = document;
        let done = undo.redo(Undoable { layers, camera, lens_motion, selection, depth_strokes });
        self.after_step(done)
    }

    /// Takes steps back, or does them again, until this many are done.
    pub(super) fn go_to(&mut self, steps: usize) -> Result<(), SessionError> {
        loop {
            let done = self.opened()?.undo.names().count();
            match done.cmp(&steps) {
                Ordering::Greater => self.step_back()?,
                Ordering::Less if self.opened()?.redo_name().is_some() => self.step_forward()?,
                _ => return Ok(()),
            }
        }
    }

    fn after_step(&mut self, step: Option<Undone>) -> Result<(), SessionError> {
        self.show_step(step)?;
        self.opened()?.stepped();
        Ok(())
    }

    fn show_step(&mut self, step: Option<Undone>) -> Result<(), SessionError> {
        match step {
            None => Ok(()),
            Some(Undone::Camera) => {
                self.opened()?.revision += 1;
                self.events.push(Event::CameraChanged);
                self.show_camera();
                self.follow_camera()
            }
            Some(Undone::LensMotion) => {
                self.opened()?.revision += 1;
                self.show_time()
            }
            Some(Undone::Paint { texels, .. }) => {
                self.opened()?.revision += 1;
                self.events.push(Event::LayersChanged);
                self.show_layers(Some(Changed { texels }))
            }
            Some(Undone::Selection) => {
                self.events.push(Event::SelectionChanged);
                Ok(())
            }
            Some(Undone::Variant(name)) => self.restage(Restaging::Variant { name, cause: Cause::History }),
            Some(Undone::Depth) => {
                self.opened()?.revision += 1;
                self.follow_depth()
            }
            Some(Undone::Layers) => {
                let document = self.opened()?;
                // Steps hold no values that follow from the camera.
                document.adjust();
                document.revision += 1;
                self.events.push(Event::LayersChanged);
                self.show_layers(None)
            }
        }
    }
}
