//! The dialog about unsaved changes, shown before they would be lost.

use egui::{Context, Id};
use std::path::PathBuf;

/// The action that waits for the answer.
#[derive(Clone, Debug, PartialEq)]
pub enum PendingAction {
    /// The window closes.
    Quit,
    /// Another document is opened.
    Open(PathBuf),
    /// The demo is opened.
    OpenDemo,
    /// The dialog for a file to open is shown.
    ChooseFile,
    /// The dialog for the folder of a capture is shown.
    ChooseCapture,
}

/// The user's decision about the changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Save them, then continue.
    Save(PendingAction),
    /// Discard them and continue.
    Discard(PendingAction),
    /// Cancel the action.
    Stay,
}

/// The dialog; empty while closed.
#[derive(Default)]
pub struct UnsavedChangesDialog {
    next: Option<PendingAction>,
    /// Whether the Save button has received the keyboard focus.
    focused: bool,
}

impl UnsavedChangesDialog {
    /// Opens the dialog before `next`.
    pub fn open(&mut self, next: PendingAction) {
        *self = Self { next: Some(next), focused: false };
    }

    /// Whether the dialog is open.
    pub fn is_open(&self) -> bool {
        self.next.is_some()
    }

    /// Draws the dialog and returns the answer, if any.
    pub fn show(&mut self, context: &Context, name: &str) -> Option<Answer> {
        let next = self.next.clone()?;
        let mut answer = None;
        let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
        let modal = egui::Modal::new(Id::unique("unsaved changes")).frame(frame).show(context, |ui| {
            ui.set_width(380.0);
            ui.heading("Save the changes?");
            ui.add_space(4.0);
            ui.label(format!("{name} has unsaved changes."));
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                let save = ui.button("Save").on_hover_text("Save, then continue.");
                if !std::mem::replace(&mut self.focused, true) {
                    save.request_focus();
                }
                if save.clicked() {
                    answer = Some(Answer::Save(next.clone()));
                }
                if ui.button("Discard").on_hover_text("Continue and lose the changes.").clicked() {
                    answer = Some(Answer::Discard(next.clone()));
                }
                if ui.button("Cancel").on_hover_text("Do nothing.").clicked() {
                    answer = Some(Answer::Stay);
                }
            });
        });
        if modal.should_close() {
            answer = Some(Answer::Stay);
        }
        if answer.is_some() {
            self.next = None;
        }
        answer
    }
}
