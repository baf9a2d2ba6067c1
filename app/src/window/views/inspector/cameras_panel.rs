//! The bookmarked cameras.

use crate::window::Action;
use crate::window::widgets::rename_field::RenameField;
use crate::window::widgets::{controls, keys};
use document::{BookmarkEdit, Document};
use egui::Ui;
use session::{Command, CommandId};

/// State of the list.
#[derive(Default)]
pub struct CamerasPanel {
    renaming: RenameField,
}

/// Width of the field for a new name, points.
const NAME_WIDTH: f32 = 160.0;

impl CamerasPanel {
    /// Draws the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let add = ui.button(CommandId::BookmarkCamera.info().name);
        if add.on_hover_text(keys::command_tooltip(ui.ctx(), CommandId::BookmarkCamera)).clicked() {
            actions.push(CommandId::BookmarkCamera.into());
        }
        for (number, bookmark) in document.bookmarks().enumerate() {
            if self.renaming.is_for(number) {
                if let Some(name) = self.renaming.show(ui, NAME_WIDTH, "Name of the bookmark") {
                    actions.push(Command::EditBookmarks(BookmarkEdit::Rename(number, name)).into());
                }
                continue;
            }
            let is_shown = bookmark.camera == document.camera;
            let tip = "Click to go there; double-click to rename it; right-click for more.";
            let go = controls::list_row(ui, is_shown, &bookmark.name).on_hover_text(tip);
            if go.double_clicked() {
                self.renaming.begin(number, &bookmark.name);
            } else if go.clicked() && !is_shown {
                actions.push(Command::GoToBookmark(number).into());
            }
            go.context_menu(|ui| {
                if ui.button("Rename").clicked() {
                    self.renaming.begin(number, &bookmark.name);
                    ui.close();
                }
                let mut entry = |label: &str, tip: &str, edit: BookmarkEdit| {
                    if ui.button(label).on_hover_text(tip).clicked() {
                        actions.push(Command::EditBookmarks(edit).into());
                        ui.close();
                    }
                };
                let tip = "Keep the camera as it is now in its place.";
                entry("Update", tip, BookmarkEdit::Update(number));
                let tip = "Forget it; the camera stays where it is.";
                entry("Remove", tip, BookmarkEdit::Remove(number));
            });
        }
    }
}
