//! The help windows: all shortcuts from the command table, and information about the program.

use crate::window::tools::navigation;
use crate::window::widgets::keys;
use egui::{Align2, Context, Grid, RichText, ScrollArea, Window};
use session::{COMMANDS, Menu};

/// Pointer gestures, which are not in the command table.
const GESTURES: [(&str, &str); 7] = [
    ("Left drag", "paint, in either view"),
    ("Shift+click", "draw a straight line from the last stroke"),
    ("Esc during a stroke", "take the stroke back"),
    ("Wheel, pinch", "come nearer, in either view"),
    ("Double click with the middle button", "fit the picture"),
    ("Drop a file on the window", "open it"),
    ("Tab, arrow keys", "reach and move every control"),
];

/// Which windows are open.
#[derive(Default)]
pub struct Help {
    /// The list of shortcuts.
    pub shortcuts: bool,
    /// Version and licence.
    pub about: bool,
}

impl Help {
    /// Closes the windows that are open; returns whether any was.
    pub fn close(&mut self) -> bool {
        let was_open = self.shortcuts || self.about;
        *self = Self::default();
        was_open
    }

    /// Draws the windows that are open.
    pub fn show(&mut self, context: &Context, adapter: &str) {
        let shortcuts =
            Window::new("Keyboard and mouse").open(&mut self.shortcuts).default_size([660.0, 480.0]);
        // Keeps it within the window, title and edges included, at any scale.
        let room = context.content_rect().size() - egui::vec2(30.0, 70.0);
        let shortcuts = shortcuts.max_size(room);
        let middle = context.content_rect().center();
        let shortcuts = shortcuts.pivot(Align2::CENTER_CENTER).default_pos(middle);
        shortcuts.collapsible(false).show(context, |ui| {
            ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
                let map = keys::key_map(ui.ctx());
                ui.label(format!("Keys and mouse as in {} (View menu).", map.name()));
                let gestures = GESTURES.into_iter().chain(navigation::gestures(map));
                shortcut_table(ui, "Mouse and pen", gestures.map(|(key, what)| (key.to_string(), what)));
                for menu in Menu::ALL {
                    let rows = COMMANDS.iter().filter(|info| info.menu == menu);
                    let rows =
                        rows.filter_map(|info| Some((map.shortcut(info.id)?.to_string(), info.tooltip)));
                    shortcut_table(ui, menu.title(), rows);
                }
            });
        });
        let about = Window::new("About Focus Brush").open(&mut self.about).default_width(400.0);
        let about = about.pivot(Align2::CENTER_CENTER).default_pos(middle);
        about.collapsible(false).resizable(false).show(context, |ui| {
            ui.label(RichText::new(concat!("Focus Brush ", env!("CARGO_PKG_VERSION"))).strong());
            ui.label(
                "Paint the focus of a 3D scene, and see the picture formed by rays through a wide aperture.",
            );
            ui.add_space(6.0);
            ui.label("Licence: MIT or Apache-2.0, at your option.");
            ui.label(format!("Graphics adapter: {adapter}"));
        });
    }
}

fn shortcut_table(ui: &mut egui::Ui, title: &str, rows: impl Iterator<Item = (String, &'static str)>) {
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        return;
    }
    ui.label(RichText::new(title).strong());
    // Two columns that fit; longer text wraps.
    let keys = (ui.available_width() * 0.42).min(280.0);
    let words = (ui.available_width() - keys - 24.0).max(60.0);
    Grid::new(title).num_columns(2).min_col_width(keys).show(ui, |ui| {
        let cell = |ui: &mut egui::Ui, width: f32, text: RichText| {
            ui.scope(|ui| {
                ui.set_max_width(width);
                ui.add(egui::Label::new(text).wrap());
            });
        };
        for (key, what) in rows {
            cell(ui, keys, RichText::new(key).monospace());
            cell(ui, words, RichText::new(what));
            ui.end_row();
        }
    });
    ui.add_space(8.0);
}
