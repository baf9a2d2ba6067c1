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
            let tip = format!(
                "{} Rough: few pixels or no blur, until there is a better one. Live: drawn within the tolerance (section \
                 Picture) while you work. Exact: without tolerance, once nothing changes. dB: PSNR of live against exact; from \
                 about 45 dB no difference is visible. More figures: section Statistics.",
                quality_figures(preview)
            );
            ui.label(quality_text(preview, session.exact_picture_progress())).on_hover_text(tip);
            ui.separator();
        }
        if let Some(document) = session.document().filter(|document| document.selection.is_some()) {
            ui.label(format!("painting {}", selection_summary(document)))
                .on_hover_text("Only the selection can be painted (Select menu).");
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
                let text = format!(
                    "{} · {} · {}{}",
                    hover.object,
                    controls::length_text(hover.depth),
                    controls::circle_text(hover.circle_px),
                    becomes.unwrap_or_default(),
                );
                let tip = format!(
                    "The object under the pointer: name, depth, current blur, and blur after using the tool. Painted: t {:.4}, anchor \
                     {:.2}, gloss {:.2}.",
                    hover.t, hover.anchor, hover.gloss
                );
                ui.add(egui::Label::new(text).truncate()).on_hover_text(tip);
                ui.separator();
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(egui::RichText::new(notes.tip).weak()).truncate());
            });
        });
    });
}

/// The quality of the picture, and the progress of a better one.
fn quality_text(preview: &Preview, drawing_exactly: Option<f32>) -> String {
    let exact = drawing_exactly.map(|share| format!(", exact {:.0} %", 100.0 * share)).unwrap_or_default();
    match (preview.kind, preview.quality) {
        (PreviewKind::Pinhole, _) => "no blur yet".into(),
        (PreviewKind::Defocused, _) => "rough blur".into(),
        (_, Quality::Coarse) => "rough picture".into(),
        (_, Quality::Viewing) => format!("live picture{exact}"),
        (_, Quality::Exact) => "exact picture".into(),
    }
}

/// Time, error and light of the picture, a sentence.
fn quality_figures(preview: &Preview) -> String {
    let DrawingCosts { viewing_psnr, light_psnr, light_passes, .. } = preview.costs;
    let took = controls::seconds_text(preview.seconds);
    let close = viewing_psnr.map(|psnr| format!(", live at {psnr:.0} dB")).unwrap_or_default();
    let at_once = light_psnr.map(|psnr| format!(", light at once at {psnr:.0} dB")).unwrap_or_default();
    let light =
        if light_passes > 0 { format!(", light of {light_passes} passes{at_once}") } else { String::new() };
    format!("Drawn in {took}{close}{light}.")
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
