//! The dialog for the name of a preset.

use egui::{Context, Id, Key, TextEdit};
use project::{Preset, PresetContent, PresetLibrary};
use std::path::PathBuf;

/// What is named.
#[derive(Clone, Debug)]
pub enum PresetNaming {
    /// A new preset.
    New(PresetContent),
    /// The user's own preset in this file.
    Rename(PathBuf),
}

/// The dialog; empty while closed.
#[derive(Default)]
pub struct PresetNameDialog {
    pending: Option<(PresetNaming, String)>,
    /// Whether the name field has received the keyboard focus.
    focused: bool,
}

impl PresetNameDialog {
    /// Opens the dialog with `suggestion` as the initial name.
    pub fn open(&mut self, naming: PresetNaming, suggestion: String) {
        *self = Self { pending: Some((naming, suggestion)), focused: false };
    }

    /// Whether the dialog is open.
    pub fn is_open(&self) -> bool {
        self.pending.is_some()
    }

    /// Draws the dialog. Once accepted, returns what was named and the name.
    pub fn show(&mut self, context: &Context, shelf: &PresetLibrary) -> Option<(PresetNaming, String)> {
        let (naming, name) = self.pending.as_mut()?;
        let mut accepted = false;
        let mut cancelled = false;
        let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
        let modal = egui::Modal::new(Id::unique("preset name")).frame(frame).show(context, |ui| {
            ui.set_width(340.0);
            ui.heading(match naming {
                PresetNaming::New(_) => "Save preset",
                PresetNaming::Rename(_) => "Rename preset",
            });
            ui.add_space(6.0);
            let label = ui.label("Name");
            let field = ui.add(TextEdit::singleline(name).desired_width(f32::INFINITY)).labelled_by(label.id);
            if !std::mem::replace(&mut self.focused, true) {
                field.request_focus();
            }
            let note = name_note(naming, name, shelf);
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let is_possible = note.as_ref().is_none_or(|(is_possible, _)| *is_possible);
                let entered = ui.input(|input| input.key_pressed(Key::Enter));
                let verb = if matches!(naming, PresetNaming::New(_)) { "Save" } else { "Rename" };
                let button = ui.add_enabled(is_possible, egui::Button::new(verb));
                accepted = button.clicked() || (entered && is_possible);
                cancelled = ui.button("Cancel").clicked();
            });
            if let Some((_, note)) = note {
                ui.weak(note);
            }
        });
        if cancelled || modal.should_close() {
            self.pending = None;
            return None;
        }
        if accepted { self.pending.take() } else { None }
    }
}

/// A note about a name, and whether the name can be used.
fn name_note(naming: &PresetNaming, name: &str, shelf: &PresetLibrary) -> Option<(bool, String)> {
    let PresetNaming::New(content) = naming else {
        return name.trim().is_empty().then(|| (false, "Type a name.".to_string()));
    };
    let preset = match Preset::new(name, content.clone()) {
        Ok(preset) => preset,
        Err(problem) => return Some((false, format!("{problem}."))),
    };
    let same: Vec<_> =
        shelf.entries_of_kind(preset.kind()).filter(|entry| entry.name() == preset.name).collect();
    let note = match &same[..] {
        [] => return None,
        same if same.iter().any(|entry| entry.file.is_some()) => {
            "Your preset with this name will be replaced."
        }
        _ => "It will be listed in addition to the built-in preset of this name.",
    };
    Some((true, note.into()))
}
