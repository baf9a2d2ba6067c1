//! One line at the bottom: what is being worked on, how fast, and what to try.

use super::inspector::selection_summary;
use super::{Action, controls};
use egui::{Align, Layout, ProgressBar, Ui};
use session::{Command, DrawingCosts, JobStatus, Preview, PreviewKind, Quality, Session};

/// What lies under the pointer.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// The object's name.
    pub object: String,
    /// Axial depth in the shot camera.
    pub depth: f64,
    /// Signed circle of confusion on the full-size picture, px.
    pub circle_px: f64,
    /// What the tool in hand would make of it, px; none where that is no one blur.
    pub becomes_px: Option<f64>,
    /// The painted t.
    pub t: f64,
    /// The painted anchor.
    pub anchor: f64,
    /// How far gloss obeys them.
    pub gloss: f64,
}

/// What the line says beside what the session knows.
#[derive(Clone, Debug)]
pub struct StatusNotes<'a> {
    /// What lies under the pointer.
    pub hover: Option<Hover>,
    /// Whether the picture takes longer to sum than one would not notice.
    pub is_drawing: bool,
    /// What to try.
    pub tip: &'a str,
}

/// Draws the status line.
pub fn status_line(ui: &mut Ui, session: &Session, notes: StatusNotes<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        if let Some(preview) = session.preview().filter(|_| session.document().is_some()) {
            ui.label(quality_summary(preview, session.exact_picture_progress())).on_hover_text(
                "How good the picture is, and how long it took to draw. Rough: few pixels or no blur, until there is a \
                 better one. Live: drawn within the tolerance (section Picture) while you work. Exact: drawn without one, \
                 once nothing changes. dB: how close live comes to exact; from about 45 on nobody sees a difference.",
            );
            ui.separator();
            let samples = preview.modelled.sample_count();
            if samples > 0 {
                ui.label(format!("{} samples", controls::count_text(samples)))
                    .on_hover_text("Samples of the light field that the picture is summed from.");
                ui.separator();
            }
        }
        if let Some(document) = session.document() {
            let [held, budget] = document.undo_bytes().map(controls::bytes_text);
            ui.label(format!("undo {held} of {budget}")).on_hover_text(
                "Memory that the steps of undo hold, and may hold before the oldest are forgotten.",
            );
            if document.selection.is_some() {
                ui.separator();
                ui.label(format!("painting {}", selection_summary(document)))
                    .on_hover_text("Only what is selected can be painted (Select menu).");
            }
            ui.separator();
        }
        if session.sub_aperture_point().is_some() {
            ui.label("through one point of the aperture")
                .on_hover_text("The picture shows the scene as it looks from there. Esc shows it through all of the aperture.");
            ui.separator();
        }
        if notes.is_drawing {
            ui.label("drawing…").on_hover_text("The picture is being summed anew.");
            ui.separator();
        }
        for job in session.jobs() {
            show_job(ui, &job, actions);
            ui.separator();
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(hover) = &notes.hover {
                let becomes = hover.becomes_px.map(|px| format!(" becomes {}", controls::circle_text(px)));
                let gloss = if hover.gloss > 0.0 { format!(" · gloss {:.2}", hover.gloss) } else { String::new() };
                let text = format!(
                    "{} · {} deep · {}{} · t {:.4} · anchor {:.2}{gloss}",
                    hover.object,
                    controls::length_text(hover.depth),
                    controls::circle_text(hover.circle_px),
                    becomes.unwrap_or_default(),
                    hover.t,
                    hover.anchor
                );
                ui.label(text).on_hover_text(
                    "What lies under the pointer: its name, depth, its blur and what the tool would make of that, and the painted focus.",
                );
                ui.separator();
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(egui::RichText::new(notes.tip).weak()).truncate());
            });
        });
    });
}

/// How good the picture is, in words, and what it took.
fn quality_summary(preview: &Preview, drawing_exactly: Option<f32>) -> String {
    let took = controls::seconds_text(preview.seconds);
    let close = preview.costs.viewing_psnr.map(|psnr| format!(" · {psnr:.0} dB")).unwrap_or_default();
    let exact = drawing_exactly.map(|share| format!(" · exact {:.0} %", 100.0 * share)).unwrap_or_default();
    let light = light_summary(preview.costs);
    match (preview.kind, preview.quality) {
        (PreviewKind::Pinhole, _) => format!("no blur yet · {took}"),
        (_, Quality::Coarse) => format!("rough · {took}"),
        (_, Quality::Viewing) => format!("live · {took}{close}{exact}{light}"),
        (_, Quality::Exact) => format!("exact · {took}{light}"),
    }
}

/// By how many passes the light was refined, and how far that at once was from it.
fn light_summary(costs: DrawingCosts) -> String {
    let at_once = costs.light_psnr.map(|psnr| format!(", at once {psnr:.0} dB")).unwrap_or_default();
    if costs.light_passes == 0 {
        return String::new();
    }
    format!(" · light of {} passes{at_once}", costs.light_passes)
}

fn show_job(ui: &mut Ui, job: &JobStatus, actions: &mut Vec<Action>) {
    let step = if job.step.is_empty() { String::new() } else { format!(": {}", job.step) };
    ui.label(format!("{}{step}", job.label));
    let bar = ProgressBar::new(job.fraction).desired_width(90.0).show_percentage();
    controls::set_accessible_name(&ui.add(bar), &job.label);
    if let Some(left) = job.seconds_left {
        let left = controls::time_left_text(left);
        ui.label(left).on_hover_text("How long this step will take, going by how long it has taken so far.");
    }
    if ui.add_enabled(job.can_cancel, egui::Button::new("Stop")).on_hover_text("Stop this work.").clicked() {
        actions.push(Command::Cancel(job.id).into());
    }
}
