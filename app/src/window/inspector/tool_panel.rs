//! What the chosen tool can be set to, where that is not the brush.

use crate::window::controls::{self, row, rows};
use crate::window::keys;
use crate::window::tool_settings::{GradientEnd, ToolSettings};
use crate::window::{Action, Tool};
use egui::{Button, ComboBox, DragValue, Ui};
use focus::{Ease, GradientShape};
use session::{CommandId, Document};

/// Whether the tool has anything to set here.
pub fn has_settings(tool: Tool) -> bool {
    matches!(tool, Tool::Gradient | Tool::RackFocus) || tool.selects()
}

/// Gradients: shape, space, end. Selections: how they reach, and what is selected.
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
        let tip = "Let lasso and box reach surfaces that are hidden behind others.";
        row(ui, "Through", tip, |ui| ui.checkbox(&mut settings.select_through, "hidden ones too"));
        let tip = "The largest angle between what is clicked and what faces alike.";
        row(ui, "Facing", tip, |ui| {
            let value = DragValue::new(&mut settings.facing_degrees);
            ui.add(value.range(0.0..=180.0).speed(0.5).suffix("°").max_decimals(0))
        });
        let tip = "How much of the surface may be painted; the rest is frozen.";
        row(ui, "Selected", tip, |ui| ui.label(selection_summary(document)));
    });
    ui.horizontal_wrapped(|ui| {
        let commands = [CommandId::SelectAll, CommandId::InvertSelection, CommandId::MaskFromSelection];
        for (id, label) in commands.into_iter().zip(["Everything", "Invert", "Make a mask of it"]) {
            let possible = document.selection.is_some();
            let response = ui.add_enabled(possible, Button::new(label));
            let tip = keys::command_tooltip(ui.ctx(), id);
            if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                actions.push(id.into());
            }
        }
    });
}

/// How much is selected, in words.
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

fn rack_rows(ui: &mut Ui, settings: &mut ToolSettings) {
    let rack = &mut settings.rack;
    let tip = "How long the lens takes from what was clicked first to what was clicked second.";
    row(ui, "Takes", tip, |ui| {
        ui.add(
            DragValue::new(&mut rack.seconds).range(0.01..=3600.0).speed(0.02).suffix(" s").max_decimals(2),
        )
    });
    let tip = "How it goes: at an even pace, slowly at both ends, or at once when its time is over.";
    row(ui, "Goes", tip, |ui| {
        let combo = ComboBox::from_id_salt("rack ease").selected_text(ease_name(rack.ease)).width(130.0);
        combo
            .show_ui(ui, |ui| {
                for (_, ease) in Ease::ALL {
                    ui.selectable_value(&mut rack.ease, ease, ease_name(ease));
                }
            })
            .response
    });
}

/// What an ease is called.
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
        ui.horizontal(|ui| {
            let linear = ui.selectable_value(&mut gradient.shape, GradientShape::Linear, "Linear");
            ui.selectable_value(&mut gradient.shape, GradientShape::Radial, "Radial").on_hover_text(tip);
            linear.on_hover_text(tip)
        })
        .inner
    });
    let tip = "Screen runs as one sees it in the view, world between the two surface points.";
    row(ui, "Space", tip, |ui| {
        ui.horizontal(|ui| {
            let screen = ui.selectable_value(&mut gradient.in_world, false, "Screen");
            ui.selectable_value(&mut gradient.in_world, true, "World").on_hover_text(tip);
            screen.on_hover_text(tip)
        })
        .inner
    });
    let tip = "What the gradient leads to, from the chosen focus at its start.";
    row(ui, "Leads to", tip, |ui| {
        let combo = ComboBox::from_id_salt("gradient end").selected_text(gradient.end.name()).width(130.0);
        combo
            .show_ui(ui, |ui| {
                for end in GradientEnd::ALL {
                    ui.selectable_value(&mut gradient.end, end, end.name());
                }
            })
            .response
    });
}
