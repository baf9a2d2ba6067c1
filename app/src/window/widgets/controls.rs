//! Rows of the inspector (a label, a control, and a tooltip on both), accessible names, and formatted numbers.

use crate::window::Action;
use crate::window::widgets::icon::Icon;
use egui::{Atom, Button, DragValue, Response, Slider, Ui, WidgetText, vec2};
use session::Command;

/// Width of the labels of rows, points.
const LABEL_WIDTH: f32 = 92.0;

/// Most that the fields of rows are wide, points.
const LARGEST_FIELD: f32 = 260.0;

/// Width of the number behind a slider, and of one of several fields in a row, points.
const SMALL_FIELD: f32 = 52.0;

/// Adds a row to a two-column grid: a label, then the control, which takes the label as its accessible name. A number fills the
/// column; several controls are put into [`beside`].
pub fn row(
    ui: &mut Ui,
    label: impl Into<WidgetText>,
    tooltip: &str,
    control: impl FnOnce(&mut Ui) -> Response,
) -> Response {
    let tooltip = |ui: &mut Ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(tooltip);
    };
    explained_row(ui, label, tooltip, control)
}

/// The same, with a tooltip that holds more than words.
pub fn explained_row(
    ui: &mut Ui,
    label: impl Into<WidgetText>,
    tooltip: impl Fn(&mut Ui),
    control: impl FnOnce(&mut Ui) -> Response,
) -> Response {
    let label = ui.label(label).on_hover_ui(&tooltip);
    let field = ui.spacing().combo_width;
    let before = std::mem::replace(&mut ui.spacing_mut().interact_size.x, field);
    let response = control(ui).labelled_by(label.id).on_hover_ui(&tooltip);
    ui.spacing_mut().interact_size.x = before;
    ui.end_row();
    response
}

/// A two-column grid for [`row`]s, whose fields are equally wide.
pub fn rows(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    let spacing = vec2(8.0, 5.0);
    let field = (ui.available_width() - LABEL_WIDTH - spacing.x).clamp(SMALL_FIELD, LARGEST_FIELD);
    egui::Grid::new(id).num_columns(2).min_col_width(LABEL_WIDTH).spacing(spacing).show(ui, |ui| {
        ui.spacing_mut().combo_width = field;
        ui.spacing_mut().slider_width = field - SMALL_FIELD - ui.spacing().item_spacing.x;
        add(ui);
    });
}

/// Several controls in one [`row`].
pub fn beside<R>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> egui::InnerResponse<R> {
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.x = SMALL_FIELD;
        add(ui)
    })
}

/// A slider with its number in a [`row`].
pub fn slider(ui: &mut Ui, slider: Slider<'_>) -> Response {
    ui.spacing_mut().interact_size.x = SMALL_FIELD;
    ui.add(slider)
}

/// Finishes an edit when its control is released, so that a drag is one undo step.
pub fn finish_edit(response: &Response, actions: &mut Vec<Action>) {
    if response.drag_stopped() || response.lost_focus() {
        actions.push(Command::FinishEdit.into());
    }
}

/// A number that changes in proportion to its value when dragged: for lengths and f-numbers.
pub fn proportional_value<'a>(value: &'a mut f64, range: std::ops::RangeInclusive<f64>) -> DragValue<'a> {
    let speed = value.abs().clamp(1e-6, 1e9) * 0.01;
    DragValue::new(value).speed(speed).range(range)
}

/// Sets the accessible name of a control without a label, for screen readers and tests.
pub fn set_accessible_name(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A selectable row of a list, as wide as the list and left-aligned.
pub fn list_row(ui: &mut Ui, chosen: bool, text: &str) -> Response {
    let layout = egui::Layout::top_down_justified(egui::Align::LEFT);
    ui.with_layout(layout, |ui| ui.add(Button::selectable(chosen, text))).inner
}

/// An entry of a menu with an icon before its name and its shortcut behind it.
pub fn icon_entry(ui: &mut Ui, icon: Icon, name: &str, shortcut: String) -> Response {
    let side = ui.text_style_height(&egui::TextStyle::Button);
    let room = egui::IdSalt::new("icon");
    let mut button = Button::new((Atom::custom(room, egui::Vec2::splat(side)), name));
    if !shortcut.is_empty() {
        button = button.shortcut_text(shortcut);
    }
    let shown = button.atom_ui(ui);
    if let Some(rect) = shown.rect(room) {
        let color = ui.style().interact(&shown.response).text_color();
        icon.paint(ui.painter(), rect, color);
    }
    shown.response
}

/// A length in metres with three significant digits.
pub fn length_text(metres: f64) -> String {
    if metres.is_infinite() { "∞".into() } else { format!("{} m", significant_digits(metres)) }
}

/// A number with three significant digits.
pub fn significant_digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = (2 - magnitude).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

/// Formats the number of a control: three significant digits without trailing zeros.
pub fn format_number(value: f64, _decimals: std::ops::RangeInclusive<usize>) -> String {
    let text = significant_digits(value);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// A number of bytes with a decimal unit.
pub fn bytes_text(count: usize) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{} kB", significant_digits(count as f64 / 1e3)),
        1_000_000..1_000_000_000 => format!("{} MB", significant_digits(count as f64 / 1e6)),
        _ => format!("{} GB", significant_digits(count as f64 / 1e9)),
    }
}

/// A count, abbreviated from 10 000 on.
pub fn count_text(n: usize) -> String {
    match n {
        0..10_000 => n.to_string(),
        10_000..1_000_000 => format!("{} k", significant_digits(n as f64 / 1e3)),
        _ => format!("{} M", significant_digits(n as f64 / 1e6)),
    }
}

/// A duration, in milliseconds below one second.
pub fn seconds_text(seconds: f64) -> String {
    if seconds < 1.0 {
        format!("{} ms", significant_digits(seconds * 1e3))
    } else {
        format!("{} s", significant_digits(seconds))
    }
}

/// A remaining time, rounded to the precision of such an estimate.
pub fn time_left_text(seconds: u32) -> String {
    match seconds {
        0..10 => format!("{seconds} s left"),
        10..90 => format!("{} s left", seconds.div_ceil(5) * 5),
        _ => format!("{} min left", seconds.div_ceil(60)),
    }
}

/// A signed circle of confusion in words: `near 12 px`, `sharp`, `far 3.1 px`.
pub fn circle_text(px: f64) -> String {
    match px {
        _ if px.abs() < 0.05 => "sharp".into(),
        _ if px < 0.0 => format!("near {} px", significant_digits(-px)),
        _ => format!("far {} px", significant_digits(px)),
    }
}

/// A signed circle of confusion as an amount: `12 px of near blur`, `no blur`.
pub fn circle_amount_text(px: f64) -> String {
    match px {
        _ if px.abs() < 0.05 => "no blur".into(),
        _ if px < 0.0 => format!("{} px of near blur", significant_digits(-px)),
        _ => format!("{} px of far blur", significant_digits(px)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(significant_digits(0.012345), "0.0123");
        assert_eq!(significant_digits(1234.5), "1234");
        assert_eq!(significant_digits(1.0), "1.00");
        assert_eq!(format_number(1.4, 0..=3), "1.4");
        assert_eq!(format_number(100.0, 0..=3), "100");
        assert_eq!(length_text(f64::INFINITY), "∞");
        assert_eq!(bytes_text(12_300_000), "12.3 MB");
        assert_eq!(count_text(1_900_000), "1.90 M");
        assert_eq!(seconds_text(0.021), "21.0 ms");
        assert_eq!(circle_text(-12.0), "near 12.0 px");
        assert_eq!(circle_text(0.0), "sharp");
    }
}
