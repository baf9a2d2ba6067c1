//! Strokes to be solved for before they can be spread: work that takes long and needs no document.

use crate::error::DocumentError;
use crate::stage;
use focus::{FocusMap, SpreadField, SpreadLabels, SpreadSettings, SurfaceGraph};
use progress::{Progress, Stage};
use spread::SpreadError;
use std::sync::Arc;

/// What has to be solved before strokes can be spread.
#[derive(Clone)]
pub struct SpreadTask {
    pub(crate) stage: Arc<stage::Stage>,
    pub(crate) strokes: FocusMap,
    pub(crate) settings: SpreadSettings,
}

/// Strokes that were solved for, on a surface.
#[derive(Clone)]
pub struct SolvedSpread {
    pub(crate) task: SpreadTask,
    pub(crate) field: Arc<SpreadField>,
}

impl SpreadTask {
    /// Solves for every reach: seconds for a million texels.
    ///
    /// # Errors
    /// Nothing is painted, photographs cannot be used, or `progress` was cancelled.
    pub fn solve(self, progress: &dyn Progress) -> Result<SolvedSpread, DocumentError> {
        let (graph, labels, solving) = self.prepare(progress)?;
        let field = SpreadField::solve(&graph, &labels, self.settings.contrast, &solving)?;
        Ok(SolvedSpread { task: self, field: Arc::new(field) })
    }

    /// Solves for the reach of its settings only, with the same bits: a quarter of the work.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_at_reach(self, progress: &dyn Progress) -> Result<SolvedSpread, DocumentError> {
        let (graph, labels, solving) = self.prepare(progress)?;
        let field = SpreadField::solve_at_reach(&graph, &labels, &self.settings, &solving)?;
        Ok(SolvedSpread { task: self, field: Arc::new(field) })
    }

    /// The surface, the labels of the strokes, and the stage of the solve.
    fn prepare<'a>(
        &self,
        progress: &'a dyn Progress,
    ) -> Result<(Arc<SurfaceGraph>, SpreadLabels, Stage<'a>), DocumentError> {
        let graph = self.stage.surface_graph(&Stage::new(progress, 0.0, 0.3))?;
        let labels = SpreadLabels::from_strokes(&self.stage.canvas, &self.strokes);
        Ok((graph, labels, Stage::named(progress, "spreading", 0.3, 1.0)))
    }

    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.stage, &other.stage)
            && self.settings.contrast == other.settings.contrast
            && self.strokes == other.strokes
    }
}

impl SolvedSpread {
    /// Whether a task is solved by it.
    pub(crate) fn solves(&self, task: &SpreadTask) -> bool {
        self.task.is_same(task) && self.field.is_solved_at(task.settings.reach)
    }
}

impl From<SpreadError> for DocumentError {
    fn from(error: SpreadError) -> Self {
        match error {
            SpreadError::Cancelled => Self::Cancelled,
            SpreadError::NoSeeds | SpreadError::TooManyLabels { .. } => {
                Self::BadInput(format!("spread: {error}"))
            }
        }
    }
}
