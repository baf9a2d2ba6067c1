//! The theme: neutral greys and one accent colour, which marks what is chosen and the main action; nothing else near the picture is coloured.

use egui::{Color32, CornerRadius, Stroke, Theme, Visuals};

/// Colour of warnings.
pub const WARNING: Color32 = Color32::from_rgb(232, 190, 110);
/// Colour of errors.
pub const ERROR: Color32 = Color32::from_rgb(240, 140, 120);
/// Neutral grey around the picture.
pub const SURROUNDINGS: Color32 = Color32::from_gray(48);

/// Sets colours and spacing of both themes.
pub fn prepare(context: &egui::Context) {
    // The scale is a setting with its own commands.
    context.options_mut(|options| options.zoom_with_keyboard = false);
    for (theme, visuals) in [(Theme::Dark, dark()), (Theme::Light, light())] {
        context.set_visuals_of(theme, visuals);
        context.style_mut_of(theme, |style| {
            style.spacing.item_spacing = egui::vec2(6.0, 5.0);
            style.spacing.button_padding = egui::vec2(6.0, 2.0);
            style.spacing.slider_width = 150.0;
            style.interaction.tooltip_delay = 0.4;
            style.url_in_tooltip = true;
        });
    }
}

/// The frame of a bar along the window's edge. It is not filled: the window is already cleared with the panel
/// colour, and filling is slow on a software adapter.
pub fn bar_frame(style: &egui::Style) -> egui::Frame {
    egui::Frame::side_top_panel(style).fill(Color32::TRANSPARENT)
}

/// Sets the theme and the scale of the user interface.
pub fn apply_theme(context: &egui::Context, light: bool, scale: f32) {
    context.set_theme(if light { Theme::Light } else { Theme::Dark });
    context.set_zoom_factor(scale.clamp(0.5, 3.0));
}

/// Grey levels from window to text, the accent, and the two message colours.
struct GreyLevels {
    panel: u8,
    window: u8,
    inset: u8,
    faint: u8,
    outline: u8,
    /// Fill of what is chosen.
    accent: Color32,
    /// De-emphasised text.
    weak: u8,
    /// Fill and text of widgets: noninteractive, inactive, hovered, active, open.
    widgets: [[u8; 2]; 5],
    messages: [Color32; 2],
}

fn dark() -> Visuals {
    let greys = GreyLevels {
        panel: 38,
        window: 44,
        inset: 24,
        faint: 43,
        outline: 56,
        weak: 150,
        accent: Color32::from_rgb(54, 102, 166),
        widgets: [[38, 190], [58, 215], [74, 245], [92, 255], [52, 230]],
        messages: [WARNING, ERROR],
    };
    visuals(Visuals::dark(), &greys)
}

fn light() -> Visuals {
    let greys = GreyLevels {
        panel: 214,
        window: 224,
        inset: 240,
        faint: 208,
        outline: 176,
        weak: 86,
        accent: Color32::from_rgb(36, 92, 170),
        widgets: [[214, 50], [196, 25], [182, 0], [164, 0], [204, 15]],
        messages: [Color32::from_rgb(122, 80, 0), Color32::from_rgb(160, 30, 10)],
    };
    visuals(Visuals::light(), &greys)
}

fn visuals(mut visuals: Visuals, greys: &GreyLevels) -> Visuals {
    let grey = Color32::from_gray;
    visuals.panel_fill = grey(greys.panel);
    visuals.window_fill = grey(greys.window);
    visuals.extreme_bg_color = grey(greys.inset);
    visuals.faint_bg_color = grey(greys.faint);
    visuals.window_stroke = Stroke::new(1.0, grey(greys.outline));
    visuals.window_corner_radius = CornerRadius::same(4);
    visuals.menu_corner_radius = CornerRadius::same(4);
    visuals.selection.bg_fill = greys.accent;
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
    visuals.hyperlink_color = grey(greys.widgets[1][1]);
    [visuals.warn_fg_color, visuals.error_fg_color] = greys.messages;
    visuals.weak_text_color = Some(grey(greys.weak));
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    let kinds = [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ];
    for (widget, [fill, text]) in kinds.into_iter().zip(greys.widgets) {
        widget.bg_fill = grey(fill);
        widget.weak_bg_fill = grey(fill);
        widget.fg_stroke = Stroke::new(1.0, grey(text));
        widget.corner_radius = CornerRadius::same(3);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, grey(greys.outline));
    widgets.inactive.bg_stroke = Stroke::NONE;
    let between = |share: f32| {
        let [low, high] = [greys.panel as f32, greys.widgets[1][1] as f32];
        grey((low + (high - low) * share) as u8)
    };
    widgets.hovered.bg_stroke = Stroke::new(1.0, between(0.4));
    widgets.active.bg_stroke = Stroke::new(1.0, between(0.63));
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour (WCAG 2.1).
    fn luminance(color: Color32) -> f64 {
        let [r, g, b, _] = color.to_array().map(|value| {
            let value = f64::from(value) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// Contrast ratio of two colours (WCAG 2.1), from 1 to 21.
    fn contrast(one: Color32, other: Color32) -> f64 {
        let (low, high) = (luminance(one).min(luminance(other)), luminance(one).max(luminance(other)));
        (high + 0.05) / (low + 0.05)
    }

    #[test]
    fn every_text_has_a_contrast_of_at_least_4_5() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        assert!(
            contrast(Color32::from_gray(118), Color32::WHITE) > 4.5
                && contrast(Color32::from_gray(120), Color32::WHITE) < 4.5
        );
        for (theme, visuals) in [("dark", dark()), ("light", light())] {
            let panels = [visuals.panel_fill, visuals.window_fill];
            let widgets = &visuals.widgets;
            let mut pairs = vec![(visuals.selection.stroke.color, visuals.selection.bg_fill, "chosen")];
            for widget in [&widgets.inactive, &widgets.hovered, &widgets.active, &widgets.open] {
                pairs.push((widget.fg_stroke.color, widget.weak_bg_fill, "a control"));
            }
            for panel in panels {
                pairs.push((widgets.noninteractive.fg_stroke.color, panel, "text"));
                pairs.push((visuals.weak_text_color(), panel, "weak text"));
                pairs.push((visuals.warn_fg_color, panel, "a warning"));
                pairs.push((visuals.error_fg_color, panel, "an error"));
            }
            pairs.push((widgets.inactive.fg_stroke.color, visuals.extreme_bg_color, "typed text"));
            for (text, fill, what) in pairs {
                let ratio = contrast(text, fill);
                assert!(ratio >= 4.5, "{theme}, {what}: {ratio:.2} of {text:?} on {fill:?}");
            }
        }
    }
}
