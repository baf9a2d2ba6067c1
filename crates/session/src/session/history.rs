//! Undo and redo: steps taken back and done again, and shown.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::stage_change::{ChangeCause, StageChange};
use crate::session::state::Session;
use document::{Document, StepEffect, UndoState};
use focus::ChangedTexels;
use std::cmp::Ordering;

impl Session {
    pub(super) fn step_back(&mut self) -> Result<(), SessionError> {
        if self.active_edit.is_some() {
            return self.abort_stroke();
        }
        let document = self.document_mut()?;
        let Document { undo, layers, camera, focus_hold, lens_motion, selection, depth_strokes, .. } =
            document;
        let effect =
            undo.undo(UndoState { layers, camera, focus_hold, lens_motion, selection, depth_strokes });
        self.finish_history_step(effect)
    }

    pub(super) fn step_forward(&mut self) -> Result<(), SessionError> {
        if self.active_edit.is_some() {
            return Ok(());
        }
        let document = self.document_mut()?;
        let Document { undo, layers, camera, focus_hold, lens_motion, selection, depth_strokes, .. } =
            document;
        let effect =
            undo.redo(UndoState { layers, camera, focus_hold, lens_motion, selection, depth_strokes });
        self.finish_history_step(effect)
    }

    /// Takes steps back, or does them again, until this many are done.
    pub(super) fn go_to(&mut self, steps: usize) -> Result<(), SessionError> {
        loop {
            let done = self.document_mut()?.undo.names().count();
            match done.cmp(&steps) {
                Ordering::Greater => self.step_back()?,
                Ordering::Less if self.document_mut()?.redo_name().is_some() => self.step_forward()?,
                _ => return Ok(()),
            }
        }
    }

    fn finish_history_step(&mut self, effect: Option<StepEffect>) -> Result<(), SessionError> {
        self.show_step_effect(effect)?;
        self.document_mut()?.reset_thumbnail_base();
        Ok(())
    }

    fn show_step_effect(&mut self, effect: Option<StepEffect>) -> Result<(), SessionError> {
        match effect {
            None => Ok(()),
            Some(StepEffect::Camera) => {
                self.document_mut()?.revision += 1;
                self.events.push(Event::CameraChanged);
                self.show_camera();
                self.update_adjustment_layers()
            }
            Some(StepEffect::LensMotion { seconds }) => {
                let document = self.document_mut()?;
                document.revision += 1;
                let is_same_time = document.seconds == seconds;
                self.events.push(Event::CameraChanged);
                self.show_camera();
                self.update_adjustment_layers()?;
                // At another time the keys say what the lens is.
                if is_same_time { Ok(()) } else { self.show_lens_keys() }
            }
            Some(StepEffect::Paint { texels, .. }) => {
                self.document_mut()?.revision += 1;
                self.events.push(Event::LayersChanged);
                self.show_layers(Some(ChangedTexels { texels }))
            }
            Some(StepEffect::Selection) => {
                self.events.push(Event::SelectionChanged);
                Ok(())
            }
            Some(StepEffect::Variant(name)) => {
                self.rebuild_stage(StageChange::Variant { name, cause: ChangeCause::History })
            }
            Some(StepEffect::Splats(edit)) => {
                let cause = ChangeCause::History;
                self.rebuild_stage(StageChange::Splats { name: "Splats", edit, cause })
            }
            Some(StepEffect::Floor(is_shown)) => {
                self.rebuild_stage(StageChange::Floor { is_shown, cause: ChangeCause::History })
            }
            Some(StepEffect::Depth) => {
                self.document_mut()?.revision += 1;
                self.rebuild_depth()
            }
            Some(StepEffect::Layers) => {
                let document = self.document_mut()?;
                // Steps hold no values that follow from the camera.
                document.evaluate_adjustments();
                document.revision += 1;
                self.events.push(Event::LayersChanged);
                self.show_layers(None)
            }
        }
    }
}
