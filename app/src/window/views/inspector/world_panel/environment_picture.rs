//! Small pictures of environments: to choose one, and to turn the one that is chosen.

use crate::window::widgets::controls::set_accessible_name;
use egui::{
    Button, Color32, ColorImage, CornerRadius, CursorIcon, Id, Image, Rect, Response, Sense, TextureHandle,
    TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::DVec2;
use scene::{BuiltInEnvironment, EnvironmentMap};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Columns and rows of a picture.
const PICTURE_SIZE: [usize; 2] = [192, 96];
/// Size of a thumbnail, and height of the strip, points.
const THUMBNAIL: Vec2 = vec2(42.0, 21.0);
const STRIP_HEIGHT: f32 = 64.0;

/// A button with the picture of an environment that comes with the program.
pub fn thumbnail_button(ui: &mut Ui, environment: BuiltInEnvironment, is_chosen: bool) -> Response {
    let texture = picture(ui, &environment.map());
    let image = Image::new((texture.id(), THUMBNAIL));
    let name = environment.name();
    let response = ui.add(Button::image(image).selected(is_chosen));
    set_accessible_name(&response, name);
    response.on_hover_text(format!("Use the {name} environment."))
}

/// The picture of an environment from +Z to −Z and round again, as it is turned; a drag turns it.
pub fn turning_strip(ui: &mut Ui, map: &Arc<EnvironmentMap>, rotation: &mut f64) -> Response {
    let size = vec2((ui.available_width() - 4.0).min(3.0 * STRIP_HEIGHT), STRIP_HEIGHT);
    let (rect, mut response) = ui.allocate_exact_size(size, Sense::drag());
    set_accessible_name(&response, "Environment");
    let moved = f64::from(response.drag_delta().x / rect.width());
    if moved != 0.0 {
        *rotation = (*rotation - moved * std::f64::consts::TAU) % std::f64::consts::TAU;
        response.mark_changed();
    }
    let texture = picture(ui, map);
    // Turned counter-clockwise seen from above, what is in the picture moves to the left.
    let start = (*rotation as f32 / TAU).rem_euclid(1.0);
    let seam = rect.left() + rect.width() * (1.0 - start);
    let parts = [
        (rect.with_max_x(seam), Rect::from_min_max(pos2(start, 0.0), pos2(1.0, 1.0))),
        (rect.with_min_x(seam), Rect::from_min_max(pos2(0.0, 0.0), pos2(start, 1.0))),
    ];
    for (part, of_picture) in parts.into_iter().filter(|(part, _)| part.width() > 0.0) {
        ui.painter().image(texture.id(), part, of_picture, Color32::WHITE);
    }
    let stroke = ui.style().interact(&response).bg_stroke;
    ui.painter().rect_stroke(rect, CornerRadius::same(2), stroke, egui::StrokeKind::Inside);
    response.on_hover_cursor(CursorIcon::ResizeHorizontal)
}

/// The texture of an environment's picture, made when it is shown first.
fn picture(ui: &Ui, map: &Arc<EnvironmentMap>) -> TextureHandle {
    let id = Id::unique("environment picture").with(Arc::as_ptr(map) as usize);
    if let Some(texture) = ui.data(|data| data.get_temp::<TextureHandle>(id)) {
        return texture;
    }
    let image = ColorImage::new(PICTURE_SIZE, pixels(map));
    let texture = ui.ctx().load_texture(&map.name, image, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}

/// The pixels of a picture: means of the map's radiance, compressed so that suns leave the sky visible.
fn pixels(map: &EnvironmentMap) -> Vec<Color32> {
    let [columns, rows] = PICTURE_SIZE;
    let size = DVec2::new(columns as f64, rows as f64);
    let scale = DVec2::new(f64::from(map.width), f64::from(map.height)) / size;
    let color = |index: usize| {
        let corner = DVec2::new((index % columns) as f64, (index / columns) as f64);
        let samples = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
        let radiance =
            samples.map(|[x, y]| map.radiance(map.direction_at((corner + DVec2::new(x, y)) * scale)));
        let mean = radiance.into_iter().sum::<glam::Vec3>() / 4.0;
        let [r, g, b] =
            mean.to_array().map(|value| egui::ecolor::gamma_u8_from_linear_f32(value / (1.0 + 0.6 * value)));
        Color32::from_rgb(r, g, b)
    };
    (0..columns * rows).map(color).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_show_sky_above_and_ground_below() {
        let pixels = pixels(&BuiltInEnvironment::Overcast.map());
        let row = |row: usize| -> u32 { (0..192).map(|x| u32::from(pixels[row * 192 + x].g())).sum() };
        assert!(row(8) > row(30) && row(30) > row(80), "{} {} {}", row(8), row(30), row(80));
    }
}
