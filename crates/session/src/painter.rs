//! A stroke being painted on a document, live or from a recording.

use crate::document::Document;
use crate::picking::{pick, view_ray};
use crate::{SessionError, StrokePoint, StrokeTarget, SurfaceHit};
use focus::{Brush, Changed, Channels, FocusLayer, FocusMap, Gradient, PenSample, Stroke, ViewFrame};
use glam::DVec2;
use project::{RecordedStep, RecordedStroke, StrokeView};

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
        let hit = hit_of(document, point);
        let brush = Brush { channels, ..document.brush_at(hit.as_ref()) };
        let stroke = Stroke::begin(&layer.map, document.stage.canvas.clone(), brush.clone())?;
        let stroke = stroke.within(document.selection.clone());
        let view = match point.at {
            StrokeTarget::View(view, _) => Some(StrokeView::Scene(view)),
            StrokeTarget::Atlas(_) => Some(StrokeView::Atlas { atlas: document.stage.atlas.hash.clone() }),
            StrokeTarget::Ray(_) | StrokeTarget::Surface(_) => None,
        };
        let is_recordable = view.is_some();
        let shot = &document.camera;
        let unseen =
            ViewFrame { camera_to_world: shot.camera_to_world, yfov: shot.yfov, aspect: shot.aspect() };
        let record = RecordedStroke {
            layer: layer.name.clone(),
            brush,
            view: view.unwrap_or(unseen.into()),
            points: Vec::new(),
        };
        Ok(Self { stroke, record, is_recordable })
    }

    /// Draws on to the next point. What changed in the layer.
    pub fn extend(&mut self, document: &mut Document, point: &StrokePoint) -> Changed {
        let hit = hit_of(document, point);
        match (point.at, &self.record.view) {
            (StrokeTarget::View(view, at), StrokeView::Scene(own)) if view == *own => self.note(at, point),
            (StrokeTarget::Atlas(at), StrokeView::Atlas { .. }) => self.note(at, point),
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

    fn note(&mut self, at: DVec2, point: &StrokePoint) {
        self.record.points.push([at.x, at.y, point.pressure as f64]);
    }

    /// Ends the stroke: one step of undo, or nothing if it changed nothing. Whether it changed anything.
    pub fn commit(self, document: &mut Document) -> bool {
        let Some(edit) = self.stroke.commit(&document.layers.active().map) else { return false };
        let record = self.is_recordable.then_some(RecordedStep::Stroke(self.record));
        document.undo.push_paint(document.layers.active_index(), edit, record);
        document.revision += 1;
        true
    }

    /// Takes the stroke back. What changed in the layer.
    pub fn abort(self, document: &mut Document) -> Changed {
        self.stroke.abort(&mut document.layers.active_mut().map)
    }
}

/// The surface under a point of a stroke.
fn hit_of(document: &Document, point: &StrokePoint) -> Option<SurfaceHit> {
    let tracer = &document.stage.tracer;
    match point.at {
        StrokeTarget::Surface(hit) => Some(hit),
        StrokeTarget::Ray(ray) => pick(tracer, &ray),
        StrokeTarget::View(view, position) => pick(tracer, &view_ray(&view, position)),
        StrokeTarget::Atlas(position) => document.stage.surface_at(position),
    }
}

/// A gradient being drawn: drawn anew from what was there, until it pleases.
pub(crate) struct GradientInHand {
    before: FocusMap,
    gradient: Gradient,
}

impl GradientInHand {
    /// Draws the first one.
    pub fn begin(document: &mut Document, gradient: Gradient) -> Result<Self, SessionError> {
        let before = document.layers.active().map.clone();
        document.draw_gradient(&before, &gradient)?;
        Ok(Self { before, gradient })
    }

    /// Draws another one in its place.
    pub fn change(&mut self, document: &mut Document, gradient: Gradient) -> Result<(), SessionError> {
        document.draw_gradient(&self.before, &gradient)?;
        self.gradient = gradient;
        Ok(())
    }

    /// Ends it: one step of undo, or nothing if it changed nothing. Whether it changed anything.
    pub fn commit(self, document: &mut Document) -> bool {
        document.finish_gradient(&self.before, self.gradient)
    }

    /// Takes it back.
    pub fn abort(self, document: &mut Document) {
        document.layers.active_mut().map = self.before;
    }
}

/// What is being painted and is no step of undo yet.
pub(crate) enum Underway {
    /// A stroke.
    Stroke(Box<Painter>),
    /// A gradient.
    Gradient(Box<GradientInHand>),
}

/// Does recorded steps on a document, each on the layer of its name, as steps of undo. The document's brush stays
/// what it was. Returns how many changed anything.
pub fn replay(document: &mut Document, steps: &[RecordedStep]) -> Result<usize, SessionError> {
    let brush = document.brush.clone();
    let mut done = 0;
    for (index, step) in steps.iter().enumerate() {
        let changed = redo(document, step)
            .map_err(|error| SessionError::BadInput(format!("step {}: {error}", index + 1)))?;
        done += usize::from(changed);
    }
    document.brush = brush;
    Ok(done)
}

/// Does one recorded step. Whether it changed anything.
pub(crate) fn redo(document: &mut Document, step: &RecordedStep) -> Result<bool, SessionError> {
    let before = document.undo.names().count();
    match step {
        RecordedStep::Stroke(stroke) => {
            activate(document, &stroke.layer)?;
            return draw(document, stroke);
        }
        RecordedStep::Fill(fill) => {
            activate(document, &fill.layer)?;
            document.fill(fill.targets.clone(), fill.focus)?;
        }
        RecordedStep::Gradient(drawn) => {
            activate(document, &drawn.layer)?;
            GradientInHand::begin(document, drawn.gradient)?.commit(document);
        }
        RecordedStep::Select(selection) => {
            return document.select(selection.shape.clone(), selection.combine);
        }
        RecordedStep::Layers(edit) => {
            document.edit_layers(edit.clone())?;
        }
        RecordedStep::Mask => {
            document.mask_selected()?;
        }
        RecordedStep::Reset => {
            document.reset_map()?;
        }
    }
    document.recomposite(None);
    Ok(document.undo.names().count() != before)
}

/// Paints on the layer of this name from now on.
fn activate(document: &mut Document, name: &str) -> Result<(), SessionError> {
    let layers = document.layers.layers();
    let Some(layer) = layers.iter().position(|layer| layer.name == name) else {
        let names: Vec<_> = layers.iter().map(|layer| format!("\"{}\"", layer.name)).collect();
        let there_are = names.join(", ");
        let what = format!("no layer is called \"{name}\" (there are {there_are})");
        return Err(SessionError::BadInput(what));
    };
    document.layers.activate(layer);
    Ok(())
}

/// Paints a recorded stroke on the active layer. Whether it changed anything.
fn draw(document: &mut Document, stroke: &RecordedStroke) -> Result<bool, SessionError> {
    if let StrokeView::Atlas { atlas } = &stroke.view
        && *atlas != document.stage.atlas.hash
    {
        let what = "the stroke was painted in another atlas (replay it on the project it was recorded on)";
        return Err(SessionError::BadInput(what.into()));
    }
    document.brush = stroke.brush.clone();
    let mut points = stroke.points.iter().map(|point| StrokePoint::recorded(&stroke.view, point));
    let Some(first) = points.next() else { return Ok(false) };
    let mut painter = Painter::begin(document, &first)?;
    for point in std::iter::once(first).chain(points) {
        let changed = painter.extend(document, &point);
        document.recomposite(Some(&changed));
    }
    Ok(painter.commit(document))
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
