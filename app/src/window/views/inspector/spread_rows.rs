//! How the strokes of a layer are spread.

use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, row, rows};
use crate::window::widgets::keys;
use egui::{Button, Slider, Ui};
use focus::{FocusLayer, SpreadSettings};
use session::{Command, CommandId};

/// Draws the settings of spreading, which a layer that is spread follows as they change, and the buttons. `settings` are
/// those of the next layer.
pub fn spread_rows(
    ui: &mut Ui,
    layer: &FocusLayer,
    settings: &mut SpreadSettings,
    actions: &mut Vec<Action>,
) {
    if let Some(spread) = &layer.spread {
        *settings = spread.settings;
    }
    rows(ui, "spread", |ui| {
        let mut slide =
            |ui: &mut Ui, label: &str, tip: &str, slider: fn(&mut SpreadSettings) -> Slider<'_>| {
                let before = *settings;
                let response = row(ui, label, tip, |ui| controls::slider(ui, slider(settings)));
                if *settings != before && layer.spread.is_some() {
                    actions.push(Command::Spread(*settings).into());
                }
                finish_edit(&response, actions);
            };
        let tip =
            "How far the strokes of this layer spread, in texels across even surface. Edges hold them up.";
        slide(ui, "Spread", tip, |settings| {
            let [low, high] = SpreadSettings::REACH_RANGE;
            Slider::new(&mut settings.reach, low..=high).logarithmic(true).max_decimals(0)
        });
        let tip = "How soft the borders of what is spread are: 0 hard, 1 as soft as the picture's edges.";
        slide(ui, "Softness", tip, |settings| Slider::new(&mut settings.softness, 0.0..=1.0).max_decimals(2));
        let tip = "The difference of colour that counts as an edge. Less finds fainter edges; more ignores texture.";
        slide(ui, "Contrast", tip, |settings| {
            let [low, high] = SpreadSettings::CONTRAST_RANGE;
            Slider::new(&mut settings.contrast, low..=high).logarithmic(true).max_decimals(3)
        });
    });
    ui.horizontal_wrapped(|ui| {
        let buttons = [
            (CommandId::SpreadStrokes, "Spread strokes", layer.spread.is_none()),
            (CommandId::ShowStrokes, "Show strokes", layer.spread.is_some()),
        ];
        for (id, label, is_possible) in buttons {
            let response = ui.add_enabled(is_possible, Button::new(label));
            let tip = keys::command_tooltip(ui.ctx(), id);
            if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                actions.push(id.into());
            }
        }
    });
}
