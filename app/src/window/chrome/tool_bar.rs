//! The tool bar: the tools and the main parameters of the brush.

use crate::window::widgets::brush_controls::{
    HARDNESS_TIP, SIZE_TIP, STRENGTH_TIP, largest_radius, push_brush_change, signed_circle_px, target_slider,
};
use crate::window::widgets::{controls, keys};
use crate::window::{Action, Tool};
use document::Document;
use egui::{Button, Ui};
use focus::Brush;

/// Draws the tool bar.
pub fn tool_bar(ui: &mut Ui, document: Option<&Document>, tool: Tool, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let has_depth = document.is_some_and(|document| document.scene().picture.is_some());
        for family in Tool::BAR {
            if family[0].depth_repair().is_some() && !has_depth {
                continue;
            }
            tool_button(ui, family, tool, actions);
        }
        let Some(document) = document else { return };
        ui.separator();
        let mut brush = document.brush.clone();
        ui.spacing_mut().slider_width = 104.0;
        brush_sliders(ui, &mut brush, largest_radius(document));
        let optics = document.camera.optics();
        let width = (ui.available_width() - CIRCLE_WIDTH).clamp(60.0, FOCUS_WIDTH);
        if let Some(target) = target_slider(ui, &optics, brush.target, width) {
            brush.target = target;
        }
        let px = signed_circle_px(&optics, brush.target.t);
        ui.label(controls::circle_text(px))
            .on_hover_text("The blur that the brush paints, in the full-size picture.");
        push_brush_change(document, brush, actions);
    });
}

/// Width of the blur slider, and of the text beside it, points.
const FOCUS_WIDTH: f32 = 170.0;
const CIRCLE_WIDTH: f32 = 90.0;
/// Width of a brush slider with its label, points.
const SLIDER_WIDTH: f32 = 182.0;

/// Sliders for size, strength and hardness, as many as fit; the inspector has all of them.
fn brush_sliders(ui: &mut Ui, brush: &mut Brush, largest: f64) {
    let has_room = |ui: &Ui| ui.available_width() > FOCUS_WIDTH + CIRCLE_WIDTH + SLIDER_WIDTH;
    if has_room(ui) {
        ui.label("Size").on_hover_text(SIZE_TIP);
        let size = egui::Slider::new(&mut brush.radius, largest * 1e-3..=largest);
        let size = size.logarithmic(true).show_value(false);
        controls::set_accessible_name(&ui.add(size).on_hover_text(SIZE_TIP), "Brush size");
    }
    let shares = [
        (&mut brush.strength, "Strength", STRENGTH_TIP, "Brush strength"),
        (&mut brush.hardness, "Hardness", HARDNESS_TIP, "Brush hardness"),
    ];
    for (share, label, tip, name) in shares {
        if has_room(ui) {
            ui.label(label).on_hover_text(tip);
            let slider = egui::Slider::new(share, 0.0..=1.0).show_value(false);
            controls::set_accessible_name(&ui.add(slider).on_hover_text(tip), name);
        }
    }
    ui.separator();
}

/// The button of a family of tools: the active tool or the first; a right click shows all.
fn tool_button(ui: &mut Ui, family: &[Tool], tool: Tool, actions: &mut Vec<Action>) {
    let chosen = family.contains(&tool);
    let shown = if chosen { tool } else { family[0] };
    let response = ui.add(Button::selectable(chosen, shown.label()));
    let tip = keys::command_tooltip(ui.ctx(), shown.command());
    let more = if family.len() > 1 { "\nRight-click for related tools." } else { "" };
    let response = response.on_hover_text(format!("{tip}{more}"));
    if response.clicked() {
        actions.push(shown.command().into());
    }
    if family.len() > 1 {
        response.context_menu(|ui| {
            for tool in family {
                let key = keys::shortcut_text(ui.ctx(), tool.command());
                let button = Button::new(tool.label()).shortcut_text(key);
                if ui.add(button).on_hover_text(tool.command().info().tooltip).clicked() {
                    actions.push(tool.command().into());
                    ui.close();
                }
            }
        });
    }
}
