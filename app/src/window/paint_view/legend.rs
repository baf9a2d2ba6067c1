//! What the colours of the paint view mean, in its lower right corner.

use super::coat::{Coating, MANY, UNSEEN, share_of_count};
use crate::window::false_colour;
use egui::{Align2, Color32, FontId, Painter, Rect, pos2, vec2};

/// In a view smaller than this there is no room for it, points.
const LEAST_WIDTH: f32 = 120.0;
const LEAST_HEIGHT: f32 = 120.0;
/// Height of a bar with its labels, points.
const ROW: f32 = 40.0;

/// The focus's colours, if they are shown, and above them those of the coat.
pub fn paint(painter: &Painter, rect: Rect, shows_focus: bool, coating: Coating) {
    let mut rows = 0;
    if shows_focus && let Some(bar) = bar(painter, rect, rows) {
        focus(painter, bar);
        rows += 1;
    }
    let is_explained = matches!(coating, Coating::Seeing | Coating::Depth | Coating::Invented);
    if is_explained && let Some(bar) = bar(painter, rect, rows) {
        coat(painter, bar, coating);
    }
}

/// Where the bar of a row lies, the rows counted from below; its box is drawn. None where there is no room.
fn bar(painter: &Painter, rect: Rect, row: u32) -> Option<Rect> {
    // Its box reaches 18 points further on either side, and stands 8 from the corner.
    let width = (rect.width() - 60.0).min(200.0);
    if width < LEAST_WIDTH || rect.height() < LEAST_HEIGHT {
        return None;
    }
    let corner = rect.right_bottom() - vec2(0.0, ROW * row as f32);
    let bar = Rect::from_min_size(corner - vec2(width + 26.0, 34.0), vec2(width, 8.0));
    let around = bar.expand2(vec2(18.0, 5.0)).with_max_y(bar.bottom() + 20.0);
    painter.rect_filled(around, 3.0, Color32::from_black_alpha(140));
    Some(bar)
}

fn focus(painter: &Painter, bar: Rect) {
    false_colour::paint_bar(painter, bar, 1.0);
    for (px, text) in [(-64.0, "near 64"), (-8.0, "8"), (0.0, "sharp"), (8.0, "8"), (64.0, "64 far")] {
        label(painter, bar, (1.0 + false_colour::position(px) as f32) / 2.0, text);
    }
}

fn coat(painter: &Painter, bar: Rect, coating: Coating) {
    match coating {
        Coating::Seeing => {
            let counted = unseen(painter, bar, "none");
            false_colour::paint_nearness_bar(painter, counted);
            for (count, text) in [(1, "1"), (3, "3"), (10, "10")] {
                label(painter, counted, share_of_count(count), text);
            }
            label(painter, counted, 1.0, &format!("{MANY}+"));
        }
        Coating::Depth => {
            false_colour::paint_nearness_bar(painter, bar);
            label(painter, bar, 0.05, "far");
            label(painter, bar, 0.95, "near");
        }
        Coating::Invented => {
            unseen(painter, bar, "invented");
        }
        Coating::Materials | Coating::Photographs => {}
    }
}

/// Draws the colour of what is not seen at the left of a bar. The rest of the bar.
fn unseen(painter: &Painter, bar: Rect, text: &str) -> Rect {
    let [r, g, b] = UNSEEN;
    let part = bar.with_max_x(bar.left() + 18.0);
    painter.rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    label(painter, part, 0.5, text);
    bar.with_min_x(part.right() + 14.0)
}

/// Writes beneath a bar, in the middle at a share of its width.
fn label(painter: &Painter, bar: Rect, share: f32, text: &str) {
    let at = pos2(bar.left() + bar.width() * share, bar.bottom() + 3.0);
    painter.text(at, Align2::CENTER_TOP, text, FontId::proportional(10.0), Color32::from_gray(220));
}
