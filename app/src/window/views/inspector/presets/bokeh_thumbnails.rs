//! The aperture shapes of the presets as small pictures, to be chosen by a click.

use super::preset_picture::bokeh_picture;
use crate::window::Action;
use crate::window::action::PresetAction;
use crate::window::widgets::controls::set_accessible_name;
use egui::{Response, Sense, Ui, Vec2, vec2};
use lens::{Aperture, Camera};
use project::{Preset, PresetContent, PresetKind, PresetLibrary};

/// Side of a picture, points.
const SIDE: f32 = 32.0;

/// The pictures of all shapes; the one that `camera` has is framed.
pub fn bokeh_thumbnails(ui: &mut Ui, presets: &PresetLibrary, camera: &Camera, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        for entry in presets.entries_of_kind(PresetKind::Bokeh) {
            let Ok(preset) = &entry.preset else { continue };
            let PresetContent::Bokeh(aperture) = &preset.content else { continue };
            if thumbnail(ui, preset, aperture, preset.matches_camera(camera)).clicked() {
                actions.push(PresetAction::Use(Box::new(preset.clone())).into());
            }
        }
    });
}

fn thumbnail(ui: &mut Ui, preset: &Preset, aperture: &Aperture, is_chosen: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click());
    set_accessible_name(&response, &format!("Bokeh: {}", preset.name));
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact_selectable(&response, is_chosen);
        let fill = if is_chosen { visuals.weak_bg_fill } else { ui.visuals().extreme_bg_color };
        ui.painter().rect(rect, 3.0, fill, visuals.bg_stroke, egui::StrokeKind::Inside);
        ui.painter().add(egui::Shape::mesh(bokeh_picture(aperture, rect.shrink(5.0))));
    }
    response.on_hover_text(format!("{}: the shape of lights out of focus.", preset.name))
}
