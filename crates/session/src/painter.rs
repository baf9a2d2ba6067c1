//! A stroke being painted on a document, live or from a recording.

use crate::document::Document;
use crate::picking::{pick, view_ray};
use crate::{SessionError, StrokePoint, StrokeTarget};
use focus::{Brush, Changed, Channels, FocusLayer, PenSample, Stroke};
use project::{RecordedStroke, ViewFrame};

/// A stroke and its record.
pub(crate) struct Painter {
    stroke: Stroke,
    record: RecordedStroke,
    /// Whether all of it was painted in the record's view: else there is nothing to record.
    is_recordable: bool,
}

impl Painter {
    /// Begins a stroke with the document's brush on its active layer. Nothing is painted yet.
    pub fn begin(document: &Document, point: &StrokePoint) -> Result<Self, SessionError> {
        let layer = document.layers.active();
        let channels = paintable(layer, document.brush.channels)?;
        let brush = Brush { channels, ..document.brush.clone() };
        let stroke = Stroke::begin(&layer.map, document.stage.canvas.clone(), brush.clone())
            .map_err(|error| SessionError::BadInput(error.to_string()))?;
        let view = match point.at {
            StrokeTarget::View(view, _) => Some(view),
            StrokeTarget::Ray(_) | StrokeTarget::Surface(_) => None,
        };
        let shot = &document.camera;
        let unseen =
            ViewFrame { camera_to_world: shot.camera_to_world, yfov: shot.yfov, aspect: shot.aspect() };
        let record = RecordedStroke {
            layer: layer.name.clone(),
            brush,
            view: view.unwrap_or(unseen),
            points: Vec::new(),
        };
        Ok(Self { stroke, record, is_recordable: view.is_some() })
    }

    /// Draws on to the next point. What changed in the layer.
    pub fn extend(&mut self, document: &mut Document, point: &StrokePoint) -> Changed {
        let hit = match point.at {
            StrokeTarget::Surface(hit) => Some(hit),
            StrokeTarget::Ray(ray) => pick(&document.stage.tracer, &ray),
            StrokeTarget::View(view, position) => pick(&document.stage.tracer, &view_ray(&view, position)),
        };
        match point.at {
            StrokeTarget::View(view, at) if view == self.record.view => {
                self.record.points.push([at.x, at.y, point.pressure as f64]);
            }
            _ => self.is_recordable = false,
        }
        let Some(hit) = hit else {
            self.stroke.lift();
            return Changed::default();
        };
        let front = document.stage.scene.area_normal(hit.point.triangle).try_normalize();
        let hit = focus::SurfaceHit { position: hit.position, normal: front.map(|n| n.as_vec3()) };
        let pen = PenSample { pressure: point.pressure as f64 };
        self.stroke.extend(&mut document.layers.active_mut().map, hit, pen)
    }

    /// Ends the stroke: one step of undo, or nothing if it changed nothing. Whether it changed anything.
    pub fn commit(self, document: &mut Document) -> bool {
        let Some(edit) = self.stroke.commit(&document.layers.active().map) else { return false };
        let record = self.is_recordable.then_some(self.record);
        document.undo.push_stroke(document.layers.active_index(), edit, record);
        document.revision += 1;
        true
    }

    /// Takes the stroke back. What changed in the layer.
    pub fn abort(self, document: &mut Document) -> Changed {
        self.stroke.abort(&mut document.layers.active_mut().map)
    }
}

/// Paints recorded strokes on a document, each on the layer of its name, as steps of undo. The document's brush stays
/// what it was.
pub fn replay(document: &mut Document, strokes: &[RecordedStroke]) -> Result<usize, SessionError> {
    let brush = document.brush.clone();
    let mut painted = 0;
    for (index, stroke) in strokes.iter().enumerate() {
        let error = |what: String| SessionError::BadInput(format!("stroke {}: {what}", index + 1));
        let layers = document.layers.layers();
        let Some(layer) = layers.iter().position(|layer| layer.name == stroke.layer) else {
            let names: Vec<_> = layers.iter().map(|layer| format!("\"{}\"", layer.name)).collect();
            let there_are = names.join(", ");
            return Err(error(format!("no layer is called \"{}\" (there are {there_are})", stroke.layer)));
        };
        document.layers.activate(layer);
        document.brush = stroke.brush.clone();
        let points: Vec<_> = stroke
            .points
            .iter()
            .map(|&[x, y, pressure]| StrokePoint {
                at: StrokeTarget::View(stroke.view, glam::DVec2::new(x, y)),
                pressure: pressure as f32,
            })
            .collect();
        let Some(first) = points.first() else { continue };
        let mut painter = Painter::begin(document, first).map_err(|e| error(e.to_string()))?;
        for point in &points {
            let changed = painter.extend(document, point);
            document.recomposite(Some(&changed));
        }
        painted += usize::from(painter.commit(document));
    }
    document.brush = brush;
    Ok(painted)
}

/// What a brush with these channels touches of a layer: of an adjustment layer only its mask can be painted.
pub(crate) fn paintable(layer: &FocusLayer, channels: Channels) -> Result<Channels, SessionError> {
    let bad = |what: String| Err(SessionError::BadInput(what));
    let name = &layer.name;
    if !layer.is_visible {
        return bad(format!("{name}: the layer is hidden (show it, or choose another one)"));
    }
    let channels = if layer.curve.is_some() { Channels::Mask } else { channels };
    if channels == Channels::Mask && !layer.map.has_mask() {
        return bad(format!("{name}: the layer has no mask to paint (add one in the Layers panel)"));
    }
    Ok(channels)
}
