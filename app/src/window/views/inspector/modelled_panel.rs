//! What the light field contains; the same table as in `info` and `report`.

use crate::window::widgets::controls::{bytes_text, count_text, row, rows, seconds_text};
use document::Document;
use egui::{RichText, Ui};
use render::Modelled;
use session::{LivePicture, Session};

/// Texels, samples and memory of the light field by kind, and the time of the last picture.
pub fn modelled_panel(ui: &mut Ui, session: &Session, document: &Document) {
    let Some(preview) = session.preview() else {
        ui.weak("Nothing yet.");
        return;
    };
    kinds_table(ui, &preview.modelled);
    ui.add_space(4.0);
    rows(ui, "modelled", |ui| {
        let mut line = |label: &str, tip: &str, value: String| {
            row(ui, label, tip, |ui| ui.label(value));
        };
        let each = format!("{:.0} B", preview.modelled.bytes_a_sample());
        line("A sample", "Mean memory per sample; the dense form would take 384 B each.", each);
        let size = format!("{} × {} px", preview.camera.width, preview.camera.height);
        line("Drawn at", "Size of the live picture.", size);
        let by = match &preview.picture {
            LivePicture::InMemory(_) => "the processor",
            LivePicture::OnCard(picture) => picture.card_name(),
        };
        line("Drawn by", "Device that sums the picture.", by.into());
        line("Drawn in", "Time taken by the last picture.", seconds_text(preview.seconds));
        let map = format!("{} × {}", document.map.width(), document.map.height());
        line("Focus map", "Size of the painted map in texels.", map);
    });
}

/// The table of kinds.
fn kinds_table(ui: &mut Ui, modelled: &Modelled) {
    egui::Grid::new("kinds").num_columns(4).spacing([10.0, 4.0]).striped(true).show(ui, |ui| {
        for (title, tip) in [
            ("kind", "What is counted."),
            ("texels", "Texels of the atlas; estimated for a large atlas."),
            ("samples", "Surface samples that the picture is summed from."),
            ("memory", "Memory of these samples."),
        ] {
            ui.label(RichText::new(title).weak()).on_hover_text(tip);
        }
        ui.end_row();
        for row in modelled.rows() {
            ui.label(row.kind).on_hover_text(row.what);
            let cell = |value: Option<String>| value.unwrap_or_else(|| "–".into());
            ui.label(cell(row.texels.map(count_text)));
            ui.label(cell(row.samples.map(count_text)));
            ui.label(cell(row.bytes.map(bytes_text)));
            ui.end_row();
        }
    });
}
