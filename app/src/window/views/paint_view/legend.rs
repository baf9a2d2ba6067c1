//! The legend of the paint view, in its lower right corner.

use super::surface_overlay::{MAX_COUNTED, OverlayKind, UNOBSERVED_COLOR, share_of_count};
use crate::window::widgets::false_colour;
use egui::{Align2, Color32, FontId, Painter, Rect, pos2, vec2};

/// Smallest view with room for the legend, points.
const MIN_WIDTH: f32 = 120.0;
const MIN_HEIGHT: f32 = 260.0;
/// Height of a bar with its labels, points.
const ROW: f32 = 40.0;

/// Draws the legend of the focus colours, if they are shown, and that of the overlay above it.
pub fn paint(painter: &Painter, rect: Rect, shows_focus: bool, overlay: OverlayKind) {
    let mut rows = 0;
    if shows_focus && let Some(bar) = bar_rect(painter, rect, rows) {
        paint_focus_bar(painter, bar);
        rows += 1;
    }
    let is_explained =
        matches!(overlay, OverlayKind::PhotographCount | OverlayKind::Depth | OverlayKind::Invented);
    if is_explained && let Some(bar) = bar_rect(painter, rect, rows) {
        paint_overlay_bar(painter, bar, overlay);
    }
}

/// Draws the box of a row, counted from below, and returns the rectangle of its bar. `None` if there is no
/// room.
fn bar_rect(painter: &Painter, rect: Rect, row: u32) -> Option<Rect> {
    // The box extends 18 points to either side of the bar, and lies 8 points from the corner.
    let width = (rect.width() - 60.0).min(200.0);
    if width < MIN_WIDTH || rect.height() < MIN_HEIGHT {
        return None;
    }
    let corner = rect.right_bottom() - vec2(0.0, ROW * row as f32);
    let bar = Rect::from_min_size(corner - vec2(width + 26.0, 34.0), vec2(width, 8.0));
    let around = bar.expand2(vec2(18.0, 5.0)).with_max_y(bar.bottom() + 20.0);
    painter.rect_filled(around, 3.0, Color32::from_black_alpha(140));
    Some(bar)
}

fn paint_focus_bar(painter: &Painter, bar: Rect) {
    false_colour::paint_bar(painter, bar, 1.0);
    for (px, text) in [(-64.0, "near 64"), (-8.0, "8"), (0.0, "sharp"), (8.0, "8"), (64.0, "64 far")] {
        paint_label(painter, bar, (1.0 + false_colour::position(px) as f32) / 2.0, text);
    }
}

fn paint_overlay_bar(painter: &Painter, bar: Rect, overlay: OverlayKind) {
    match overlay {
        OverlayKind::PhotographCount => {
            let counted = paint_unobserved_swatch(painter, bar, "none");
            false_colour::paint_nearness_bar(painter, counted);
            for (count, text) in [(1, "1"), (3, "3"), (10, "10")] {
                paint_label(painter, counted, share_of_count(count), text);
            }
            paint_label(painter, counted, 1.0, &format!("{MAX_COUNTED}+"));
        }
        OverlayKind::Depth => {
            false_colour::paint_nearness_bar(painter, bar);
            paint_label(painter, bar, 0.05, "far");
            paint_label(painter, bar, 0.95, "near");
        }
        OverlayKind::Invented => {
            paint_unobserved_swatch(painter, bar, "invented");
        }
        OverlayKind::Materials | OverlayKind::Photographs => {}
    }
}

/// Draws the colour of unobserved points at the left of a bar. Returns the rest of the bar.
fn paint_unobserved_swatch(painter: &Painter, bar: Rect, text: &str) -> Rect {
    let [r, g, b] = UNOBSERVED_COLOR;
    let part = bar.with_max_x(bar.left() + 18.0);
    painter.rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    paint_label(painter, part, 0.5, text);
    bar.with_min_x(part.right() + 14.0)
}

/// Draws a label beneath a bar, centred at a share of its width.
fn paint_label(painter: &Painter, bar: Rect, share: f32, text: &str) {
    let at = pos2(bar.left() + bar.width() * share, bar.bottom() + 3.0);
    painter.text(at, Align2::CENTER_TOP, text, FontId::proportional(10.0), Color32::from_gray(220));
}
