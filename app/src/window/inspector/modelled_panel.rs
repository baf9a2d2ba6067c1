//! What the light field holds: only what the scene needs.

use crate::window::controls::{bytes, count, row, rows, seconds};
use egui::Ui;
use session::{Document, Session};

/// Samples, memory and time of the light field.
pub fn modelled_panel(ui: &mut Ui, session: &Session, document: &Document) {
    let Some(preview) = session.preview() else {
        ui.weak("Nothing yet.");
        return;
    };
    let statistics = preview.statistics;
    let total = statistics.open + statistics.partial + statistics.background;
    let share = |n: usize| if total > 0 { 100.0 * n as f64 / total as f64 } else { 0.0 };
    rows(ui, "modelled", |ui| {
        let mut line = |label: &str, tip: &str, value: String| {
            row(ui, label, tip, |ui| ui.label(value));
        };
        let samples = format!("{}, {}", count(total), bytes(statistics.bytes));
        line("Samples", "Pieces of surface that some point of the aperture sees, and their memory.", samples);
        let open = format!("{:.0} %", share(statistics.open));
        line("Open", "Samples that see the whole aperture: one colour is enough.", open);
        let partial = format!("{:.0} %", share(statistics.partial));
        line("At edges", "Samples that something hides from part of the aperture.", partial);
        let background = format!("{:.0} %", share(statistics.background));
        line("Background", "Samples at infinity.", background);
        let size = format!("{} × {} px", preview.camera.width, preview.camera.height);
        line("Drawn at", "Size of the live picture.", size);
        line("Drawn in", "How long the last picture took.", seconds(preview.seconds));
        let map = format!("{} × {}", document.map.width(), document.map.height());
        line("Focus map", "Texels of the painted map.", map);
    });
}
