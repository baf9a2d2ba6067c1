//! What the lens does beside focusing.

use crate::window::Action;
use crate::window::widgets::controls::{self, finish_edit, format_number, proportional_value, row, rows};
use document::CameraEdit;
use egui::{DragValue, Response, Slider, Ui};
use lens::{Camera, Character, Rim};
use session::Command;

/// The rims, as they are called: in front of the aperture, and behind it.
const RIMS: [(&str, f64); 2] = [("Front rim", 1.0), ("Rear rim", -1.0)];

/// Edges, cat's eye, colours, field curvature and falloff of the lens.
pub fn character_panel(ui: &mut Ui, camera: &Camera, actions: &mut Vec<Action>) {
    rows(ui, "character", |ui| character_rows(ui, camera, actions));
}

fn character_rows(ui: &mut Ui, camera: &Camera, actions: &mut Vec<Action>) {
    let mut character = camera.character;
    let mut responses = Vec::new();
    let tip = "Bright rims of discs far behind the focus, and soft ones of near discs, or the other way round. 0 is an even disc.";
    responses.push(row(ui, "Disc edges", tip, |ui| {
        controls::slider(ui, Slider::new(&mut character.edges, -1.0..=1.0).max_decimals(2))
    }));
    for (rim, (label, side)) in character.rims.iter_mut().zip(RIMS) {
        responses.push(rim_row(ui, label, side, rim, camera.aperture_radius));
    }
    let tip = "How much farther behind the lens red and blue focus than green, in mm if the scene is in metres: coloured rims \
               before and behind the focus.";
    let colours = &mut character.longitudinal_colour;
    responses.push(colour_row(
        ui,
        "Depth fringe",
        tip,
        colours,
        1e3,
        " mm",
        camera.optics().image_distance / 2.0,
    ));
    let tip = "How much larger the pictures of red and blue are than green's, in pixels at the middle of the picture's upper edge: \
               coloured outlines toward the corners.";
    let half_height_px = f64::from(camera.height) / 2.0;
    let colours = &mut character.lateral_colour;
    responses.push(colour_row(
        ui,
        "Side fringe",
        tip,
        colours,
        half_height_px,
        " px",
        Character::LARGEST_LATERAL,
    ));
    let tip = "How the plane of focus bends toward the corners, in dioptres at the middle of the picture's upper edge; above 0 it \
               comes nearer.";
    responses.push(row(ui, "Field curvature", tip, |ui| {
        ui.add(DragValue::new(&mut character.field_curvature).speed(1e-3).max_decimals(4))
    }));
    let tip = "The picture darkens with the fourth power of the cosine of the angle to the axis.";
    responses.push(row(ui, "cos⁴ falloff", tip, |ui| ui.checkbox(&mut character.has_cos4_falloff, "")));
    if character != camera.character {
        // What is wide open now stays so when the lens is stopped down.
        let widest =
            character.widest_radius.or((camera.aperture_radius > 0.0).then_some(camera.aperture_radius));
        let character = Character { widest_radius: widest, ..character };
        actions.push(Command::EditCamera(CameraEdit::Character(character)).into());
    }
    responses.iter().for_each(|response| finish_edit(response, actions));
}

/// A rim: whether there is one, its radius and its distance.
fn rim_row(ui: &mut Ui, label: &str, side: f64, rim: &mut Option<Rim>, aperture_radius: f64) -> Response {
    let tip = format!(
        "{label} of the lens barrel, {} the aperture: it cuts the discs beside the axis to cat's eyes. Radius and distance \
         from the aperture, in mm if the scene is in metres.",
        if side > 0.0 { "in front of" } else { "behind" }
    );
    row(ui, label, &tip, |ui| {
        controls::beside(ui, |ui| {
            let mut is_there = rim.is_some();
            let mut response = ui.checkbox(&mut is_there, "");
            if is_there != rim.is_some() {
                let radius = if aperture_radius > 0.0 { 1.2 * aperture_radius } else { 0.01 };
                *rim = is_there.then_some(Rim { radius, distance: side * 3.0 * radius });
            }
            if let Some(Rim { radius, distance }) = rim {
                for (length, range) in [(radius, 1e-6..=1e6), (distance, -1e6..=1e6)] {
                    let mut shown = *length * 1e3;
                    let value =
                        proportional_value(&mut shown, range).suffix(" mm").custom_formatter(format_number);
                    let changed = ui.add(value);
                    if changed.changed() {
                        *length = shown / 1e3;
                    }
                    response = response.union(changed);
                }
            }
            response
        })
        .inner
    })
}

/// Red and blue, shown as `unit` times what they are.
fn colour_row(
    ui: &mut Ui,
    label: &str,
    tip: &str,
    colours: &mut [f64; 2],
    unit: f64,
    suffix: &str,
    largest: f64,
) -> Response {
    row(ui, label, tip, |ui| {
        controls::beside(ui, |ui| {
            let mut add = |colour: &mut f64, prefix: &str| {
                let mut shown = *colour * unit;
                let range = -largest * unit..=largest * unit;
                let value =
                    DragValue::new(&mut shown).speed(largest * unit * 1e-3).range(range).prefix(prefix);
                let response = ui.add(value.suffix(suffix).max_decimals(3));
                if response.changed() {
                    *colour = shown / unit;
                }
                response
            };
            let [red, blue] = colours;
            add(red, "R ").union(add(blue, "B "))
        })
        .inner
    })
}
