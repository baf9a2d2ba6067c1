//! The focus layers, the topmost first.

use super::curve_editor::curve_editor;
use super::plane_editor::plane_editor;
use super::spread_rows::spread_rows;
use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, row, rows};
use crate::window::widgets::keys;
use document::Document;
use egui::{Button, ComboBox, Slider, TextEdit, Ui};
use focus::{Adjustment, BlendMode, FocusLayer, LayerEdit, SpreadSettings};
use session::{Command, CommandId};

/// Draws the list of layers and the settings of the active one; adds what the user requests to `actions`.
pub fn layers_panel(
    ui: &mut Ui,
    document: &Document,
    spread: &mut SpreadSettings,
    actions: &mut Vec<Action>,
) {
    let layers = document.layers.layers();
    let active = document.layers.active_index();
    for (index, layer) in layers.iter().enumerate().rev() {
        ui.horizontal(|ui| {
            let mut visible = layer.is_visible;
            let tip = if visible { "Hide this layer." } else { "Show this layer." };
            let shown = ui.checkbox(&mut visible, "").on_hover_text(tip);
            controls::set_accessible_name(&shown, &format!("Show {}", layer.name));
            if shown.changed() {
                actions.push(Command::EditLayers(LayerEdit::Visible(index, visible)).into());
            }
            let chosen = controls::list_row(ui, index == active, &layer_title(layer));
            if chosen.on_hover_text("Paint on this layer.").clicked() {
                actions.push(Command::ActivateLayer(index).into());
            }
        });
    }
    ui.horizontal_wrapped(|ui| {
        let mut button = |id: CommandId, label: &str| {
            let response = ui.add_enabled(is_layer_command_possible(id, document), Button::new(label));
            let tip = keys::command_tooltip(ui.ctx(), id);
            if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                actions.push(id.into());
            }
        };
        button(CommandId::AddLayer, "+ Layer");
        button(CommandId::AddDepthCurve, "+ Depth curve");
        button(CommandId::AddFocalPlane, "+ Focal plane");
        button(CommandId::DuplicateLayer, "Duplicate");
        button(CommandId::RaiseLayer, "Up");
        button(CommandId::LowerLayer, "Down");
        button(CommandId::RemoveLayer, "Remove");
    });
    layer_settings(ui, document, active, &layers[active], actions);
    if layers[active].adjustment.is_none() {
        spread_rows(ui, &layers[active], spread, actions);
    }
}

/// Whether a layer command is currently possible.
pub fn is_layer_command_possible(id: CommandId, document: &Document) -> bool {
    let (count, active) = (document.layers.layers().len(), document.layers.active_index());
    match id {
        CommandId::RemoveLayer => count > 1,
        CommandId::RaiseLayer | CommandId::LayerAbove => active + 1 < count,
        CommandId::LowerLayer | CommandId::LayerBelow => active > 0,
        CommandId::RemoveMask => document.layers.active().map.has_mask(),
        CommandId::AddMask => !document.layers.active().map.has_mask(),
        CommandId::SpreadStrokes => document.layers.active().adjustment.is_none(),
        CommandId::ShowStrokes => document.layers.active().spread.is_some(),
        _ => true,
    }
}

/// Title of a layer in the list.
fn layer_title(layer: &FocusLayer) -> String {
    let mut title = layer.name.clone();
    if layer.blend != BlendMode::Set {
        title += &format!("  · {}", blend_name(layer.blend).to_lowercase());
    }
    if layer.opacity < 1.0 {
        title += &format!("  · {:.0} %", layer.opacity * 100.0);
    }
    title
}

fn layer_settings(
    ui: &mut Ui,
    document: &Document,
    index: usize,
    layer: &FocusLayer,
    actions: &mut Vec<Action>,
) {
    let edit = |edit: LayerEdit| Action::from(Command::EditLayers(edit));
    rows(ui, "layer", |ui| {
        let mut name = layer.name.clone();
        let response = row(ui, "Name", "Name of this layer.", |ui| {
            ui.add(TextEdit::singleline(&mut name).desired_width(150.0))
        });
        if response.changed() {
            actions.push(edit(LayerEdit::Rename(index, name)));
        }
        finish_edit(&response, actions);

        let mut opacity = layer.opacity * 100.0;
        let response = row(ui, "Opacity", "Opacity of this layer.", |ui| {
            ui.add(Slider::new(&mut opacity, 0.0..=100.0).suffix(" %").max_decimals(0))
        });
        if response.changed() {
            actions.push(edit(LayerEdit::Opacity(index, opacity / 100.0)));
        }
        finish_edit(&response, actions);

        let tip = "How this layer is combined with those below. Set: interpolates t and anchor. Mix: \
                   interpolates the blur at every depth. Add: adds its offset. Multiply: multiplies the blur \
                   below by its t.";
        row(ui, "Blending", tip, |ui| {
            let combo =
                ComboBox::from_id_salt("layer blend").selected_text(blend_name(layer.blend)).width(150.0);
            combo
                .show_ui(ui, |ui| {
                    for blend in BlendMode::ALL {
                        if ui.selectable_label(blend == layer.blend, blend_name(blend)).clicked() {
                            actions.push(edit(LayerEdit::Blend(index, blend)));
                        }
                    }
                })
                .response
        });
        let tip = "Where this layer has effect. Painting on a layer with a mask extends the mask; the Reset \
                   brush erases it.";
        row(ui, "Mask", tip, |ui| {
            ui.horizontal(|ui| {
                let state = if layer.map.has_mask() { "painted" } else { "everywhere" };
                let label = ui.label(state);
                let mut button = |id: CommandId, label: &str| {
                    let button = Button::new(label);
                    let response = ui.add_enabled(is_layer_command_possible(id, document), button);
                    let tip = id.info().tooltip;
                    if response.on_hover_text(tip).on_disabled_hover_text(tip).clicked() {
                        actions.push(id.into());
                    }
                };
                if layer.map.has_mask() {
                    button(CommandId::InvertMask, "Invert");
                    button(CommandId::RemoveMask, "Remove");
                } else {
                    button(CommandId::AddMask, "Add");
                }
                label
            })
            .inner
        });
    });
    match &layer.adjustment {
        Some(Adjustment::Curve(curve)) => curve_editor(ui, document, index, curve, actions),
        Some(Adjustment::Plane(plane)) => plane_editor(ui, document, index, plane, actions),
        None => {}
    }
}

fn blend_name(blend: BlendMode) -> &'static str {
    match blend {
        BlendMode::Set => "Set",
        BlendMode::Mix => "Mix blur",
        BlendMode::Add => "Add",
        BlendMode::MultiplyDefocus => "Multiply blur",
    }
}
