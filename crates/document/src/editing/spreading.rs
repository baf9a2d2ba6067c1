//! Strokes of a layer, spread to all that hangs together with them.
//!
//! What takes long is a [`SpreadTask`], which needs no document and can run in the background. Once its
//! [`SolvedSpread`] is kept, the layer follows its settings at once.

use crate::error::DocumentError;
use crate::open_document::Document;
use crate::spread_task::{SolvedSpread, SpreadTask};
use focus::{ChangedTexels, FocusLayer, FocusMap, Spread, SpreadSettings};
use progress::Unwatched;
use project::{RecordedSpread, RecordedStep};

impl Document {
    /// What has to be solved before a layer, by its index from the bottom, can be spread by some settings.
    ///
    /// # Errors
    /// There is no such layer, its values follow from a rule, or the settings are invalid.
    pub fn spread_task(&self, layer: usize, settings: &SpreadSettings) -> Result<SpreadTask, DocumentError> {
        if !settings.is_valid() {
            let message = "spread: reach must be in [2, 32768], softness in [0, 1], contrast in [0.005, 1]";
            return Err(DocumentError::BadInput(message.into()));
        }
        let Some(layer) = self.layers.layers().get(layer) else {
            return Err(DocumentError::BadInput("spread: there is no such layer (choose another)".into()));
        };
        if layer.adjustment.is_some() {
            let message = "its values follow from a rule and cannot be spread (choose a painted layer)";
            return Err(DocumentError::BadInput(format!("{}: {message}", layer.name)));
        }
        Ok(SpreadTask { stage: self.stage.clone(), strokes: strokes_of(layer).clone(), settings: *settings })
    }

    /// Whether a layer can be spread at once, because its strokes are solved for.
    pub fn is_spread_solved(&self, task: &SpreadTask) -> bool {
        self.solved_spread.as_ref().is_some_and(|solved| solved.solves(task))
    }

    /// Whether some reach of the same strokes is solved for.
    pub fn has_solved_strokes(&self, task: &SpreadTask) -> bool {
        self.solved_spread.as_ref().is_some_and(|solved| solved.task.is_same(task))
    }

    /// Keeps what was solved for, to be spread at once, in place of what was kept before.
    pub fn keep_solved_spread(&mut self, solved: SolvedSpread) {
        self.solved_spread = Some(solved);
    }

    /// Spreads the strokes of a layer, and keeps them; a layer that is spread follows the new settings. Solves first, if
    /// that is not done. Returns the texels of the layer that changed, or `None` if nothing did.
    ///
    /// # Errors
    /// Those of [`Self::spread_task`], or nothing is painted on the layer.
    pub fn spread(
        &mut self,
        layer: usize,
        settings: SpreadSettings,
    ) -> Result<Option<ChangedTexels>, DocumentError> {
        let task = self.spread_task(layer, &settings)?;
        if !self.is_spread_solved(&task) {
            self.solved_spread = Some(task.solve_at_reach(&Unwatched)?);
        }
        let Some(field) = self.solved_spread.as_ref().map(|solved| solved.field.clone()) else {
            return Ok(None);
        };
        let record =
            RecordedSpread { layer: self.layers.layers()[layer].name.clone(), settings: Some(settings) };
        let mut changed_texels = ChangedTexels::default();
        let changed =
            self.change_layers("Spread", Some(RecordedStep::Spread(record)), |layers, document| {
                let Some(layer) = layers.layer_mut(layer) else { return Ok(()) };
                let strokes = strokes_of(layer).clone();
                changed_texels = field.write(&document.stage.canvas, &settings, &mut layer.map);
                layer.map.background_mask = strokes.background_mask;
                layer.spread = Some(Spread { strokes, settings });
                Ok(())
            })?;
        Ok(changed.then_some(changed_texels))
    }

    /// Shows the strokes of a layer again as they were painted, to be painted on. Returns whether anything changed.
    ///
    /// # Errors
    /// The layer is not spread.
    pub fn show_strokes(&mut self, layer: usize) -> Result<bool, DocumentError> {
        let spread = self.layers.layers().get(layer).and_then(|layer| layer.spread.as_ref());
        let Some(spread) = spread else {
            return Err(DocumentError::BadInput("spread: the layer is not spread (spread it first)".into()));
        };
        let map = spread.strokes.clone();
        let record = RecordedSpread { layer: self.layers.layers()[layer].name.clone(), settings: None };
        self.change_layers("Show strokes", Some(RecordedStep::Spread(record)), |layers, _| {
            if let Some(layer) = layers.layer_mut(layer) {
                (layer.map, layer.spread) = (map, None);
            }
            Ok(())
        })
    }
}

/// The strokes of a layer: what it was spread from, or else itself.
fn strokes_of(layer: &FocusLayer) -> &FocusMap {
    layer.spread.as_ref().map_or(&layer.map, |spread| &spread.strokes)
}
