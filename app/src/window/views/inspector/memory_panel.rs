//! What takes memory, by part.

use crate::window::widgets::controls::{bytes_text, row, rows};
use egui::Ui;
use session::Session;

/// The memory of the parts of the open document, of the rest, and of the whole program.
pub fn memory_panel(ui: &mut Ui, session: &Session) {
    let parts = session.memory();
    rows(ui, "memory", |ui| {
        let mut line = |name: &str, description: &str, bytes: usize| {
            row(ui, name, description, |ui| ui.label(bytes_text(bytes)));
        };
        for part in &parts {
            line(part.name, part.description, part.bytes);
        }
        if let Some(resident) = report::resident_bytes().and_then(|bytes| usize::try_from(bytes).ok()) {
            let counted: usize = parts.iter().map(|part| part.bytes).sum();
            let rest = "The program and its fonts, the window's and a software card's buffers, and what is being made.";
            line("Everything else", rest, resident.saturating_sub(counted));
            line("In all", "The resident memory of the program.", resident);
        }
    });
}
