//! The row above the views: the active tool's name and the main parameters of the brush. It never moves, whatever the tool.

use crate::window::widgets::brush_controls::{
    hardness_slider, largest_radius, push_brush_change, signed_circle_px, size_slider, strength_slider,
    target_slider,
};
use crate::window::widgets::controls;
use crate::window::{Action, Tool};
use document::Document;
use egui::Ui;
use focus::Brush;

/// Draws the row.
pub fn tool_options(ui: &mut Ui, document: Option<&Document>, tool: Tool, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let name = egui::Label::new(egui::RichText::new(tool.label()).strong()).truncate();
        ui.add_sized([NAME_WIDTH, ui.spacing().interact_size.y], name).on_hover_text(tool.tip());
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

/// Width of the tool's name, points.
const NAME_WIDTH: f32 = 92.0;
/// Width of the blur slider, and of the text beside it, points.
const FOCUS_WIDTH: f32 = 170.0;
const CIRCLE_WIDTH: f32 = 90.0;
/// Width of a brush slider with its label, points.
const SLIDER_WIDTH: f32 = 182.0;

/// Sliders for size, strength and hardness, as many as fit; the inspector has all of them.
fn brush_sliders(ui: &mut Ui, brush: &mut Brush, largest: f64) {
    let has_room = |ui: &Ui| ui.available_width() > FOCUS_WIDTH + CIRCLE_WIDTH + SLIDER_WIDTH;
    if has_room(ui) {
        size_slider(ui, brush, largest);
    }
    if has_room(ui) {
        strength_slider(ui, brush);
    }
    if has_room(ui) {
        hardness_slider(ui, brush);
    }
    ui.separator();
}
