//! The history: every step with a thumbnail of what it changed; a click goes to that step.

use crate::window::Action;
use crate::window::widgets::focus_thumbnail::focus_thumbnail;
use crate::window::widgets::{controls, keys};
use document::{Document, HistoryStep};
use egui::{Rect, RichText, ScrollArea, Sense, Ui, pos2, vec2};
use lens::Optics;
use session::{Command, CommandId};

/// Side of a step's thumbnail, points.
const THUMBNAIL_SIDE: f32 = 28.0;

/// The steps, the latest on top, with the current one marked.
pub fn history_panel(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let steps: Vec<HistoryStep<'_>> = document.history().collect();
    let done = steps.iter().filter(|step| step.is_done).count();
    if steps.is_empty() {
        ui.weak("Nothing has been done yet.");
        return;
    }
    let optics = document.camera.optics();
    let height = THUMBNAIL_SIDE + 2.0;
    // The latest step is on top, the document as it was opened at the bottom.
    let rows = steps.len() + 1;
    let area = ScrollArea::vertical().id_salt("history").max_height(240.0).min_scrolled_height(160.0);
    area.show_rows(ui, height, rows, |ui, range| {
        for row in range {
            let number = rows - 1 - row;
            let step = number.checked_sub(1).map(|index| &steps[index]);
            if step_row(ui, &optics, number, step, number == done) && number != done {
                actions.push(Command::GoToHistoryStep(number).into());
            }
        }
    });
    ui.horizontal(|ui| {
        for (id, name) in [(CommandId::Undo, document.undo_name()), (CommandId::Redo, document.redo_name())] {
            let button = egui::Button::new(id.info().name);
            let response = ui.add_enabled(name.is_some(), button);
            if response.on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
                actions.push(id.into());
            }
        }
        let [held, budget] = document.undo_bytes().map(controls::bytes_text);
        ui.weak(format!("{held} of {budget}")).on_hover_text(
            "Memory used by the undo steps, and the limit beyond which the oldest are dropped.",
        );
    });
}

/// Draws one step. Returns whether it was clicked.
fn step_row(ui: &mut Ui, optics: &Optics, number: usize, step: Option<&HistoryStep<'_>>, here: bool) -> bool {
    let size = vec2(ui.available_width(), THUMBNAIL_SIDE);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = step.map_or("As opened", |step| step.name);
    let text = format!("{number}  {name}");
    let is_done = step.is_none_or(|step| step.is_done);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, here, &text));
    let visuals = ui.style().interact_selectable(&response, here);
    if here || response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, visuals.corner_radius, visuals.weak_bg_fill);
    }
    let picture = Rect::from_min_size(rect.min, vec2(THUMBNAIL_SIDE, THUMBNAIL_SIDE)).shrink(1.0);
    match step.and_then(|step| step.thumbnail) {
        Some(thumbnail) => focus_thumbnail(ui, picture, thumbnail, optics),
        None => {
            ui.painter().rect_filled(picture, 2.0, ui.visuals().extreme_bg_color);
        }
    }
    let color = if is_done { visuals.text_color() } else { ui.visuals().weak_text_color() };
    let at = pos2(picture.right() + 8.0, rect.center().y);
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().text(at, egui::Align2::LEFT_CENTER, text, font, color);
    let tip = match (here, is_done) {
        (true, _) => "The current state.",
        (false, true) => "Undo everything after this.",
        (false, false) => "Redo everything up to this.",
    };
    response.on_hover_text(RichText::new(tip)).clicked()
}
