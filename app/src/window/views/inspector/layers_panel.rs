//! The focus layers, the topmost first.

use super::curve_editor::curve_editor;
use super::plane_editor::plane_editor;
use super::spread_rows::spread_rows;
use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, row, rows};
use crate::window::widgets::focus_thumbnail::focus_thumbnail;
use crate::window::widgets::icon::{Icon, icon_button};
use crate::window::widgets::keys;
use crate::window::widgets::rename_field::RenameField;
use document::{Document, SavedState, Stage};
use egui::{Button, ComboBox, Sense, Slider, TextEdit, Ui, Vec2, vec2};
use focus::{Adjustment, BlendMode, EditThumbnail, FocusLayer, FocusMap, LayerEdit, SpreadSettings};
use lens::Optics;
use session::{Command, CommandId};
use std::sync::{Arc, Weak};

/// State of the list.
#[derive(Default)]
pub struct LayersPanel {
    renaming: RenameField,
    thumbnails: LayerThumbnails,
}

/// What each layer holds, as a small picture, made anew when a step of the history is.
#[derive(Default)]
struct LayerThumbnails {
    /// The stage and the state of the document that they are of.
    shown: Option<(Weak<Stage>, SavedState)>,
    /// The maps from the lowest layer on, with their pictures.
    pictures: Vec<(FocusMap, EditThumbnail)>,
}

impl LayerThumbnails {
    /// Follows the layers of a document.
    fn update(&mut self, document: &Document) {
        let is_shown = |(stage, state): &(Weak<Stage>, SavedState)| {
            Weak::as_ptr(stage) == Arc::as_ptr(&document.stage) && *state == document.state()
        };
        if self.shown.as_ref().is_some_and(is_shown) {
            return;
        }
        self.shown = Some((Arc::downgrade(&document.stage), document.state()));
        let before = std::mem::take(&mut self.pictures);
        let picture = |(index, layer): (usize, &FocusLayer)| match before.get(index) {
            Some((map, picture)) if *map == layer.map => (map.clone(), picture.clone()),
            _ => (layer.map.clone(), EditThumbnail::from_layer(&layer.map)),
        };
        self.pictures = document.layers.layers().iter().enumerate().map(picture).collect();
    }

    /// Draws the picture of a layer.
    fn show(&self, ui: &mut Ui, index: usize, optics: &Optics) {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(ICON_BUTTON.y), Sense::hover());
        if let Some((_, picture)) = self.pictures.get(index) {
            focus_thumbnail(ui, rect.shrink(1.0), picture, optics);
        }
    }
}

/// What the menu of a layer offers.
const MENU: [CommandId; 8] = [
    CommandId::DuplicateLayer,
    CommandId::RaiseLayer,
    CommandId::LowerLayer,
    CommandId::AddMask,
    CommandId::RemoveMask,
    CommandId::MaskFromSelection,
    CommandId::ResetMap,
    CommandId::RemoveLayer,
];

