//! The menus, generated from the command table.

use crate::window::views::inspector::is_layer_command_possible;
use crate::window::widgets::keys;
use crate::window::{Action, ViewSettings};
use document::Document;
use egui::{Button, Ui};
use session::{COMMANDS, CommandId, CommandInfo, Menu};

/// Height of the menu bar and of the frame of an open menu, points.
const MENU_MARGIN: f32 = 48.0;

/// Inputs of the menus.
pub struct MenuState<'a> {
    /// The open document.
    pub document: Option<&'a Document>,
    /// The settings.
    pub settings: &'a ViewSettings,
    /// Whether there are jobs that Stop can cancel.
    pub has_jobs: bool,
}

/// Draws the menu bar.
pub fn menu_bar(ui: &mut Ui, state: &MenuState<'_>, actions: &mut Vec<Action>) {
    egui::MenuBar::new().ui(ui, |ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| {
                ui.set_min_width(230.0);
                // Long menus scroll only if the window is too low.
                let height = ui.ctx().content_rect().height() - MENU_MARGIN;
                let scrolled = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
                scrolled.show(ui, |ui| entries(ui, menu, state, actions));
            });
        }
    });
}

fn entries(ui: &mut Ui, menu: Menu, state: &MenuState<'_>, actions: &mut Vec<Action>) {
    for info in COMMANDS.iter().filter(|info| info.menu == menu) {
        if begins_group(info.id) {
            ui.separator();
        }
        command_item(ui, info, state, actions);
        if info.id == CommandId::Open {
            recent_files_menu(ui, state.settings, actions);
        }
    }
}

/// Whether a separator precedes the command.
fn begins_group(id: CommandId) -> bool {
    use CommandId::*;
    matches!(
        id,
        Save | ExportPicture
            | Quit
            | PictureFit
            | ShowGuides
            | ShowFocus
            | ShowAtlas
            | PaintAsNavigator
            | EnlargePanel
            | NextToneCurve
            | KeysBlender
            | SelectAll
            | FillPart
            | DuplicateLayer
            | RaiseLayer
            | LayerAbove
            | AddMask
            | SpreadStrokes
            | FocusHere
            | ResetMap
            | BrushSize
            | BrushNearer
            | FocusNearer
            | CameraFromView
            | Bake
            | Stop
            | About
    )
}

fn command_item(ui: &mut Ui, info: &CommandInfo, state: &MenuState<'_>, actions: &mut Vec<Action>) {
    let name = match (info.id, state.document) {
        (CommandId::Undo, Some(document)) => with_step_name(info.name, document.undo_name()),
        (CommandId::Redo, Some(document)) => with_step_name(info.name, document.redo_name()),
        _ => info.name.to_string(),
    };
    let mut button = Button::new(name).selected(is_on(info.id, state.settings));
    let key = keys::shortcut_text(ui.ctx(), info.id);
    if !key.is_empty() {
        button = button.shortcut_text(key);
    }
    let response = ui.add_enabled(is_possible(info.id, state), button).on_hover_text(info.tooltip);
    if response.on_disabled_hover_text(info.tooltip).clicked() {
        actions.push(info.id.into());
        ui.close();
    }
}

/// Whether a command is the choice that is made, or what it shows is shown.
fn is_on(id: CommandId, settings: &ViewSettings) -> bool {
    match id {
        CommandId::ShowGuides => settings.guides,
        CommandId::ShowFocusPlane => settings.focus_plane,
        _ => settings.key_map.command() == id,
    }
}

fn with_step_name(name: &str, what: Option<&str>) -> String {
    what.map_or_else(|| name.to_string(), |what| format!("{name}: {what}"))
}

/// Whether a command is currently possible.
pub fn is_possible(id: CommandId, state: &MenuState<'_>) -> bool {
    use CommandId::*;
    match id {
        Open | OpenCapture | OpenDemo | Quit | ResetLayout | PaintAsNavigator | PaintBeside | PaintAbove
        | PictureAlone | EnlargePanel | FloatPanel | FullScreen | ShowInspector | NextToneCurve
        | LightOrDark | ScaleUp | ScaleDown | ScaleReset | ShowGuides | ShowFocusPlane | KeysBlender
        | KeysSubstance | KeysKrita | ImportPreset | Palette | Book | Shortcuts | ShowMessages | About => {
            true
        }
        SelectAll | InvertSelection | RefineSelection | MaskFromSelection => {
            state.document.is_some_and(|document| document.selection.is_some())
        }
        HideSelectedSplats => state
            .document
            .is_some_and(|document| document.selection.is_some() && document.scene().splats.is_some()),
        ShowAllSplats => state.document.is_some_and(|document| document.splat_edit_showing_all().is_some()),
        Undo => state.document.is_some_and(|document| document.undo_name().is_some()),
        Redo => state.document.is_some_and(|document| document.redo_name().is_some()),
        Stop => state.has_jobs,
        RemoveLayer | RaiseLayer | LowerLayer | LayerAbove | LayerBelow | AddMask | RemoveMask
        | SpreadStrokes | ShowStrokes => {
            state.document.is_some_and(|document| is_layer_command_possible(id, document))
        }
        RemoveKeys => state
            .document
            .is_some_and(|document| document.lens_motion.times().any(|seconds| seconds == document.seconds)),
        ShowStereo => state.document.is_some_and(|document| document.camera.aperture_radius > 0.0),
        _ => state.document.is_some(),
    }
}

fn recent_files_menu(ui: &mut Ui, settings: &ViewSettings, actions: &mut Vec<Action>) {
    ui.add_enabled_ui(!settings.recent.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            ui.set_max_width(480.0);
            for path in &settings.recent {
                let name = path
                    .file_name()
                    .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into());
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    actions.push(Action::Open(path.clone()));
                    ui.close();
                }
            }
        });
    });
}
