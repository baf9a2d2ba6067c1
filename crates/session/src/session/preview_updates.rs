//! What changes in the document, brought to the views: camera, paint, exposure.

use crate::commands::Event;
use crate::error::SessionError;
use crate::light_field::{ApertureFit, Changes};
use crate::session::state::Session;
use document::{AdjustmentView, CameraEdit};
use focus::{ChangedTexels, rectangle_union};
use glam::DVec2;
use lens::{Aperture, Camera};
use std::collections::BTreeMap;

impl Session {
    pub(super) fn edit_camera(&mut self, edit: CameraEdit) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let before = document.held_camera();
        let (name, after) = before.edited(edit, &document.stage.scene);
        after.camera.validate().map_err(|error| SessionError::BadInput(error.to_string()))?;
        if after == before {
            return Ok(());
        }
        document.set_held_camera(after.clone());
        document.undo.push_camera(name, before, after);
        document.revision += 1;
        self.events.push(Event::CameraChanged);
        self.show_camera();
        self.update_adjustment_layers()
    }

    /// Makes the shot camera that of a bookmark: an undo step.
    pub(super) fn go_to_bookmark(&mut self, number: usize) -> Result<(), SessionError> {
        let Some(held) = self.document_mut()?.bookmark(number) else {
            return Err(SessionError::BadInput(format!("there is no bookmark {}", number + 1)));
        };
        self.edit_camera(CameraEdit::Held(held.into()))?;
        self.document_mut()?.undo.finish_run();
        Ok(())
    }

    /// Adjustment layers follow the shot camera.
    pub(super) fn update_adjustment_layers(&mut self) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        if !document.layers.follows_camera()
            || document.adjustment_view == AdjustmentView::from_camera(&document.camera)
        {
            return Ok(());
        }
        document.evaluate_adjustments();
        self.show_layers(None)
    }

    /// Brings the map up to date after a change of layers (of these texels, or of whatever) and shows it.
    pub(super) fn show_layers(&mut self, changed: Option<ChangedTexels>) -> Result<(), SessionError> {
        let (changed, background) = self.document_mut()?.recomposite(changed.as_ref());
        self.show_paint(changed, background)
    }

    /// Shows the whole map in the views.
    pub(super) fn show_everything(&mut self) -> Result<(), SessionError> {
        let map = self.document_mut()?.map.clone();
        self.map_serial += 1;
        self.map_changes = BTreeMap::from([([0; 2], [0..map.width(), 0..map.height()])]);
        self.preview_thread.set_map((map, self.map_serial), &Changes::Everything);
        self.preview_thread.edit_done();
        Ok(())
    }

    /// Shows changed texels in the views.
    pub(super) fn show_paint(
        &mut self,
        changed: ChangedTexels,
        background: bool,
    ) -> Result<(), SessionError> {
        if changed.is_empty() && !background {
            return Ok(());
        }
        for (tile, rectangle) in changed.rectangles() {
            let merged = self.map_changes.entry(tile).or_insert_with(|| rectangle.clone());
            *merged = rectangle_union(merged, &rectangle);
        }
        let changes = if background { Changes::Everything } else { Changes::Texels(changed.texels) };
        self.map_serial += 1;
        let map = self.document_mut()?.map.clone();
        self.preview_thread.set_map((map, self.map_serial), &changes);
        if self.active_edit.is_none() {
            self.preview_thread.edit_done();
        }
        Ok(())
    }

    /// Shows the preview by the document's exposure.
    pub(super) fn show_tone(&self) {
        self.preview_thread.set_tone(self.tone());
    }

    /// Shows the camera in the preview.
    pub(super) fn show_camera(&mut self) {
        let Some(document) = &self.document else { return };
        let camera = self.preview_camera_from(&document.camera);
        let fit = self.preview_camera.as_ref().and_then(|before| ApertureFit::new(before, &camera));
        self.preview_camera = Some(camera.clone());
        self.preview_thread.set_camera(camera, fit);
    }

    /// Shows the scene through one aperture point, or through all of the aperture again.
    pub(super) fn set_sub_aperture(&mut self, point: Option<DVec2>) {
        if self.sub_aperture_point != point {
            self.sub_aperture_point = point;
            self.show_camera();
        }
    }

    /// What the preview shows of a camera: its size, through what is looked through.
    pub(super) fn preview_camera_from(&self, camera: &Camera) -> Camera {
        let scaled = self.scaled_camera(camera);
        match self.sub_aperture_point {
            Some(point) => Camera { aperture: Aperture::sub_aperture(point), ..scaled },
            None => scaled,
        }
    }

    /// A camera scaled to the preview's size.
    pub(super) fn scaled_camera(&self, camera: &Camera) -> Camera {
        scale_to_fit(camera, self.options.preview_size)
    }
}

/// A camera scaled so that no side of its picture is longer.
pub(super) fn scale_to_fit(camera: &Camera, longest_px: u32) -> Camera {
    let longest = camera.width.max(camera.height);
    let scale = (longest_px as f64 / longest as f64).min(1.0);
    let scaled = |side: u32| ((side as f64 * scale).round() as u32).max(1);
    Camera { width: scaled(camera.width), height: scaled(camera.height), ..camera.clone() }
}
