//! Replay of recorded steps.

use crate::editing::active_gradient::ActiveGradient;
use crate::editing::painter::Painter;
use crate::editing::stroke_point::StrokePoint;
use crate::error::DocumentError;
use crate::open_document::Document;
use project::{RecordedStep, RecordedStroke, StrokeView};

/// Replays recorded steps on a document as undo steps, each on the layer of its name. The document's brush is unchanged afterwards. Returns the
/// number of steps that changed anything.
///
/// # Errors
/// Those of [`apply_recorded_step`], with the number of the step. The steps before it stay applied.
pub fn replay(document: &mut Document, steps: &[RecordedStep]) -> Result<usize, DocumentError> {
    let brush = document.brush.clone();
    let mut changed_count = 0;
    for (index, step) in steps.iter().enumerate() {
        let changed = apply_recorded_step(document, step)
            .map_err(|error| DocumentError::BadInput(format!("step {}: {error}", index + 1)))?;
        changed_count += usize::from(changed);
    }
    document.brush = brush;
    Ok(changed_count)
}

/// Replays one recorded step. Returns whether it changed anything.
///
/// # Errors
/// The step does not apply to this document: a layer is missing or cannot be painted on, or a stroke was painted in another atlas.
pub fn apply_recorded_step(document: &mut Document, step: &RecordedStep) -> Result<bool, DocumentError> {
    let undo_count = document.undo.names().count();
    match step {
        RecordedStep::Stroke(stroke) => {
            activate_layer(document, &stroke.layer)?;
            return replay_stroke(document, stroke);
        }
        RecordedStep::Fill(fill) => {
            activate_layer(document, &fill.layer)?;
            document.fill(fill.targets.clone(), fill.focus)?;
        }
        RecordedStep::Gradient(recorded) => {
            activate_layer(document, &recorded.layer)?;
            ActiveGradient::begin(document, recorded.gradient)?.commit(document);
        }
        RecordedStep::Select(selection) => {
            return document.select(selection.shape.clone(), selection.combine);
        }
        RecordedStep::Layers(edit) => {
            document.edit_layers(edit.clone())?;
        }
        RecordedStep::Spread(spread) => {
            activate_layer(document, &spread.layer)?;
            let layer = document.layers.active_index();
            match spread.settings {
                Some(settings) => {
                    document.spread(layer, settings)?;
                }
                None => {
                    document.show_strokes(layer)?;
                }
            }
        }
        RecordedStep::Mask => {
            document.mask_selected()?;
        }
        RecordedStep::Reset => {
            document.reset_map()?;
        }
    }
    document.recomposite(None);
    Ok(document.undo.names().count() != undo_count)
}

/// Makes the layer of this name the active one.
fn activate_layer(document: &mut Document, name: &str) -> Result<(), DocumentError> {
    let layers = document.layers.layers();
    let Some(layer) = layers.iter().position(|layer| layer.name == name) else {
        let names: Vec<_> = layers.iter().map(|layer| format!("\"{}\"", layer.name)).collect();
        let available = names.join(", ");
        let message = format!("no layer is called \"{name}\" (available: {available})");
        return Err(DocumentError::BadInput(message));
    };
    document.layers.activate(layer);
    Ok(())
}

/// Replays a recorded stroke on the active layer. Returns whether it changed anything.
fn replay_stroke(document: &mut Document, stroke: &RecordedStroke) -> Result<bool, DocumentError> {
    if let StrokeView::Atlas { atlas } = &stroke.view
        && *atlas != document.stage.atlas.hash
    {
        let message = "the stroke was painted in another atlas (replay it on the project it was recorded on)";
        return Err(DocumentError::BadInput(message.into()));
    }
    document.brush = stroke.brush.clone();
    let mut points = stroke.points.iter().map(|point| StrokePoint::from_recorded(&stroke.view, point));
    let Some(first) = points.next() else { return Ok(false) };
    let mut painter = Painter::begin(document, &first)?;
    for point in std::iter::once(first).chain(points) {
        let changed = painter.extend(document, &point);
        document.recomposite(Some(&changed));
    }
    Ok(painter.commit(document))
}
