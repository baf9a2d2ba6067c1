//! Strokes, gradients, fills, selections and layers.

use super::state::Session;
use crate::commands::Event;
use crate::editing::{FillRegion, GradientInHand, Painter, StrokePoint, Underway, redo};
use crate::error::SessionError;
use focus::{Combine, FillTarget, FocusMap, Gradient, LayerEdit};
use lens::FocusOffset;
use project::{RecordedStep, SelectionShape};

impl Session {
    pub(super) fn begin_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let painter = Painter::begin(self.opened()?, &point)?;
        self.underway = Some(Underway::Stroke(Box::new(painter)));
        self.extend_stroke(point)
    }

    pub(super) fn extend_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        let Some(Underway::Stroke(stroke)) = &mut self.underway else { return Ok(()) };
        let changed = stroke.extend(document, &point);
        self.show_layers(Some(changed))
    }

    /// Draws a gradient, or another one in the place of the one being drawn.
    pub(super) fn drag_gradient(&mut self, gradient: Gradient) -> Result<(), SessionError> {
        if let Some(Underway::Stroke(_)) = self.underway {
            self.commit_stroke()?;
        }
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        match &mut self.underway {
            Some(Underway::Gradient(drawn)) => drawn.change(document, gradient)?,
            _ => {
                let drawn = GradientInHand::begin(document, gradient)?;
                self.underway = Some(Underway::Gradient(Box::new(drawn)));
            }
        }
        self.show_layers(None)
    }

    /// Ends the stroke or the gradient that is going on.
    pub(super) fn commit_stroke(&mut self) -> Result<(), SessionError> {
        let Some(underway) = self.underway.take() else { return Ok(()) };
        let document = self.opened()?;
        let changed = match underway {
            Underway::Stroke(stroke) => stroke.commit(document),
            Underway::Gradient(gradient) => gradient.commit(document),
        };
        if changed {
            document.picture_step();
            self.preview_thread.settle();
        }
        Ok(())
    }

    /// Takes the stroke or the gradient back that is going on.
    pub(super) fn abort_stroke(&mut self) -> Result<(), SessionError> {
        let Some(underway) = self.underway.take() else { return Ok(()) };
        let document = self.opened()?;
        let changed = match underway {
            Underway::Stroke(stroke) => Some(stroke.abort(document)),
            Underway::Gradient(gradient) => {
                gradient.abort(document);
                None
            }
        };
        self.show_layers(changed)
    }

    pub(super) fn fill(&mut self, region: FillRegion, focus: FocusOffset) -> Result<(), SessionError> {
        let targets = self.opened()?.targets_of(region);
        self.fill_targets(targets, focus)
    }

    pub(super) fn fill_targets(
        &mut self,
        targets: Vec<FillTarget>,
        focus: FocusOffset,
    ) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        let revision = document.revision;
        let changed = document.fill(targets, focus)?;
        self.show_layers(Some(changed))?;
        let document = self.opened()?;
        if document.revision != revision {
            document.picture_step();
        }
        Ok(())
    }

    /// Does a recorded step, as a step of undo.
    pub(super) fn do_step(&mut self, step: &RecordedStep) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        let brush = document.brush.clone();
        let changed = redo(document, step);
        document.brush = brush;
        if changed? {
            document.picture_step();
            self.events.extend([Event::LayersChanged, Event::SelectionChanged]);
        }
        self.show_everything()
    }

    pub(super) fn select_region(&mut self, region: FillRegion, combine: Combine) -> Result<(), SessionError> {
        let targets = self.opened()?.targets_of(region);
        self.select(SelectionShape::Targets(targets), combine)
    }

    pub(super) fn select(&mut self, shape: SelectionShape, combine: Combine) -> Result<(), SessionError> {
        self.commit_stroke()?;
        if self.opened()?.select(shape, combine)? {
            self.events.push(Event::SelectionChanged);
        }
        Ok(())
    }

    pub(super) fn mask_selected(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.opened()?.mask_selected()?;
        self.layers_changed(changed)
    }

    pub(super) fn reset_map(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.opened()?.reset_map()?;
        self.layers_changed(changed)
    }

    /// Puts a map in the place of the active layer's values, or above it where those come from a rule.
    pub(super) fn import_map(&mut self, map: FocusMap) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.opened()?.change_layers("Import focus", None, |layers, document| {
            if layers.active().adjustment.is_some() {
                LayerEdit::AddPaint.apply(layers, &document.stage.canvas, &document.camera)?;
            }
            layers.active_mut().map = map;
            Ok(())
        })?;
        self.layers_changed(changed)
    }

    pub(super) fn edit_layers(&mut self, edit: LayerEdit) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let changed = self.opened()?.edit_layers(edit)?;
        self.layers_changed(changed)
    }

    pub(super) fn activate_layer(&mut self, index: usize) -> Result<(), SessionError> {
        self.commit_stroke()?;
        self.opened()?.layers.activate(index);
        self.events.push(Event::LayersChanged);
        Ok(())
    }

    fn layers_changed(&mut self, changed: bool) -> Result<(), SessionError> {
        if !changed {
            return Ok(());
        }
        self.events.push(Event::LayersChanged);
        self.show_layers(None)?;
        self.opened()?.picture_step();
        Ok(())
    }
}
