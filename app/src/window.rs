//! The window: a thin layer of egui over the `session` crate.
//!
//! * [`Shell`] (`shell`): the application; runs one frame from top to bottom and performs the commands.
//! * `chrome`: menu bar, tools, status line, palette, help, toasts, and the headers of the panes; they read
//!   the document and emit [`Action`]s. Menus, palette, keys and help are views of the one command table in
//!   `session`.
//! * `dialogs`: files, unsaved changes, preset names, depth polarity.
//! * `views`: what the panes contain: `paint_view` is the scene in 3D in the colours of its blur,
//!   `picture_view` the refocused picture, `inspector` the properties, `drawer` the atlas, the aperture and
//!   the histogram.
//! * [`ViewSettings`] (`view_settings`): the user's own settings, saved between runs.
//! * `tools`: what pointer and pen do in both pictures, and the marks they draw there.
//! * `widgets`: what bars, panes, dialogs and tools share: controls and formatted numbers, keys, the theme, the
//!   false colours of blur.
//! * [`Action`] (`action`): a request to the shell.
//! * `layout`: where the panes are: docked, in tabs, floating, or one over all.
//! * `graphics`: the wgpu device; `blit` puts pictures on the screen, `soft_painter` draws egui's shapes on a
//!   software adapter.
//! * `stroke_player`: plays a recording in the window, timed. `frame_log`: writes how long frames take. `demo`: the
//!   scene at first start. `book`: the pages that *Help* opens.
//! * `installed`: locates what comes with the program.
//!
//! A module uses only modules below it in this list.

mod action;
mod book;
mod chrome;
pub(crate) mod demo;
mod dialogs;
mod frame_log;
mod graphics;
mod installed;
mod layout;
mod options;
mod shell;
mod stroke_player;
mod tools;
mod view_settings;
mod views;
mod widgets;

pub use action::Action;
pub use chrome::toasts::Severity;
pub use layout::{Arrangement, Layout, Pane};
pub use options::WindowOptions;
pub use shell::Shell;
pub use tools::tool::Tool;
pub use view_settings::ViewSettings;
pub use views::drawer::Drawer;
pub use views::paint_view::PaintView;
pub use views::picture_view::{DisplayedPicture, PictureView};

/// Opens the window and returns when it is closed.
///
/// # Errors
/// There is no window system or no graphics device.
pub fn run(options: WindowOptions) -> anyhow::Result<()> {
    crate::heap::return_freed_blocks();
    let icon = eframe::icon_data::from_png_bytes(include_bytes!("../../assets/desktop/focus-brush.png"))?;
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Focus Brush")
            .with_app_id("focus-brush")
            .with_icon(icon)
            .with_inner_size([1440.0, 860.0])
            .with_min_inner_size([800.0, 500.0]),
        wgpu_options: graphics::device::wgpu_configuration(),
        persist_window: options.remember,
        // Dithering costs time on every pixel, and the window has no gradients.
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
