//! Strokes and fills.

use super::Session;
use crate::painter::{Painter, paintable};
use crate::{Event, FillRegion, LayerEdit, SessionError, Stage, StrokePoint, SurfaceHit};
use focus::{Channels, Edit, FillTarget, FocusMap, LayerStack, fill};
use lens::{Camera, FocusOffset};

impl Session {
    pub(super) fn begin_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        if self.stroke.is_some() {
            self.commit_stroke()?;
        }
        self.stroke = Some(Painter::begin(self.opened()?, &point)?);
        self.extend_stroke(point)
    }

    pub(super) fn extend_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        let Some(stroke) = &mut self.stroke else { return Ok(()) };
        let changed = stroke.extend(document, &point);
        self.show_layers(Some(changed))
    }

    pub(super) fn commit_stroke(&mut self) -> Result<(), SessionError> {
        let Some(stroke) = self.stroke.take() else { return Ok(()) };
        if stroke.commit(self.opened()?) {
            self.preview_thread.settle();
        }
        Ok(())
    }

    pub(super) fn abort_stroke(&mut self) -> Result<(), SessionError> {
        let Some(stroke) = self.stroke.take() else { return Ok(()) };
        let changed = stroke.abort(self.opened()?);
        self.show_layers(Some(changed))
    }

    pub(super) fn fill(&mut self, region: FillRegion, focus: FocusOffset) -> Result<(), SessionError> {
        let stage = self.opened()?.stage.clone();
        let part_of = |hit: SurfaceHit| stage.scene.triangles[hit.point.triangle as usize].part;
        let (name, target) = match region {
            FillRegion::Node(hit) => {
                ("Fill object", FillTarget::Node(stage.scene.parts[part_of(hit) as usize].node))
            }
            FillRegion::Part(hit) => ("Fill part", FillTarget::Part(part_of(hit))),
            FillRegion::Material(hit) => {
                ("Fill material", FillTarget::Material(stage.scene.parts[part_of(hit) as usize].material))
            }
            FillRegion::Chart(hit) => {
                ("Fill chart", FillTarget::Chart(stage.atlas.chart_of[hit.point.triangle as usize]))
            }
            FillRegion::All => ("Fill everything", FillTarget::Everything),
        };
        self.fill_target(name, target, focus)
    }

    pub(super) fn fill_target(
        &mut self,
        name: &str,
        target: FillTarget,
        focus: FocusOffset,
    ) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        let channels = paintable(document.layers.active(), Channels::Both)?;
        let canvas = document.stage.canvas.clone();
        let map = &mut document.layers.active_mut().map;
        let before = map.clone();
        let changed = fill(map, &canvas, target, focus, channels)
            .map_err(|error| SessionError::BadInput(error.to_string()))?;
        let Some(edit) = Edit::between(name, &before, map) else { return Ok(()) };
        document.undo.push_paint(document.layers.active_index(), edit);
        document.revision += 1;
        self.show_layers(Some(changed))
    }

    pub(super) fn reset_map(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let [width, height] = self.opened()?.map.size();
        let blank = FocusMap::new(width, height, FocusOffset::STANDARD);
        self.change_layers("Reset all paint", false, |layers, _, _| {
            *layers = LayerStack::of(blank);
            Ok(())
        })
    }

    /// Puts a map in the place of the active layer's values, or above it where those come from a curve.
    pub(super) fn import_map(&mut self, map: FocusMap) -> Result<(), SessionError> {
        self.change_layers("Import focus", false, |layers, stage, camera| {
            if layers.active().curve.is_some() {
                LayerEdit::AddPaint.apply(layers, stage, camera)?;
            }
            layers.active_mut().map = map;
            Ok(())
        })
    }

    pub(super) fn edit_layers(&mut self, edit: LayerEdit) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let (name, joins) = (edit.name(), edit.joins_runs());
        self.change_layers(name, joins, |layers, stage, camera| edit.apply(layers, stage, camera))
    }

    pub(super) fn activate_layer(&mut self, index: usize) -> Result<(), SessionError> {
        self.commit_stroke()?;
        self.opened()?.layers.activate(index);
        self.events.push(Event::LayersChanged);
        Ok(())
    }

    /// Changes the layers as one step of undo. A change that fails, or changes nothing, leaves no trace.
    fn change_layers(
        &mut self,
        name: &'static str,
        joins: bool,
        change: impl FnOnce(&mut LayerStack, &Stage, &Camera) -> Result<(), SessionError>,
    ) -> Result<(), SessionError> {
        let document = self.opened()?;
        let before = document.layers.clone();
        let mut after = before.clone();
        change(&mut after, &document.stage, &document.camera)?;
        if after == before {
            return Ok(());
        }
        document.layers = after.clone();
        document.curves_for = document.camera.camera_to_world;
        document.undo.push_layers(name, before, after, joins);
        document.revision += 1;
        self.events.push(Event::LayersChanged);
        self.show_layers(None)
    }
}
