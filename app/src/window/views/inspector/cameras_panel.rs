//! The bookmarked cameras.

use crate::window::Action;
use crate::window::widgets::controls::set_accessible_name;
use crate::window::widgets::keys;
use document::{BookmarkEdit, Document};
use egui::{Button, TextEdit, Ui};
use session::{Command, CommandId};

/// State of the list: the name that is being typed.
#[derive(Default)]
pub struct CamerasPanel {
    renaming: Option<(usize, String)>,
}

impl CamerasPanel {
    /// Draws the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let add = ui.button(CommandId::BookmarkCamera.info().name);
        if add.on_hover_text(keys::command_tooltip(ui.ctx(), CommandId::BookmarkCamera)).clicked() {
            actions.push(CommandId::BookmarkCamera.into());
        }
        for (number, bookmark) in document.bookmarks().enumerate() {
            ui.horizontal(|ui| {
                match &mut self.renaming {
                    Some((renamed, name)) if *renamed == number => {
                        let field = ui.add(TextEdit::singleline(name).desired_width(120.0));
                        set_accessible_name(&field, "Name of the bookmark");
                        if field.lost_focus() {
                            actions.push(
                                Command::EditBookmarks(BookmarkEdit::Rename(number, name.clone())).into(),
                            );
                            self.renaming = None;
                        } else {
                            field.request_focus();
                        }
                    }
                    _ => {
                        let is_shown = bookmark.camera == document.camera;
                        let tip = "Click to go there; double-click to rename it.";
                        let go = ui.add(Button::selectable(is_shown, &bookmark.name)).on_hover_text(tip);
                        if go.double_clicked() {
                            self.renaming = Some((number, bookmark.name.clone()));
                        } else if go.clicked() && !is_shown {
                            actions.push(Command::GoToBookmark(number).into());
                        }
                    }
                }
                let mut edit_button = |label: &str, tip: &str, edit: BookmarkEdit| {
                    let button = ui.small_button(label).on_hover_text(tip);
                    set_accessible_name(&button, &format!("{label} {}", bookmark.name));
                    if button.clicked() {
                        actions.push(Command::EditBookmarks(edit).into());
                    }
                };
                edit_button(
                    "Update",
                    "Keep the camera as it is now in its place.",
                    BookmarkEdit::Update(number),
                );
                edit_button(
                    "Remove",
                    "Forget it; the camera stays where it is.",
                    BookmarkEdit::Remove(number),
                );
            });
        }
    }
}
