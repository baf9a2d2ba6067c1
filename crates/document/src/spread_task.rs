//! Strokes to be solved for before they can be spread: work that takes long and needs no document.

use crate::error::DocumentError;
use crate::stage::Stage;
use focus::{FocusMap, SpreadField, SpreadLabels};
use progress::Progress;
use spread::SpreadError;
use std::sync::Arc;

/// What has to be solved before strokes can be spread.
#[derive(Clone)]
pub struct SpreadTask {
    pub(crate) stage: Arc<Stage>,
    pub(crate) strokes: FocusMap,
    pub(crate) contrast: f64,
}

/// Strokes that were solved for, on a surface.
#[derive(Clone)]
pub struct SolvedSpread {
    pub(crate) task: SpreadTask,
    pub(crate) field: Arc<SpreadField>,
}

impl SpreadTask {
    /// Solves it: seconds for a million texels.
    ///
    /// # Errors
    /// Nothing is painted, photographs cannot be used, or `progress` was cancelled.
    pub fn solve(self, progress: &dyn Progress) -> Result<SolvedSpread, DocumentError> {
        let graph = self.stage.surface_graph(&progress::Stage::new(progress, 0.0, 0.3))?;
        let labels = SpreadLabels::from_strokes(&self.stage.canvas, &self.strokes);
        let solving = progress::Stage::named(progress, "spreading", 0.3, 1.0);
        let field = SpreadField::solve(&graph, &labels, self.contrast, &solving)?;
        Ok(SolvedSpread { task: self, field: Arc::new(field) })
    }

    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.stage, &other.stage)
            && self.contrast == other.contrast
            && self.strokes == other.strokes
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
