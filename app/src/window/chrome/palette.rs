//! The command palette: finds commands, presets and cameras by a part of their names and shows their keys.

mod entries;
mod synonyms;

use crate::window::Action;
use crate::window::widgets::controls;
use document::Document;
use egui::{Align2, Context, Id, Key, RichText};
use entries::{PaletteEntry, all_entries, matching};
use project::PresetLibrary;

/// The palette's state between frames.
#[derive(Default)]
pub struct Palette {
    open: bool,
    query: String,
    chosen: usize,
}

impl Palette {
    /// Opens the palette with an empty query, or closes it.
    pub fn toggle(&mut self) {
        *self = Self { open: !self.open, ..Self::default() };
    }

    /// Whether the palette is open.
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// Draws the palette and returns what was chosen, if anything.
    pub fn show(
        &mut self,
        context: &Context,
        document: Option<&Document>,
        presets: &PresetLibrary,
    ) -> Option<Action> {
        if !self.open {
            return None;
        }
        let matching = matching(all_entries(context, document, presets), &self.query);
        let mut run = None;
        context.input_mut(|input| {
            if input.consume_key(egui::Modifiers::NONE, Key::Escape) {
                self.open = false;
            }
            if input.consume_key(egui::Modifiers::NONE, Key::ArrowDown) {
                self.chosen += 1;
            }
            if input.consume_key(egui::Modifiers::NONE, Key::ArrowUp) {
                self.chosen = self.chosen.saturating_sub(1);
            }
            if input.consume_key(egui::Modifiers::NONE, Key::Enter) {
                run = matching.get(self.chosen).map(|entry| entry.action.clone());
            }
        });
        self.chosen = self.chosen.min(matching.len().saturating_sub(1));
        let window =
            egui::Window::new("Command palette").id(Id::unique("palette")).title_bar(false).resizable(false);
        window.anchor(Align2::CENTER_TOP, [0.0, 70.0]).fixed_size([460.0, 380.0]).show(context, |ui| {
            let edit = egui::TextEdit::singleline(&mut self.query);
            let hint = "Type a part of a name: a command, a preset, a camera";
            let response = ui.add(edit.hint_text(hint).desired_width(f32::INFINITY));
            controls::set_accessible_name(&response, "Find a command");
            response.request_focus();
            if response.changed() {
                self.chosen = 0;
            }
            ui.add_space(4.0);
            egui::ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
                for (index, entry) in matching.iter().enumerate() {
                    let chosen = index == self.chosen;
                    let response = row(ui, entry, chosen);
                    if chosen
                        && ui.input(|input| input.key_down(Key::ArrowDown) || input.key_down(Key::ArrowUp))
                    {
                        response.scroll_to_me(None);
                    }
                    if response.clicked() {
                        run = Some(entry.action.clone());
                    }
                }
                if matching.is_empty() {
                    ui.weak("Nothing of that name.");
                }
            });
        });
        if run.is_some() {
            self.open = false;
        }
        run
    }
}

fn row(ui: &mut egui::Ui, entry: &PaletteEntry, chosen: bool) -> egui::Response {
    let layout = egui::Layout::top_down_justified(egui::Align::LEFT);
    let button = egui::Button::selectable(chosen, &entry.label).right_text(RichText::new(&entry.key).weak());
    ui.with_layout(layout, |ui| ui.add(button)).inner.on_hover_text(&entry.tooltip)
}
