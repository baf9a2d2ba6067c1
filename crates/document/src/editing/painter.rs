//! A stroke in progress on a document, live or from a recording.

use crate::editing::paintable::paintable_channels;
use crate::editing::stroke_point::{StrokePoint, StrokeTarget};
use crate::error::DocumentError;
use crate::open_document::Document;
use crate::picking::{SurfaceHit, pick, view_ray};
use focus::{Brush, ChangedTexels, PenSample, Stroke, ViewFrame};
use glam::DVec2;
use project::{RecordedStep, RecordedStroke, StrokeView};

/// A stroke in progress and its record.
pub struct Painter {
    stroke: Stroke,
    record: RecordedStroke,
    /// Whether the whole stroke was painted in the record's view; otherwise it is not recorded.
    is_recordable: bool,
}

impl Painter {
    /// Begins a stroke with the document's brush on its active layer. Nothing is painted yet.
    ///
    /// # Errors
    /// The layer cannot be painted on, or the brush is invalid.
    pub fn begin(document: &Document, point: &StrokePoint) -> Result<Self, DocumentError> {
        let layer = document.layers.active();
        let channels = paintable_channels(layer, document.brush.channels)?;
        let hit = surface_under(document, point);
        let brush = Brush { channels, ..document.brush_at(hit.as_ref()) };
        let stroke = Stroke::begin(&layer.map, document.stage.canvas.clone(), brush.clone())?;
        let stroke = stroke.with_selection(document.selection.clone());
        let view = match point.target {
            StrokeTarget::View(view, _) => Some(StrokeView::Scene(view)),
            StrokeTarget::Atlas(_) => Some(StrokeView::Atlas { atlas: document.stage.atlas.hash.clone() }),
            StrokeTarget::Ray(_) => None,
        };
        let is_recordable = view.is_some();
        let shot_camera = &document.camera;
        let placeholder_view = ViewFrame::from_camera(shot_camera);
        let record = RecordedStroke {
            layer: layer.name.clone(),
            brush,
            view: view.unwrap_or(placeholder_view.into()),
            points: Vec::new(),
        };
        Ok(Self { stroke, record, is_recordable })
    }

    /// Continues the stroke to the next point. Returns what changed in the layer.
    pub fn extend(&mut self, document: &mut Document, point: &StrokePoint) -> ChangedTexels {
        let hit = surface_under(document, point);
        match (point.target, &self.record.view) {
            (StrokeTarget::View(view, position), StrokeView::Scene(recorded_view))
                if view == *recorded_view =>
            {
                self.record_point(position, point)
            }
            (StrokeTarget::Atlas(position), StrokeView::Atlas { .. }) => self.record_point(position, point),
            _ => self.is_recordable = false,
        }
        let Some(hit) = hit else {
            self.stroke.lift();
            return ChangedTexels::default();
        };
        let triangle_normal = document.stage.scene.area_normal(hit.point.triangle).try_normalize();
        let hit = focus::SurfaceHit { position: hit.position, normal: triangle_normal.map(|n| n.as_vec3()) };
        let pen = PenSample { pressure: point.pressure as f64 };
        self.stroke.extend(&mut document.layers.active_mut().map, hit, pen)
    }

    fn record_point(&mut self, position: DVec2, point: &StrokePoint) {
        self.record.points.push([position.x, position.y, point.pressure as f64]);
    }

    /// Ends the stroke as one undo step, unless nothing changed. Returns whether anything changed.
    pub fn commit(self, document: &mut Document) -> bool {
        let Some(edit) = self.stroke.commit(&document.layers.active().map) else { return false };
        let record = self.is_recordable.then_some(RecordedStep::Stroke(self.record));
        document.undo.push_paint(document.layers.active_index(), edit, record);
        document.revision += 1;
        true
    }

    /// Cancels the stroke and restores the layer. Returns what changed in the layer.
    pub fn abort(self, document: &mut Document) -> ChangedTexels {
        self.stroke.abort(&mut document.layers.active_mut().map)
    }
}

/// The surface under a point of a stroke, if any.
fn surface_under(document: &Document, point: &StrokePoint) -> Option<SurfaceHit> {
    let tracer = document.stage.tracer();
    match point.target {
        StrokeTarget::Ray(ray) => pick(tracer, &ray),
        StrokeTarget::View(view, position) => pick(tracer, &view_ray(&view, position)),
        StrokeTarget::Atlas(position) => document.stage.surface_at(position),
    }
}
