//! Renaming a row of a list in its place: a double click begins, Enter or a click elsewhere ends it, Esc gives it up.

use super::controls::set_accessible_name;
use egui::{Key, TextEdit, Ui};

/// The row that is being renamed, and what was typed.
#[derive(Default)]
pub struct RenameField {
    row: Option<(usize, String)>,
}

impl RenameField {
    /// Begins to rename a row.
    pub fn begin(&mut self, row: usize, name: &str) {
        self.row = Some((row, name.into()));
    }

    /// Whether a row is being renamed.
    pub fn is_for(&self, row: usize) -> bool {
        self.row.as_ref().is_some_and(|(renamed, _)| *renamed == row)
    }

    /// Shows the field, `width` points wide, instead of the row. Returns the new name once it is entered.
    pub fn show(&mut self, ui: &mut Ui, width: f32, accessible_name: &str) -> Option<String> {
        let (_, name) = self.row.as_mut()?;
        let field = ui.add(TextEdit::singleline(name).desired_width(width));
        set_accessible_name(&field, accessible_name);
        if !field.lost_focus() {
            field.request_focus();
            return None;
        }
        let (_, name) = self.row.take()?;
        let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
        (!is_given_up && !name.trim().is_empty()).then_some(name)
    }
}
