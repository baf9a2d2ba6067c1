//! The shape of the aperture: the appearance of out-of-focus lights.

use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, row};
use document::CameraEdit;
use egui::{ComboBox, DragValue, Ui};
use lens::{Aperture, ApertureShape, Camera};
use session::Command;

/// Initial number of blades of a polygon.
const BLADES: u32 = 6;

/// Rows for the shape, in the grid of the lens panel.
pub fn shape_panel(ui: &mut Ui, camera: &Camera, actions: &mut Vec<Action>) {
    let mut aperture = camera.aperture.clone();
    let tip = "Shape of strongly out-of-focus lights.";
    row(ui, "Bokeh", tip, |ui| {
        let combo = ComboBox::from_id_salt("aperture shape").selected_text(shape_name(&aperture.shape));
        combo
            .show_ui(ui, |ui| {
                let polygon = ApertureShape::Polygon { blades: BLADES, rotation: 0.0, roundness: 0.0 };
                for shape in [ApertureShape::Disc, polygon, ApertureShape::Square] {
                    let chosen = shape_name(&shape) == shape_name(&aperture.shape);
                    if ui.selectable_label(chosen, shape_name(&shape)).clicked() && !chosen {
                        aperture.shape = shape;
                    }
                }
                if ui.selectable_label(matches!(aperture.shape, ApertureShape::Mask(_)), "Mask…").clicked()
                {
                    actions.push(Action::ChooseMask);
                }
            })
            .response
    });
    let mut responses = Vec::new();
    match &mut aperture.shape {
        ApertureShape::Polygon { blades, rotation, roundness } => {
            responses.push(row(ui, "Blades", "Number of corners of the polygon.", |ui| {
                ui.add(DragValue::new(blades).range(3..=64).speed(0.1))
            }));
            let mut degrees = rotation.to_degrees();
            let response =
                row(ui, "Rotation", "Angle of the first corner, counter-clockwise from the right.", |ui| {
                    ui.add(DragValue::new(&mut degrees).suffix("°").speed(0.5).max_decimals(1))
                });
            if response.changed() {
                *rotation = degrees.to_radians();
            }
            responses.push(response);
            responses.push(row(ui, "Roundness", "0: straight edges; 1: a disc.", |ui| {
                controls::slider(ui, egui::Slider::new(roundness, 0.0..=1.0).max_decimals(2))
            }));
        }
        ApertureShape::Mask(mask) => {
            let text = format!("{} ({} × {})", mask.file, mask.width, mask.height);
            row(ui, "Mask", &text, |ui| ui.add(egui::Label::new(&mask.file).truncate()));
        }
        ApertureShape::Disc | ApertureShape::Square => {}
    }
    let tip = "Anamorphic squeeze: the height of the shape over its width.";
    responses.push(row(ui, "Ratio", tip, |ui| {
        ui.add(DragValue::new(&mut aperture.ratio).range(0.05..=20.0).speed(0.01).max_decimals(3))
    }));
    push_aperture(camera, aperture, actions);
    for response in responses {
        finish_edit(&response, actions);
    }
}

fn push_aperture(camera: &Camera, aperture: Aperture, actions: &mut Vec<Action>) {
    if aperture != camera.aperture {
        actions.push(Command::EditCamera(CameraEdit::Aperture(aperture)).into());
    }
}

fn shape_name(shape: &ApertureShape) -> &'static str {
    match shape {
        ApertureShape::Disc => "Disc",
        ApertureShape::Polygon { .. } => "Polygon",
        ApertureShape::Square => "Square",
        ApertureShape::Mask(_) => "Mask",
    }
}
