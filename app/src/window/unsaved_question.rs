//! The one question that must be answered: unsaved changes before something else takes their place.

use egui::{Context, Id};
use std::path::PathBuf;

/// What was going to happen.
#[derive(Clone, Debug, PartialEq)]
pub enum PendingAction {
    /// The window closes.
    Quit,
    /// Another document is opened.
    Open(PathBuf),
    /// The demo is opened.
    OpenDemo,
    /// A file to open is asked for.
    ChooseFile,
    /// The folder of a capture is.
    ChooseCapture,
}

/// What the user wants done with the changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Save them, then go on.
    Save(PendingAction),
    /// Forget them, and go on.
    Discard(PendingAction),
    /// Stay.
    Stay,
}

/// The question, when it is open.
#[derive(Default)]
pub struct UnsavedChangesDialog {
    next: Option<PendingAction>,
    /// Whether the keyboard is on Save already.
    focused: bool,
}

impl UnsavedChangesDialog {
    /// Asks before `next`.
    pub fn open(&mut self, next: PendingAction) {
        *self = Self { next: Some(next), focused: false };
    }

    /// Whether it is open.
    pub fn is_open(&self) -> bool {
        self.next.is_some()
    }

    /// Draws it and returns the answer once it is given.
    pub fn show(&mut self, context: &Context, name: &str) -> Option<Answer> {
        let next = self.next.clone()?;
        let mut answer = None;
        let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
        let modal = egui::Modal::new(Id::unique("unsaved changes")).frame(frame).show(context, |ui| {
            ui.set_width(380.0);
            ui.heading("Save the changes?");
            ui.add_space(4.0);
            ui.label(format!("{name} was changed and not saved since."));
            ui.add_space(10.0);
            ui.horizontal(|ui| {
                let save = ui.button("Save").on_hover_text("Save, then go on.");
                if !std::mem::replace(&mut self.focused, true) {
                    save.request_focus();
                }
                if save.clicked() {
                    answer = Some(Answer::Save(next.clone()));
                }
                if ui.button("Discard").on_hover_text("Go on and lose the changes.").clicked() {
                    answer = Some(Answer::Discard(next.clone()));
                }
                if ui.button("Cancel").on_hover_text("Stay here.").clicked() {
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
