//! The wipe: a line across the picture with another picture on its left.

use super::displayed_picture::DisplayedPicture;
use crate::window::widgets::controls;
use egui::{Align2, Color32, CursorIcon, FontId, Key, Rect, Sense, Stroke, Ui, pos2, vec2};

/// Distance within which the line can be grabbed, points.
const REACH: f32 = 6.0;
/// Step of an arrow key, as a share of the picture's width.
const KEY_STEP: f32 = 0.02;

/// The wipe line and the compared picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wipe {
    /// Whether the wipe is on.
    pub is_on: bool,
    /// The picture on the left of the line.
    pub against: DisplayedPicture,
    /// Position of the line: the share of the picture on its left, in [0, 1].
    pub at: f32,
}

impl Default for Wipe {
    fn default() -> Self {
        Self { is_on: false, against: DisplayedPicture::Standard, at: 0.5 }
    }
}

impl Wipe {
    /// The part of the screen rectangle `image` that shows the compared picture.
    pub fn left_of(&self, image: Rect) -> Rect {
        image.with_max_x(self.line_x(image))
    }

    fn line_x(&self, image: Rect) -> f32 {
        image.left() + image.width() * self.at
    }

    /// Moves the line by pointer and arrow keys and draws it with the names of both sides; `view` clips it.
    /// Returns whether the line has the pointer.
    pub fn handle(&mut self, ui: &mut Ui, image: Rect, view: Rect, right: DisplayedPicture) -> bool {
        let visible = image.intersect(view);
        if !visible.is_positive() {
            return false;
        }
        let line =
            |x: f32| Rect::from_center_size(pos2(x, visible.center().y), vec2(2.0 * REACH, visible.height()));
        let id = ui.scope_id().with("wipe");
        let mut response = ui.interact(line(self.line_x(image)), id, Sense::drag());
        controls::set_accessible_name(&response, "Wipe line");
        let before = self.at;
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            self.at = ((pointer.x - image.left()) / image.width()).clamp(0.0, 1.0);
            response.request_focus();
        }
        if response.has_focus() {
            let arrows = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
            let pressed = |key| ui.input(|input| input.num_presses(key)) as f32;
            let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
            self.at = (self.at + steps * KEY_STEP).clamp(0.0, 1.0);
        }
        if self.at != before {
            response.mark_changed();
        }
        let active = response.hovered() || response.dragged();
        if active {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        self.paint(ui, image, visible, right, active || response.has_focus());
        response.on_hover_text("Drag to compare; arrow keys move it too.");
        active
    }

    fn paint(&self, ui: &Ui, image: Rect, visible: Rect, right: DisplayedPicture, strong: bool) {
        let painter = ui.painter_at(visible);
        let x = self.line_x(image);
        let ends = [pos2(x, visible.top()), pos2(x, visible.bottom())];
        painter.line_segment(ends, Stroke::new(3.0, Color32::from_black_alpha(140)));
        painter.line_segment(ends, Stroke::new(1.0, Color32::WHITE));
        let radius = if strong { 7.0 } else { 5.0 };
        painter.circle(
            pos2(x, visible.center().y),
            radius,
            Color32::WHITE,
            Stroke::new(1.0, Color32::from_gray(20)),
        );
        let label = |at: egui::Pos2, align: Align2, text: &str| {
            let galley =
                painter.layout_no_wrap(text.into(), FontId::proportional(12.0), Color32::from_gray(235));
            let rect = align.anchor_size(at, galley.size());
            painter.rect_filled(rect.expand2(vec2(5.0, 2.0)), 3.0, Color32::from_black_alpha(150));
            painter.galley(rect.min, galley, Color32::WHITE);
        };
        let y = visible.top() + 8.0;
        label(pos2(x - 12.0, y), Align2::RIGHT_TOP, self.against.name());
        label(pos2(x + 12.0, y), Align2::LEFT_TOP, right.name());
    }
}
