//! What the row of tool options and the inspector share of the brush: its blur slider, its limits and its tooltips.

use super::controls;
use super::focus_slider::focus_slider;
use crate::window::Action;
use document::Document;
use egui::{Slider, Ui};
use focus::Brush;
use lens::{FocusOffset, Optics};
use session::Command;

/// Sends the brush if it changed.
pub fn push_brush_change(document: &Document, brush: Brush, actions: &mut Vec<Action>) {
    if brush != document.brush {
        actions.push(Command::SetBrush(brush).into());
    }
}

/// Tooltip of the size slider.
pub const SIZE_TIP: &str = "Radius of the brush on the surface. Keys: [ and ].";
/// Tooltip of the strength slider.
pub const STRENGTH_TIP: &str = "How far one stroke moves the focus toward the brush's.";

/// Tooltip of the hardness slider.
pub const HARDNESS_TIP: &str =
    "The share of the radius with full strength; beyond it the brush fades out. Keys: Shift+[ and Shift+].";

/// The largest brush radius: a quarter of the scene's diagonal.
pub fn largest_radius(document: &Document) -> f64 {
    let (low, high) = document.stage.bounds;
    let diagonal = (high - low).length();
    if diagonal > 0.0 && diagonal.is_finite() { diagonal / 4.0 } else { 1.0 }
}

/// A slider for the brush's radius, with its label before it.
pub fn size_slider(ui: &mut Ui, brush: &mut Brush, largest: f64) {
    let slider = Slider::new(&mut brush.radius, largest * 1e-3..=largest).logarithmic(true);
    labelled_slider(ui, "Size", SIZE_TIP, slider, "Brush size");
}

/// A slider for its strength, with its label before it.
pub fn strength_slider(ui: &mut Ui, brush: &mut Brush) {
    labelled_slider(
        ui,
        "Strength",
        STRENGTH_TIP,
        Slider::new(&mut brush.strength, 0.0..=1.0),
        "Brush strength",
    );
}

/// A slider for its hardness, with its label before it.
pub fn hardness_slider(ui: &mut Ui, brush: &mut Brush) {
    labelled_slider(
        ui,
        "Hardness",
        HARDNESS_TIP,
        Slider::new(&mut brush.hardness, 0.0..=1.0),
        "Brush hardness",
    );
}

fn labelled_slider(ui: &mut Ui, label: &str, tip: &str, slider: Slider<'_>, name: &str) {
    ui.label(label).on_hover_text(tip);
    controls::set_accessible_name(&ui.add(slider.show_value(false)).on_hover_text(tip), name);
}

/// The signed circle of confusion of an offset t, px: in the focus plane, or at any depth with anchor 1.
pub fn signed_circle_px(optics: &Optics, t: f64) -> f64 {
    let kappa = optics.kappa(optics.inverse_focus_distance, FocusOffset::new(t, 1.0));
    2.0 * optics.splat_radius_px(kappa)
}

/// The near–sharp–far slider for a focus. Returns the new focus if it was moved.
pub fn target_slider(ui: &mut Ui, optics: &Optics, target: FocusOffset, width: f32) -> Option<FocusOffset> {
    let mut circle_px = signed_circle_px(optics, target.t);
    let enabled = optics.aperture_radius > 0.0;
    let response = ui.add_enabled_ui(enabled, |ui| focus_slider(ui, &mut circle_px, width)).inner;
    let changed = response.changed();
    response
        .on_hover_text(
            "What the brush paints: from near blur over sharp to far blur. Keys: , and . to move, X for sharp.",
        )
        .on_disabled_hover_text("A pinhole blurs nothing: open the aperture first.");
    let kappa = optics.kappa_for_circle_px(circle_px).filter(|_| changed)?;
    let t = optics.offset_for_kappa(kappa, optics.inverse_focus_distance, 1.0)?;
    Some(FocusOffset { t, ..target })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::Camera;

    #[test]
    fn the_slider_speaks_of_the_circle_that_the_lens_draws() {
        let optics = Camera::default().optics();
        for t in [0.9, 1.0, 1.02] {
            let px = signed_circle_px(&optics, t);
            let kappa = optics.kappa(0.1, FocusOffset::new(t, 1.0));
            assert!((px.abs() - optics.circle_of_confusion_px(kappa)).abs() < 1e-9);
            assert_eq!(px < 0.0, t < 1.0, "near is negative");
        }
    }
}
