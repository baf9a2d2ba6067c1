//! The window: a thin layer of egui over the `session` crate.
//!
//! * [`Shell`]: the application: one frame from top to bottom, what the commands do.
//! * `paint_view`: the scene in 3D in the colours of its blur. `picture_view`: the refocused picture.
//!   Both are painted on by the same pointer code.
//! * `blit`: puts pictures on the screen.
//! * `graphics`: the device that it is drawn with. `soft_painter`: draws egui's shapes where an adapter in software draws.
//! * `layout`: where the panels are: docked, in tabs, afloat, or one over all.
//! * `drawer`: the atlas, the aperture view and the histogram, beneath the views at first.
//! * `inspector`, `tool_bar`, `menu_bar`, `status_line`: read the document and emit [`Action`]s.
//! * `palette`, `keys`, `help`, `menu_bar`: views of the one command table in `session`.
//! * `player`: a recording played in the window, timed.
//! * `region_highlight`: what a click would take, outlined beforehand.
//! * `pointer`, `drag_tool`, `brush_gesture`, `navigation`: what pointer and pen do.
//! * `file_dialog`, `unsaved_question`, `toasts`: what the window asks and tells.

mod action;
mod blit;
mod brush_gesture;
mod brush_ring;
mod controls;
mod curve_stroke;
pub(crate) mod demo;
mod drag_tool;
mod drawer;
mod false_colour;
mod file_dialog;
mod focus_slider;
mod graphics;
mod hand;
mod help;
mod inspector;
mod keys;
mod layout;
mod looking_round;
mod menu_bar;
mod navigation;
mod near_asked;
mod options;
mod paint_view;
mod palette;
mod picture_view;
mod plane_tool;
mod player;
mod pointer;
mod preset_name;
mod region_highlight;
mod shell;
mod soft_painter;
mod status_line;
mod theme;
mod toasts;
mod tool;
mod tool_bar;
mod tool_settings;
mod unsaved_question;
mod view_header;
mod view_settings;

pub use action::Action;
pub use drawer::Drawer;
pub use layout::{Layout, Pane};
pub use options::WindowOptions;
pub use paint_view::PaintView;
pub use picture_view::{DisplayedPicture, PictureView};
pub use shell::Shell;
pub use toasts::Severity;
pub use tool::Tool;
pub use view_settings::ViewSettings;

/// Opens the window and stays until it is closed.
pub fn run(options: WindowOptions) -> anyhow::Result<()> {
    let icon = eframe::icon_data::from_png_bytes(include_bytes!("../../../assets/desktop/focus-brush.png"))?;
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Focus Brush")
            .with_app_id("focus-brush")
            .with_icon(icon)
            .with_inner_size([1440.0, 860.0])
            .with_min_inner_size([800.0, 500.0]),
        wgpu_options: graphics::wgpu_configuration(),
        persist_window: options.remember,
        // For gradients that the window does not have, every pixel would be worked on.
        dithering: false,
        ..Default::default()
    };
    eframe::run_native(
        "focus-brush",
        native,
        Box::new(|creation| Ok(Box::new(Shell::new(creation, options).map_err(Box::new)?))),
    )
    .map_err(|error| anyhow::anyhow!("{error}"))
}