impl LayersPanel {
    /// Draws the list of layers and the settings of the active one; adds what the user requests to `actions`.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        spread: &mut SpreadSettings,
        actions: &mut Vec<Action>,
    ) {
        let layers = document.layers.layers();
        let active = document.layers.active_index();
        let optics = document.camera.optics();
        self.thumbnails.update(document);
        for (index, layer) in layers.iter().enumerate().rev() {
            ui.horizontal(|ui| {
                visibility_button(ui, index, layer, actions);
                self.thumbnails.show(ui, index, &optics);
                self.layer_row(ui, document, index, layer, actions);
            });
        }
        ui.horizontal_wrapped(|ui| {
            for (id, label) in [
                (CommandId::AddLayer, "+ Layer"),
                (CommandId::AddDepthCurve, "+ Depth curve"),
                (CommandId::AddFocalPlane, "+ Focal plane"),
            ] {
                if ui.button(label).on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
                    actions.push(id.into());
                }
            }
        });
        ui.horizontal(|ui| {
            for (id, icon) in [
                (CommandId::DuplicateLayer, Icon::Duplicate),
                (CommandId::RaiseLayer, Icon::MoveUp),
                (CommandId::LowerLayer, Icon::MoveDown),
                (CommandId::RemoveLayer, Icon::Delete),
            ] {
                let is_possible = is_layer_command_possible(id, document);
                let button = |ui: &mut Ui| icon_button(ui, icon, id.info().name, false, ICON_BUTTON);
                let response = ui.add_enabled_ui(is_possible, button).inner;
                let tip = format!("{}: {}", id.info().name, keys::command_tooltip(ui.ctx(), id));
                if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                    actions.push(id.into());
                }
            }
        });
        layer_settings(ui, document, active, &layers[active], actions);
        if layers[active].adjustment.is_none() {
            spread_rows(ui, &layers[active], spread, actions);
        }
    }

    /// The row of a layer: a click makes it the active one, a double click renames it, a right click shows what can be done.
    fn layer_row(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        index: usize,
        layer: &FocusLayer,
        actions: &mut Vec<Action>,
    ) {
        if self.renaming.is_for(index) {
            if let Some(name) = self.renaming.show(ui, f32::INFINITY, "New name of the layer") {
                actions.push(Command::EditLayers(LayerEdit::Rename(index, name)).into());
                actions.push(Command::FinishEdit.into());
            }
            return;
        }
        let row = controls::list_row(ui, index == document.layers.active_index(), &layer_title(layer));
        let row = row.on_hover_text("Paint on this layer. Double-click to rename it; right-click for more.");
        if row.double_clicked() {
            self.renaming.begin(index, &layer.name);
        } else if row.clicked() || row.secondary_clicked() {
            actions.push(Command::ActivateLayer(index).into());
        }
        row.context_menu(|ui| {
            if ui.button("Rename").on_hover_text("Give this layer another name.").clicked() {
                self.renaming.begin(index, &layer.name);
                ui.close();
            }
            for id in MENU {
                let button = Button::new(id.info().name).shortcut_text(keys::shortcut_text(ui.ctx(), id));
                let has_selection = id != CommandId::MaskFromSelection || document.selection.is_some();
                let is_possible = has_selection && is_layer_command_possible(id, document);
                let tip = id.info().tooltip;
                let entry = ui.add_enabled(is_possible, button).on_hover_text(tip);
                if entry.on_disabled_hover_text(tip).clicked() {
                    actions.push(id.into());
                    ui.close();
                }
            }
        });
    }
}

/// Size of an icon's button below the list, points.
const ICON_BUTTON: Vec2 = vec2(24.0, 22.0);

/// The eye before a layer.
fn visibility_button(ui: &mut Ui, index: usize, layer: &FocusLayer, actions: &mut Vec<Action>) {
    let (icon, tip) = match layer.is_visible {
        true => (Icon::Visible, "Hide this layer."),
        false => (Icon::Hidden, "Show this layer."),
    };
    let button = icon_button(ui, icon, &format!("Show {}", layer.name), false, ICON_BUTTON);
    if button.on_hover_text(tip).clicked() {
        actions.push(Command::EditLayers(LayerEdit::Visible(index, !layer.is_visible)).into());
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
            ui.add(TextEdit::singleline(&mut name).desired_width(f32::INFINITY))
        });
        if response.changed() {
            actions.push(edit(LayerEdit::Rename(index, name)));
        }
        finish_edit(&response, actions);

        let mut opacity = layer.opacity * 100.0;
        let response = row(ui, "Opacity", "Opacity of this layer.", |ui| {
            controls::slider(ui, Slider::new(&mut opacity, 0.0..=100.0).suffix(" %").max_decimals(0))
        });
        if response.changed() {
            actions.push(edit(LayerEdit::Opacity(index, opacity / 100.0)));
        }
        finish_edit(&response, actions);

        let tip = "How this layer is combined with those below. Set: interpolates t and anchor. Mix: \
                   interpolates the blur at every depth. Add: adds its offset. Multiply: multiplies the blur \
                   below by its t.";
        row(ui, "Blending", tip, |ui| {
            let combo = ComboBox::from_id_salt("layer blend").selected_text(blend_name(layer.blend));
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
            controls::beside(ui, |ui| {
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
