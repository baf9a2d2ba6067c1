//! The command palette: finds commands by a part of their names and shows their keys.

use crate::window::widgets::{controls, keys};
use egui::{Align2, Context, Id, Key, RichText};
use session::{COMMANDS, CommandId, CommandInfo};

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

    /// Draws the palette and returns the chosen command, if any.
    pub fn show(&mut self, context: &Context) -> Option<CommandId> {
        if !self.open {
            return None;
        }
        let matching = find_commands(&self.query);
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
                run = matching.get(self.chosen).map(|info| info.id);
            }
        });
        self.chosen = self.chosen.min(matching.len().saturating_sub(1));
        let window =
            egui::Window::new("Command palette").id(Id::unique("palette")).title_bar(false).resizable(false);
        window.anchor(Align2::CENTER_TOP, [0.0, 70.0]).fixed_size([460.0, 380.0]).show(context, |ui| {
            let edit = egui::TextEdit::singleline(&mut self.query);
            let hint = "Type a part of a command's name";
            let response = ui.add(edit.hint_text(hint).desired_width(f32::INFINITY));
            controls::set_accessible_name(&response, "Find a command");
            response.request_focus();
            if response.changed() {
                self.chosen = 0;
            }
            ui.add_space(4.0);
            egui::ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
                for (index, info) in matching.iter().enumerate() {
                    let chosen = index == self.chosen;
                    let response = row(ui, info, chosen);
                    if chosen
                        && ui.input(|input| input.key_down(Key::ArrowDown) || input.key_down(Key::ArrowUp))
                    {
                        response.scroll_to_me(None);
                    }
                    if response.clicked() {
                        run = Some(info.id);
                    }
                }
                if matching.is_empty() {
                    ui.weak("No matching command.");
                }
            });
        });
        if run.is_some() {
            self.open = false;
        }
        run
    }
}

fn row(ui: &mut egui::Ui, info: &CommandInfo, chosen: bool) -> egui::Response {
    let shortcut = keys::shortcut_text(ui.ctx(), info.id);
    let label = format!("{}: {}", info.menu.title(), info.name);
    let layout = egui::Layout::top_down_justified(egui::Align::LEFT);
    let button = egui::Button::selectable(chosen, label).right_text(RichText::new(shortcut).weak());
    ui.with_layout(layout, |ui| ui.add(button)).inner.on_hover_text(info.tooltip)
}

/// The commands whose menu, name or tooltip contains every word of the query, the best matches first.
fn find_commands(query: &str) -> Vec<&'static CommandInfo> {
    let query = query.trim().to_lowercase();
    let words: Vec<_> = query.split_whitespace().collect();
    let rank = |info: &CommandInfo| {
        let name = info.name.to_lowercase();
        let text = format!("{} {name} {}", info.menu.title().to_lowercase(), info.tooltip.to_lowercase());
        match () {
            _ if name.starts_with(&query) => Some(0),
            _ if words.iter().all(|word| name.contains(word)) => Some(1),
            _ if words.iter().all(|word| text.contains(word)) => Some(2),
            _ => None,
        }
    };
    let mut ranked: Vec<_> = COMMANDS.iter().filter_map(|info| Some((rank(info)?, info))).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, info)| info).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_by_start_by_words_and_by_what_it_does() {
        assert_eq!(find_commands("").len(), COMMANDS.len());
        assert_eq!(find_commands("und")[0].id, CommandId::Undo);
        assert!(find_commands("focus map export").iter().any(|info| info.id == CommandId::ExportFocusMap));
        assert!(find_commands("16-bit").iter().any(|info| info.id == CommandId::ExportFocusMap));
        assert!(find_commands("no such thing").is_empty());
    }
}
