//! A focal plane in numbers: how it is turned, where it stands, how it is bent.

use crate::window::controls::{finish_edit, format_number, row, rows};
use crate::window::{Action, keys};
use egui::{DragValue, Slider, SliderClamping, Ui};
use focus::{FocalPlane, LayerEdit};
use session::{Command, CommandId, Document};

/// Angles that the sliders offer, either way, degrees; more can be typed.
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
            ("Tilt", "Turns the plane about the picture's horizontal: above 0 its upper part comes nearer."),
            ("Swing", "Turns the plane about the picture's vertical: above 0 its right part comes nearer."),
        ];
        for (axis, (name, tip)) in tips.into_iter().enumerate() {
            let mut degrees = turn[axis].to_degrees();
            let response = row(ui, name, tip, |ui| {
                // A slider that rounds would turn the plane by itself.
                let slider = Slider::new(&mut degrees, -DEGREES..=DEGREES).suffix("°");
                ui.add(slider.clamping(SliderClamping::Edits).custom_formatter(|n, _| format!("{n:.1}")))
            });
            if response.changed() {
                let mut target_turn = turn;
                target_turn[axis] = degrees.to_radians();
                actions.push(edit(plane.with_tilt_and_swing(camera, target_turn)));
            }
            finish_edit(&response, actions);
        }
        let mut depth = plane.depth_on_axis(camera);
        let tip = "Where the plane crosses the middle of the picture: distance along the camera's axis.";
        let response = row(ui, "Distance", tip, |ui| {
            let speed = depth.abs().max(1e-3) * 0.005;
            ui.add(DragValue::new(&mut depth).speed(speed).suffix(" m").custom_formatter(format_number))
        });
        if response.changed() {
            actions.push(edit(plane.with_depth_on_axis(camera, depth)));
        }
        finish_edit(&response, actions);
        let mut curvature = plane.curvature;
        let tip = "Bends the plane as a simple lens does, by dioptres at the picture's upper edge: above 0 toward the camera \
                   all around, below 0 away from it.";
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
