//! Strokes, gradients, fills, selections and layers.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::state::Session;
use document::{ActiveEdit, ActiveGradient, FillRegion, Painter, StrokePoint, apply_recorded_step};
use focus::{CombineMode, FillTarget, FocusMap, Gradient, LayerEdit};
use lens::FocusOffset;
use project::{RecordedStep, SelectionShape};

impl Session {
    pub(super) fn begin_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let painter = Painter::begin(self.document_mut()?, &point)?;
        self.active_edit = Some(ActiveEdit::Stroke(Box::new(painter)));
        self.extend_stroke(point)
    }

    pub(super) fn extend_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        let Some(ActiveEdit::Stroke(stroke)) = &mut self.active_edit else { return Ok(()) };
        let changed = stroke.extend(document, &point);
        self.show_layers(Some(changed))
    }

    /// Draws a gradient, or another one in the place of the one being drawn.
    pub(super) fn drag_gradient(&mut self, gradient: Gradient) -> Result<(), SessionError> {
        if let Some(ActiveEdit::Stroke(_)) = self.active_edit {
            self.commit_stroke()?;
        }
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        match &mut self.active_edit {
            Some(ActiveEdit::Gradient(gradient_edit)) => gradient_edit.change(document, gradient)?,
            _ => {
                let gradient_edit = ActiveGradient::begin(document, gradient)?;
                self.active_edit = Some(ActiveEdit::Gradient(Box::new(gradient_edit)));
            }
        }
        self.show_layers(None)
    }

    /// Ends the stroke or the gradient that is going on.
    pub(super) fn commit_stroke(&mut self) -> Result<(), SessionError> {
        let Some(active_edit) = self.active_edit.take() else { return Ok(()) };
        let document = self.document_mut()?;
        let changed = match active_edit {
            ActiveEdit::Stroke(stroke) => stroke.commit(document),
            ActiveEdit::Gradient(gradient) => gradient.commit(document),
        };
        if changed {
            document.add_step_thumbnail();
            self.preview_thread.edit_done();
        }
        Ok(())
    }

    /// Takes the stroke or the gradient back that is going on.
    pub(super) fn abort_stroke(&mut self) -> Result<(), SessionError> {
        let Some(active_edit) = self.active_edit.take() else { return Ok(()) };
        let document = self.document_mut()?;
        let changed = match active_edit {
            ActiveEdit::Stroke(stroke) => Some(stroke.abort(document)),
            ActiveEdit::Gradient(gradient) => {
                gradient.abort(document);
                None
            }
        };
        self.show_layers(changed)
    }

    pub(super) fn fill(&mut self, region: FillRegion, focus: FocusOffset) -> Result<(), SessionError> {
        let targets = self.document_mut()?.fill_targets(region);
        self.fill_targets(targets, focus)
    }

    pub(super) fn fill_targets(
        &mut self,
        targets: Vec<FillTarget>,
        focus: FocusOffset,
    ) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        let revision = document.revision;
        let changed = document.fill(targets, focus)?;
        self.show_layers(Some(changed))?;
        let document = self.document_mut()?;
        if document.revision != revision {
            document.add_step_thumbnail();
        }
        Ok(())
    }

    /// Does a recorded step, as a step of undo.
    pub(super) fn apply_recorded_step(&mut self, step: &RecordedStep) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        let brush = document.brush.clone();
        let changed = apply_recorded_step(document, step);
        document.brush = brush;
        if changed? {
            document.add_step_thumbnail();
            self.events.extend([Event::LayersChanged, Event::SelectionChanged]);
        }
        self.show_everything()
    }

    pub(super) fn select_region(
        &mut self,
        region: FillRegion,
        combine: CombineMode,
    ) -> Result<(), SessionError> {
        let targets = self.document_mut()?.fill_targets(region);
        self.select(SelectionShape::Targets(targets), combine)
    }

    pub(super) fn select(&mut self, shape: SelectionShape, combine: CombineMode) -> Result<(), SessionError> {
        self.commit_stroke()?;
        if self.document_mut()?.select(shape, combine)? {
            self.events.push(Event::SelectionChanged);
        }
        Ok(())
    }

    pub(super) fn mask_selected(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.document_mut()?.mask_selected()?;
        self.show_changed_layers(changed)
    }

    pub(super) fn reset_map(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.document_mut()?.reset_map()?;
        self.show_changed_layers(changed)
    }

    /// Puts a map in the place of the active layer's values, or above it where those come from a rule.
    pub(super) fn import_map(&mut self, map: FocusMap) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.document_mut()?.change_layers("Import focus", None, |layers, document| {
            if layers.active().adjustment.is_some() {
                LayerEdit::AddPaint.apply(layers, &document.stage.canvas, &document.camera)?;
            }
            layers.active_mut().map = map;
            Ok(())
        })?;
        self.show_changed_layers(changed)
    }

    pub(super) fn edit_layers(&mut self, edit: LayerEdit) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.document_mut()?.edit_layers(edit)?;
        self.show_changed_layers(changed)
    }

    pub(super) fn activate_layer(&mut self, index: usize) -> Result<(), SessionError> {
        self.commit_stroke()?;
        self.document_mut()?.layers.activate(index);
        self.events.push(Event::LayersChanged);
        Ok(())
    }

    fn show_changed_layers(&mut self, changed: bool) -> Result<(), SessionError> {
        if !changed {
            return Ok(());
        }
        self.events.push(Event::LayersChanged);
        self.show_layers(None)?;
        self.document_mut()?.add_step_thumbnail();
        Ok(())
    }
}
