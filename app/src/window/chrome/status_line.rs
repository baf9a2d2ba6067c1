//! The status line: picture quality, jobs, the surface under the pointer, and a tip.

use crate::window::Action;
use crate::window::views::inspector::selection_summary;
use crate::window::widgets::controls;
use egui::{Align, Layout, ProgressBar, Ui};
use jobs::JobStatus;
use session::{Command, DrawingCosts, Preview, PreviewKind, Quality, Session};

/// The surface point under the pointer.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// The object's name.
    pub object: String,
    /// Axial depth in the shot camera.
    pub depth: f64,
    /// Signed circle of confusion in the full-size picture, px.
    pub circle_px: f64,
    /// Circle of confusion that the active tool would give it, px; `None` if that is not a single value.
    pub becomes_px: Option<f64>,
    /// The painted t.
    pub t: f64,
    /// The painted anchor.
    pub anchor: f64,
    /// The painted gloss.
    pub gloss: f64,
}

/// Inputs of the status line other than the session.
#[derive(Clone, Debug)]
pub struct StatusNotes<'a> {
    /// The surface point under the pointer.
    pub hover: Option<Hover>,
    /// Whether the picture has been summing for a noticeable time.
    pub is_drawing: bool,
    /// The tip to show.
    pub tip: &'a str,
}

/// Draws the status line.
pub fn status_line(ui: &mut Ui, session: &Session, notes: StatusNotes<'_>, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        if let Some(preview) = session.preview().filter(|_| session.document().is_some()) {
            ui.label(quality_summary(preview, session.exact_picture_progress())).on_hover_text(
                "Quality of the picture and the time it took. Rough: few pixels or no blur, until there is a \
                 better one. Live: drawn within the tolerance (section Picture) while you work. Exact: without tolerance, \
                 once nothing changes. dB: PSNR of live against exact; from about 45 dB no difference is visible.",
            );
            ui.separator();
            let samples = preview.modelled.sample_count();
            if samples > 0 {
                ui.label(format!("{} samples", controls::count_text(samples)))
                    .on_hover_text("Light-field samples that the picture is summed from.");
                ui.separator();
            }
        }
        if let Some(document) = session.document() {
            let [held, budget] = document.undo_bytes().map(controls::bytes_text);
            ui.label(format!("undo {held} of {budget}")).on_hover_text(
                "Memory used by the undo steps, and the limit beyond which the oldest are dropped.",
            );
            if document.selection.is_some() {
                ui.separator();
                ui.label(format!("painting {}", selection_summary(document)))
                    .on_hover_text("Only the selection can be painted (Select menu).");
            }
            ui.separator();
        }
        if session.sub_aperture_point().is_some() {
            ui.label("through one point of the aperture")
                .on_hover_text("The picture shows the scene through a single aperture point. Esc returns to \
                                the whole aperture.");
            ui.separator();
        }
        if notes.is_drawing {
            ui.label("drawing…").on_hover_text("The picture is being summed.");
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
                    "The object under the pointer: name, depth, current blur, blur after using the tool, and \
                     painted focus.",
                );
                ui.separator();
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(egui::RichText::new(notes.tip).weak()).truncate());
            });
        });
    });
}

/// The quality of the picture and its draw time, as text.
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

/// Number of light passes, and the PSNR of the unrefined light against them.
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
        ui.label(left).on_hover_text("Remaining time of this step, extrapolated from the time so far.");
    }
    if ui.add_enabled(job.can_cancel, egui::Button::new("Stop")).on_hover_text("Stop this work.").clicked() {
        actions.push(Command::Cancel(job.id).into());
    }
}
