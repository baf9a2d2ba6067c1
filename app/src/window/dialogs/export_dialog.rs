//! What is exported of the picture: its size, the kind of file, and its layers.

use crate::window::widgets::controls::{row, rows, set_accessible_name};
use egui::{Button, Context, DragValue, Id, Key, Modifiers, Ui};
use lens::Camera;
use render::Aov;
use session::PictureExport;

/// Layers that an EXR can hold beside the picture.
const LAYERS: [(Aov, &str, &str); 3] = [
    (Aov::Depth, "Depth", "Distance along the camera's axis to the first surface, in scene units."),
    (
        Aov::CircleOfConfusion,
        "Circle of confusion",
        "Diameter of the blur of the first surface, px, signed: negative in front.",
    ),
    (Aov::Focus, "Painted focus", "The focus offset t and the anchor of the first surface."),
];

/// Sizes that are one click away, percent of the camera's.
const PERCENTAGES: [u32; 4] = [50, 100, 200, 400];

/// Width of the dialog, and of the fields of its sides, points.
const WIDTH: f32 = 430.0;
const SIDE_FIELD: f32 = 64.0;

/// The choices that are being made.
#[derive(Clone, Debug)]
struct Choices {
    /// The camera's size, px.
    camera_size: [u32; 2],
    size: [u32; 2],
    is_exr: bool,
    layers: Vec<Aov>,
    /// File name without extension.
    stem: String,
}

/// The dialog; empty while closed.
#[derive(Default)]
pub struct ExportDialog {
    pending: Option<Choices>,
    /// The kind of file and the layers that were chosen last.
    last: Option<(bool, Vec<Aov>)>,
}

impl ExportDialog {
    /// Opens the dialog for the picture of `camera`, to be written to a file of this name without extension.
    pub fn open(&mut self, camera: &Camera, stem: String) {
        let size = [camera.width, camera.height];
        let (is_exr, layers) = self.last.clone().unwrap_or_default();
        self.pending = Some(Choices { camera_size: size, size, is_exr, layers, stem });
    }

    /// Whether the dialog is open.
    pub fn is_open(&self) -> bool {
        self.pending.is_some()
    }

    /// Draws the dialog; `note` says what has to be computed for a picture of a size. Once accepted, returns what is exported, and the
    /// suggested file name.
    pub fn show(
        &mut self,
        context: &Context,
        note: impl Fn([u32; 2]) -> String,
    ) -> Option<(PictureExport, String)> {
        let choices = self.pending.as_mut()?;
        let (mut accepted, mut cancelled) = (false, false);
        let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
        let modal = egui::Modal::new(Id::unique("export picture")).frame(frame).show(context, |ui| {
            ui.set_width(WIDTH.min(context.content_rect().width() - 40.0));
            ui.heading("Export the picture");
            ui.add_space(6.0);
            rows(ui, "export", |ui| {
                row(ui, "Size", "Columns and rows, px; the camera's proportions stay.", |ui| {
                    size_row(ui, choices)
                });
                row(ui, "File", "What programs expect.", |ui| format_row(ui, choices));
                if choices.is_exr {
                    row(ui, "Layers", "Further layers of the file.", |ui| layers_row(ui, choices));
                }
                row(ui, "Name", "The file is chosen next.", |ui| ui.label(choices.file_name()));
            });
            ui.add_space(4.0);
            ui.weak(note(choices.size));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                // Consumed, or the dialog that follows would be accepted, too.
                let entered = !ui.ctx().text_edit_focused()
                    && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
                accepted = ui.button("Choose file…").clicked() || entered;
                cancelled = ui.button("Cancel").clicked();
            });
        });
        if cancelled || modal.should_close() {
            self.pending = None;
            return None;
        }
        let choices = self.pending.take_if(|_| accepted)?;
        self.last = Some((choices.is_exr, choices.layers.clone()));
        Some((choices.export(), choices.file_name()))
    }
}

impl Choices {
    fn export(&self) -> PictureExport {
        let layers = if self.is_exr { self.layers.clone() } else { Vec::new() };
        PictureExport { size: Some(self.size), layers }
    }

    fn file_name(&self) -> String {
        format!("{}.{}", self.stem, if self.is_exr { "exr" } else { "png" })
    }

    /// Sets a side; the other one follows.
    fn set_side(&mut self, axis: usize, px: u32) {
        let share = f64::from(px) / f64::from(self.camera_size[axis]);
        self.size = self
            .camera_size
            .map(|side| ((f64::from(side) * share).round() as u32).clamp(1, Camera::LARGEST_SIDE_PX));
        self.size[axis] = px;
    }
}

fn size_row(ui: &mut Ui, choices: &mut Choices) -> egui::Response {
    ui.vertical(|ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().interact_size.x = SIDE_FIELD;
            for (axis, name) in ["Width", "Height"].into_iter().enumerate() {
                let mut px = choices.size[axis];
                let field = DragValue::new(&mut px).range(1..=Camera::LARGEST_SIDE_PX).suffix(" px");
                let field = ui.add(field);
                set_accessible_name(&field, name);
                if field.changed() {
                    choices.set_side(axis, px);
                }
                if axis == 0 {
                    ui.label("×");
                }
            }
        });
        ui.horizontal(|ui| percentages(ui, choices));
    })
    .response
}

/// Buttons for shares of the camera's size.
fn percentages(ui: &mut Ui, choices: &mut Choices) {
    for percent in PERCENTAGES {
        let width = choices.camera_size[0] * percent / 100;
        let is_possible =
            choices.camera_size.iter().all(|side| side * percent / 100 <= Camera::LARGEST_SIDE_PX);
        let button = Button::selectable(choices.size[0] == width, format!("{percent} %"));
        let button = ui.add_enabled(is_possible && width > 0, button);
        if button.on_hover_text("Of the camera's size.").clicked() {
            choices.set_side(0, width);
        }
    }
}

fn format_row(ui: &mut Ui, choices: &mut Choices) -> egui::Response {
    ui.horizontal(|ui| {
        ui.selectable_value(&mut choices.is_exr, false, "PNG")
            .on_hover_text("As the screen shows it, 8 bits.");
        ui.selectable_value(&mut choices.is_exr, true, "OpenEXR")
            .on_hover_text("Linear light as floats, for compositing.");
    })
    .response
}

fn layers_row(ui: &mut Ui, choices: &mut Choices) -> egui::Response {
    ui.vertical(|ui| {
        for (layer, name, tip) in LAYERS {
            let mut is_chosen = choices.layers.contains(&layer);
            if ui.checkbox(&mut is_chosen, name).on_hover_text(tip).changed() {
                choices.layers.retain(|chosen| *chosen != layer);
                choices.layers.extend(is_chosen.then_some(layer));
            }
        }
    })
    .response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_keep_the_proportions_and_only_exr_has_layers() {
        let mut dialog = ExportDialog::default();
        let camera = Camera { width: 960, height: 540, ..Camera::default() };
        dialog.open(&camera, "garden".into());
        let choices = dialog.pending.as_mut().unwrap();
        assert_eq!((choices.file_name().as_str(), choices.export().size), ("garden.png", Some([960, 540])));
        choices.set_side(0, 1920);
        assert_eq!(choices.size, [1920, 1080]);
        choices.set_side(1, 270);
        assert_eq!(choices.size, [480, 270]);
        choices.layers.push(Aov::Depth);
        assert!(choices.export().layers.is_empty());
        choices.is_exr = true;
        assert_eq!((choices.file_name().as_str(), choices.export().layers), ("garden.exr", vec![Aov::Depth]));
    }
}
