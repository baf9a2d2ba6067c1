//! Strokes, gradients, fills, selections and layers.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use document::{
    ActiveEdit, ActiveGradient, FillRegion, Painter, SelectionMatches, SolvedSpread, StrokePoint,
    apply_recorded_step,
};
use focus::{CombineMode, FillTarget, FocusMap, Gradient, LayerEdit, SpreadSettings};
use lens::FocusOffset;
use progress::{Stage, Unwatched};
use project::{RecordedStep, SelectionShape};

/// Labels of background work.
const SPREADING: &str = "spreading";
const SELECTING: &str = "selecting";

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

    /// Selects a shape; one that follows the surface in the background, in place of the one before.
    pub(super) fn select(&mut self, shape: SelectionShape, combine: CombineMode) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let follows_surface =
            matches!(shape, SelectionShape::Similar { .. } | SelectionShape::Refined { .. });
        let task = self.document_mut()?.selection_task(shape)?;
        let generation = self.generation;
        if !follows_surface {
            return self.select_matches(task.solve(&Unwatched)?, combine, generation);
        }
        self.cancel_jobs(SELECTING);
        self.start_job(SELECTING.into(), move |progress| {
            let matches = Box::new(task.solve(progress)?);
            Ok(JobOutcome::SelectionFound { matches, combine, generation })
        })?;
        Ok(())
    }

    pub(super) fn select_matches(
        &mut self,
        matches: SelectionMatches,
        combine: CombineMode,
        generation: u64,
    ) -> Result<(), SessionError> {
        if generation == self.generation && self.document_mut()?.select_matches(matches, combine)? {
            self.events.push(Event::SelectionChanged);
        }
        Ok(())
    }

    /// Spreads the strokes of the active layer: at once if they are solved for, else in the background. A slider that
    /// moves meanwhile does not begin anew.
    pub(super) fn spread(&mut self, settings: SpreadSettings) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        let layer = document.layers.active_index();
        let task = document.spread_task(layer, &settings)?;
        if document.is_spread_solved(&task) {
            return self.show_spread(layer, settings);
        }
        let is_begun = document.has_solved_strokes(&task);
        let before = self.requested_spread.replace((layer, settings));
        let is_same =
            before.is_some_and(|(index, before)| index == layer && before.contrast == settings.contrast);
        if (is_same || is_begun) && self.jobs.iter().any(|job| job.label == SPREADING) {
            return Ok(());
        }
        self.cancel_jobs(SPREADING);
        let generation = self.generation;
        let (sender, waker) = (self.outcome_sender.clone(), self.options.waker.clone());
        self.start_job(SPREADING.into(), move |progress| {
            let solved = Box::new(task.clone().solve_at_reach(&Stage::new(progress, 0.0, 0.3))?);
            // The session may have been dropped.
            let _ = sender.send((None, Ok(JobOutcome::SpreadSolved { solved, generation })));
            waker();
            let solved = Box::new(task.solve(&Stage::new(progress, 0.3, 1.0))?);
            Ok(JobOutcome::SpreadSolved { solved, generation })
        })?;
        Ok(())
    }

    /// Takes up strokes that were solved for, and spreads them as was requested last.
    pub(super) fn show_solved_spread(
        &mut self,
        solved: SolvedSpread,
        generation: u64,
    ) -> Result<(), SessionError> {
        if generation != self.generation {
            return Ok(());
        }
        self.document_mut()?.keep_solved_spread(solved);
        let Some((layer, settings)) = self.requested_spread.take() else { return Ok(()) };
        let document = self.document_mut()?;
        let task = document.spread_task(layer, &settings)?;
        // Otherwise strokes were painted meanwhile, or the layer is another one.
        if document.is_spread_solved(&task) { self.show_spread(layer, settings) } else { Ok(()) }
    }

    fn show_spread(&mut self, layer: usize, settings: SpreadSettings) -> Result<(), SessionError> {
        self.commit_stroke()?;
        if let Some(changed) = self.document_mut()?.spread(layer, settings)? {
            self.events.push(Event::LayersChanged);
            self.show_layers(Some(changed))?;
            self.document_mut()?.add_step_thumbnail();
        }
        Ok(())
    }

    pub(super) fn show_strokes(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        let changed = document.show_strokes(document.layers.active_index())?;
        self.show_changed_layers(changed)
    }

    fn cancel_jobs(&self, label: &str) {
        self.jobs.iter().filter(|job| job.label == label).for_each(|job| job.progress.cancel());
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
