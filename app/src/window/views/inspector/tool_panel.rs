//! Settings of the active tool, other than those of the brush.

use crate::window::tools::tool_settings::{GradientEnd, ToolSettings};
use crate::window::widgets::controls::{self, row, rows};
use crate::window::widgets::keys;
use crate::window::{Action, Tool};
use document::Document;
use egui::{Button, ComboBox, DragValue, Slider, Ui};
use focus::{Ease, GradientShape, Likeness};
use glam::DVec3;
use session::CommandId;

/// Whether the tool has settings in this panel.
pub fn has_settings(tool: Tool) -> bool {
    matches!(tool, Tool::Gradient | Tool::RackFocus) || tool.selects()
}

/// Settings of gradients (shape, space, end), rack focus and selections.
pub fn tool_panel(
    ui: &mut Ui,
    document: &Document,
    tool: Tool,
    settings: &mut ToolSettings,
    actions: &mut Vec<Action>,
) {
    if tool == Tool::Gradient {
        rows(ui, "gradient", |ui| gradient_rows(ui, settings));
        return;
    }
    if tool == Tool::RackFocus {
        rows(ui, "rack focus", |ui| rack_rows(ui, settings));
        return;
    }
    rows(ui, "selection", |ui| {
        let tip = "Let lasso and box also select hidden surfaces.";
        row(ui, "Through", tip, |ui| ui.checkbox(&mut settings.select_through, "hidden ones too"));
        let tip = "Largest angle between the clicked surface's normal and the selected ones.";
        row(ui, "Facing", tip, |ui| {
            let value = DragValue::new(&mut settings.facing_degrees);
            ui.add(value.range(0.0..=180.0).speed(0.5).suffix("°").max_decimals(0))
        });
        similar_rows(ui, settings);
        let tip = "The share of the surface that can be painted; the rest is frozen.";
        row(ui, "Selected", tip, |ui| ui.label(selection_summary(document)));
    });
    ui.horizontal_wrapped(|ui| {
        let commands = [
            (CommandId::SelectAll, "Everything"),
            (CommandId::InvertSelection, "Invert"),
            (CommandId::RefineSelection, "Refine edges"),
            (CommandId::MaskFromSelection, "Make a mask of it"),
        ];
        for (id, label) in commands {
            let possible = document.selection.is_some();
            let response = ui.add_enabled(possible, Button::new(label));
            let tip = keys::command_tooltip(ui.ctx(), id);
            if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                actions.push(id.into());
            }
        }
    });
}

/// The size of the selection as text.
pub fn selection_summary(document: &Document) -> String {
    let all = document.stage.canvas.texels().len();
    match &document.selection {
        None => "everything".into(),
        Some(selection) => {
            let share = selection.count() as f64 / all.max(1) as f64 * 100.0;
            format!("{} % of all texels", controls::significant_digits(share))
        }
    }
}

fn similar_rows(ui: &mut Ui, settings: &mut ToolSettings) {
    let similar = &mut settings.similar;
    let tip = "What Select similar compares with the clicked point.";
    row(ui, "Alike in", tip, |ui| {
        let combo =
            ComboBox::from_id_salt("likeness").selected_text(likeness_name(similar.likeness)).width(130.0);
        combo
            .show_ui(ui, |ui| {
                let depth = Likeness::Depth(DVec3::NEG_Z);
                for likeness in [Likeness::Color, Likeness::Normal, depth, Likeness::Part] {
                    ui.selectable_value(&mut similar.likeness, likeness, likeness_name(likeness));
                }
            })
            .response
    });
    let tip = "How unlike the clicked point the selected ones may be: a share of the range of colours, of 180°, or of \
               the scene's size.";
    row(ui, "Tolerance", tip, |ui| {
        let mut percent = similar.tolerance * 100.0;
        let response = controls::slider(
            ui,
            Slider::new(&mut percent, 0.0..=100.0).logarithmic(true).suffix(" %").max_decimals(1),
        );
        similar.tolerance = percent / 100.0;
        response
    });
    let tip = "How far Refine edges may move the outline, in texels.";
    row(ui, "Refine within", tip, |ui| {
        ui.add(DragValue::new(&mut settings.refine_texels).range(1..=256).speed(0.2).suffix(" texels"))
    });
}

/// Display name of a likeness.
fn likeness_name(likeness: Likeness) -> &'static str {
    match likeness {
        Likeness::Color => "colour",
        Likeness::Normal => "direction",
        Likeness::Depth(_) => "depth",
        Likeness::Part => "part",
    }
}

fn rack_rows(ui: &mut Ui, settings: &mut ToolSettings) {
    let rack = &mut settings.rack;
    let tip = "Time that the lens takes from the first clicked point to the second.";
    row(ui, "Takes", tip, |ui| {
        ui.add(
            DragValue::new(&mut rack.seconds).range(0.01..=3600.0).speed(0.02).suffix(" s").max_decimals(2),
        )
    });
    let tip = "Interpolation: linear, eased at both ends, or a jump at the end.";
    row(ui, "Goes", tip, |ui| {
        let combo = ComboBox::from_id_salt("rack ease").selected_text(ease_name(rack.ease));
        combo
            .show_ui(ui, |ui| {
                for (_, ease) in Ease::ALL {
                    ui.selectable_value(&mut rack.ease, ease, ease_name(ease));
                }
            })
            .response
    });
}

/// Display name of an ease.
pub fn ease_name(ease: Ease) -> &'static str {
    match ease {
        Ease::Hold => "at once",
        Ease::Linear => "evenly",
        Ease::Smooth => "smoothly",
    }
}

fn gradient_rows(ui: &mut Ui, settings: &mut ToolSettings) {
    let gradient = &mut settings.gradient;
    let tip = "Linear runs along the dragged line, radial around its start.";
    row(ui, "Shape", tip, |ui| {
        controls::beside(ui, |ui| {
            let linear = ui.selectable_value(&mut gradient.shape, GradientShape::Linear, "Linear");
            ui.selectable_value(&mut gradient.shape, GradientShape::Radial, "Radial").on_hover_text(tip);
            linear.on_hover_text(tip)
        })
        .inner
    });
    let tip = "Screen: along the line as seen in the view. World: between the two surface points.";
    row(ui, "Space", tip, |ui| {
        controls::beside(ui, |ui| {
            let screen = ui.selectable_value(&mut gradient.in_world, false, "Screen");
            ui.selectable_value(&mut gradient.in_world, true, "World").on_hover_text(tip);
            screen.on_hover_text(tip)
        })
        .inner
    });
    let tip = "Focus at the end of the gradient; the chosen focus is at its start.";
    row(ui, "Leads to", tip, |ui| {
        let combo = ComboBox::from_id_salt("gradient end").selected_text(gradient.end.name());
        combo
            .show_ui(ui, |ui| {
                for end in GradientEnd::ALL {
                    ui.selectable_value(&mut gradient.end, end, end.name());
                }
            })
            .response
    });
}
