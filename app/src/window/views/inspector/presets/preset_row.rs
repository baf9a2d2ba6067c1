//! The presets of one kind: choose, save, rename, delete, import and export.

use super::preset_picture::preset_picture;
use crate::window::Action;
use crate::window::action::PresetAction;
use crate::window::widgets::controls::row;
use crate::window::widgets::keys;
use egui::{Atom, Button, IdSalt, Response, Shape, Ui, Vec2};
use lens::Camera;
use project::{LibraryEntry, Preset, PresetKind, PresetLibrary};
use session::CommandId;

/// Width of the menu, points.
const MENU_WIDTH: f32 = 240.0;
/// Height of the list within it, points.
const LIST_HEIGHT: f32 = 420.0;

/// Side of a preset's picture, points.
const PICTURE: f32 = 20.0;

/// A row with the preset in use, as determined by `is_current`, and a menu of all presets with small pictures of what they do to a picture of `camera`.
pub fn preset_row(
    ui: &mut Ui,
    shelf: &PresetLibrary,
    camera: &Camera,
    kind: PresetKind,
    is_current: impl Fn(&Preset) -> bool,
    actions: &mut Vec<Action>,
) {
    let (label, save, tip) = match kind {
        PresetKind::Brush => {
            ("Brush preset", CommandId::SaveBrushPreset, "A saved brush; the current size is kept.")
        }
        PresetKind::Lens => (
            "Lens preset",
            CommandId::SaveLensPreset,
            "A lens with its sensor; pose, focus distance and picture size are kept.",
        ),
        PresetKind::Bokeh => ("Bokeh preset", CommandId::SaveBokehPreset, "An aperture shape."),
    };
    let current = |entry: &&LibraryEntry| entry.preset.as_ref().is_ok_and(&is_current);
    let name = shelf.entries_of_kind(kind).find(current).map_or("Own".to_string(), LibraryEntry::name);
    row(ui, label, tip, |ui| {
        let menu = ui.menu_button(&name, |ui| {
            ui.set_width(MENU_WIDTH);
            let list = egui::ScrollArea::vertical().max_height(LIST_HEIGHT);
            list.show(ui, |ui| {
                for entry in shelf.entries_of_kind(kind).filter(|entry| entry.file.is_none()) {
                    entry_button(ui, entry, camera, current(&entry), actions);
                }
                let own: Vec<_> = shelf.entries_of_kind(kind).filter(|entry| entry.file.is_some()).collect();
                if !own.is_empty() {
                    ui.separator();
                }
                for entry in own {
                    own_entry(ui, entry, camera, current(&entry), actions);
                }
            });
            ui.separator();
            for (id, label) in [(save, "Save as preset…"), (CommandId::ImportPreset, "Import preset…")] {
                if ui.button(label).on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
                    actions.push(id.into());
                    ui.close();
                }
            }
        });
        menu.response
    });
}

/// A preset that can be chosen.
fn entry_button(
    ui: &mut Ui,
    entry: &LibraryEntry,
    camera: &Camera,
    is_current: bool,
    actions: &mut Vec<Action>,
) {
    match &entry.preset {
        Ok(preset) => {
            if preset_button(ui, preset, camera, is_current).clicked() {
                actions.push(PresetAction::Use(Box::new(preset.clone())).into());
                ui.close();
            }
        }
        Err(error) => {
            ui.add_enabled(false, Button::new(format!("{} (cannot be read)", entry.name())))
                .on_disabled_hover_text(error);
        }
    }
}

/// The button of a preset, with a picture of what it does before its name.
fn preset_button(ui: &mut Ui, preset: &Preset, camera: &Camera, is_current: bool) -> Response {
    let room = IdSalt::new("picture");
    let picture = Atom::custom(room, Vec2::splat(PICTURE));
    let button = Button::selectable(is_current, (picture, preset.name.as_str())).atom_ui(ui);
    if let Some(rect) = button.rect(room).filter(|rect| ui.is_rect_visible(*rect)) {
        ui.painter().add(Shape::mesh(preset_picture(preset, camera, ui, rect)));
    }
    button.response
}

/// One of the user's own presets, with a menu.
fn own_entry(
    ui: &mut Ui,
    entry: &LibraryEntry,
    camera: &Camera,
    is_current: bool,
    actions: &mut Vec<Action>,
) {
    let Some(file) = entry.file.clone() else { return };
    ui.horizontal(|ui| {
        entry_button(ui, entry, camera, is_current, actions);
        let more = ui.menu_button("…", |ui| {
            if let Ok(preset) = &entry.preset {
                if ui.button("Rename…").on_hover_text("Give this preset another name.").clicked() {
                    actions.push(PresetAction::Rename(file.clone(), preset.name.clone()).into());
                    ui.close();
                }
                let tip = "Write this preset to a file, to be imported elsewhere.";
                if ui.button("Export…").on_hover_text(tip).clicked() {
                    actions.push(PresetAction::Export(Box::new(preset.clone())).into());
                    ui.close();
                }
            }
            let tip =
                "Remove this preset from the list; its file is moved to the folder \"deleted\" beside it.";
            if ui.button("Delete").on_hover_text(tip).clicked() {
                actions.push(PresetAction::Delete(file.clone()).into());
                ui.close();
            }
        });
        crate::window::widgets::controls::set_accessible_name(
            &more.response,
            &format!("{}: more", entry.name()),
        );
    });
}
