//! A focal plane in numbers: tilt, swing, distance and curvature.

use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, format_number, row, rows};
use crate::window::widgets::keys;
use document::Document;
use egui::{DragValue, Slider, SliderClamping, Ui};
use focus::{FocalPlane, LayerEdit};
use session::{Command, CommandId};

/// Range of the sliders to either side, degrees; larger angles can be typed.
const DEGREES: f64 = 85.0;

/// Tilt, swing, distance and curvature of the plane of layer `index`.
pub fn plane_editor(
    ui: &mut Ui,
    document: &Document,
    index: usize,
    plane: &FocalPlane,
    actions: &mut Vec<Action>,
) {
    let camera = &document.camera;
    let edit = |plane: FocalPlane| Action::from(Command::EditLayers(LayerEdit::Plane(index, plane)));
    let turn = plane.tilt_and_swing(camera);
    rows(ui, "focal plane", |ui| {
        let tips = [
            ("Tilt", "Rotates the plane about the horizontal: positive brings its upper part nearer."),
            ("Swing", "Rotates the plane about the vertical: positive brings its right part nearer."),
        ];
        for (axis, (name, tip)) in tips.into_iter().enumerate() {
            let mut degrees = turn[axis].to_degrees();
            let response = row(ui, name, tip, |ui| {
                // A slider that rounds would change the plane without being moved.
                let slider = Slider::new(&mut degrees, -DEGREES..=DEGREES).suffix("°");
                let slider = slider.clamping(SliderClamping::Edits);
                controls::slider(ui, slider.custom_formatter(|n, _| format!("{n:.1}")))
            });
            if response.changed() {
                let mut target_turn = turn;
                target_turn[axis] = degrees.to_radians();
                actions.push(edit(plane.with_tilt_and_swing(camera, target_turn)));
            }
            finish_edit(&response, actions);
        }
        let mut depth = plane.depth_on_axis(camera);
        let tip = "Distance along the camera's axis at which the plane crosses it.";
        let response = row(ui, "Distance", tip, |ui| {
            let speed = depth.abs().max(1e-3) * 0.005;
            ui.add(DragValue::new(&mut depth).speed(speed).suffix(" m").custom_formatter(format_number))
        });
        if response.changed() {
            actions.push(edit(plane.with_depth_on_axis(camera, depth)));
        }
        finish_edit(&response, actions);
        let mut curvature = plane.curvature;
        let tip = "Field curvature as of a simple lens, in dioptres at the picture's upper edge: positive toward the camera \
                   all around, negative away from it.";
        let response = row(ui, "Curvature", tip, |ui| {
            ui.add(DragValue::new(&mut curvature).speed(0.005).suffix(" dpt").custom_formatter(format_number))
        });
        if response.changed() {
            actions.push(edit(FocalPlane { curvature, ..plane.clone() }));
        }
        finish_edit(&response, actions);
    });
    let id = CommandId::PlaceFocalPlane;
    if ui.button("Place by three points").on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
        actions.push(id.into());
    }
}
