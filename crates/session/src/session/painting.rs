//! Strokes and fills.

use super::Session;
use crate::picking::pick;
use crate::{FillRegion, SessionError, StrokePoint, StrokeTarget, SurfaceHit};
use focus::{Changed, Channels, Edit, FillTarget, FocusMap, PenSample, Stroke, fill};
use lens::FocusOffset;

impl Session {
    pub(super) fn begin_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        if self.stroke.is_some() {
            self.commit_stroke()?;
        }
        let document = self.opened()?;
        let stroke = Stroke::begin(&document.map, document.stage.canvas.clone(), document.brush.clone());
        self.stroke = Some(stroke.map_err(|error| SessionError::BadInput(error.to_string()))?);
        self.extend_stroke(point)
    }

    pub(super) fn extend_stroke(&mut self, point: StrokePoint) -> Result<(), SessionError> {
        let Some(document) = &mut self.document else { return Err(SessionError::NothingOpen) };
        let Some(stroke) = &mut self.stroke else { return Ok(()) };
        let hit = match point.at {
            StrokeTarget::Surface(hit) => Some(hit),
            StrokeTarget::Ray(ray) => pick(&document.stage.tracer, &ray),
        };
        let Some(hit) = hit else {
            stroke.lift();
            return Ok(());
        };
        let front = document.stage.scene.area_normal(hit.point.triangle).try_normalize();
        let hit = focus::SurfaceHit { position: hit.position, normal: front.map(|n| n.as_vec3()) };
        let changed = stroke.extend(&mut document.map, hit, PenSample { pressure: point.pressure as f64 });
        self.show_paint(changed, false)
    }

    pub(super) fn commit_stroke(&mut self) -> Result<(), SessionError> {
        let Some(stroke) = self.stroke.take() else { return Ok(()) };
        let document = self.opened()?;
        if let Some(edit) = stroke.commit(&document.map) {
            document.undo.push_paint(edit);
            document.revision += 1;
            self.preview_thread.settle();
        }
        Ok(())
    }

    pub(super) fn abort_stroke(&mut self) -> Result<(), SessionError> {
        let Some(stroke) = self.stroke.take() else { return Ok(()) };
        let changed = stroke.abort(&mut self.opened()?.map);
        self.show_paint(changed, false)
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
        let before = document.map.clone();
        let changed = fill(&mut document.map, &document.stage.canvas, target, focus, Channels::Both)
            .map_err(|error| SessionError::BadInput(error.to_string()))?;
        self.finish_edit(name, &before, changed)
    }

    pub(super) fn reset_map(&mut self) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        let [width, height] = document.map.size();
        let blank = FocusMap::new(width, height, FocusOffset::STANDARD);
        self.replace_map("Reset all paint", blank)
    }

    /// Puts another map in the place of the document's, as one step of undo.
    pub(super) fn replace_map(&mut self, name: &str, map: FocusMap) -> Result<(), SessionError> {
        let document = self.opened()?;
        let Some(edit) = Edit::between(name, &document.map, &map) else { return Ok(()) };
        let texels = edit.apply(&mut document.map);
        let background = edit.changes_background();
        document.undo.push_paint(edit);
        document.revision += 1;
        self.show_paint(texels, background)
    }

    /// Takes up a change that was made to the map.
    pub(super) fn finish_edit(
        &mut self,
        name: &str,
        before: &FocusMap,
        changed: Changed,
    ) -> Result<(), SessionError> {
        let document = self.opened()?;
        let Some(edit) = Edit::between(name, before, &document.map) else { return Ok(()) };
        let background = edit.changes_background();
        document.undo.push_paint(edit);
        document.revision += 1;
        self.show_paint(changed, background)
    }
}
