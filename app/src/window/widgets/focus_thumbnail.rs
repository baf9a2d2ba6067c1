//! A small picture of a part of the focus map, in the false colours of blur.

use crate::window::widgets::brush_controls::signed_circle_px;
use crate::window::widgets::false_colour;
use egui::{Color32, Mesh, Rect, Shape, Ui, vec2};
use focus::EditThumbnail;
use lens::Optics;

/// Draws the cells of a thumbnail in the false colours of their blur, the more opaque the more of a cell there is.
pub fn focus_thumbnail(ui: &Ui, rect: Rect, thumbnail: &EditThumbnail, optics: &Optics) {
    ui.painter().rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let side = rect.width() / EditThumbnail::SIDE as f32;
    let mut mesh = Mesh::default();
    for (k, cell) in thumbnail.cells().iter().enumerate().filter(|(_, cell)| cell.changed > 0.0) {
        let corner = vec2((k % EditThumbnail::SIDE) as f32, (k / EditThumbnail::SIDE) as f32) * side;
        let color = false_colour::color(signed_circle_px(optics, f64::from(cell.t)));
        let [r, g, b, _] = color.to_array();
        let alpha = (100.0 + 155.0 * cell.changed) as u8;
        let place = Rect::from_min_size(rect.min + corner, vec2(side, side));
        mesh.add_colored_rect(place, Color32::from_rgba_unmultiplied(r, g, b, alpha));
    }
    ui.painter().add(Shape::mesh(mesh));
}
