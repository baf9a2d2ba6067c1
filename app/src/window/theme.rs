//! The look: neutral greys without any colour near the picture, so that the eye judges the picture alone.

use egui::{Color32, CornerRadius, Stroke, Visuals};

/// Text that warns.
pub const WARNING: Color32 = Color32::from_rgb(232, 190, 110);
/// Text that tells of a failure.
pub const ERROR: Color32 = Color32::from_rgb(240, 140, 120);
/// Surroundings of the picture: the grey that pictures are judged against.
pub const SURROUNDINGS: Color32 = Color32::from_gray(48);

/// Sets colours and spacing.
pub fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.set_visuals_of(egui::Theme::Dark, visuals());
    context.style_mut_of(egui::Theme::Dark, |style| {
        style.spacing.item_spacing = egui::vec2(6.0, 5.0);
        style.spacing.button_padding = egui::vec2(6.0, 2.0);
        style.spacing.slider_width = 150.0;
        style.interaction.tooltip_delay = 0.4;
        style.url_in_tooltip = true;
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    let grey = Color32::from_gray;
    visuals.panel_fill = grey(38);
    visuals.window_fill = grey(44);
    visuals.extreme_bg_color = grey(24);
    visuals.faint_bg_color = grey(43);
    visuals.window_stroke = Stroke::new(1.0, grey(70));
    visuals.window_corner_radius = CornerRadius::same(4);
    visuals.menu_corner_radius = CornerRadius::same(4);
    visuals.selection.bg_fill = grey(96);
    visuals.selection.stroke = Stroke::new(1.0, grey(250));
    visuals.hyperlink_color = grey(225);
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, 38, 190),
        (&mut widgets.inactive, 58, 215),
        (&mut widgets.hovered, 74, 245),
        (&mut widgets.active, 92, 255),
        (&mut widgets.open, 52, 230),
    ] {
        widget.bg_fill = grey(fill);
        widget.weak_bg_fill = grey(fill);
        widget.fg_stroke = Stroke::new(1.0, grey(text));
        widget.corner_radius = CornerRadius::same(3);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, grey(56));
    widgets.inactive.bg_stroke = Stroke::NONE;
    widgets.hovered.bg_stroke = Stroke::new(1.0, grey(110));
    widgets.active.bg_stroke = Stroke::new(1.0, grey(150));
    visuals
}
