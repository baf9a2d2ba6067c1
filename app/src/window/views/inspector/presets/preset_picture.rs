//! What a preset does, as a small picture: of a brush its dab, of an aperture's shape a light far out of focus, of a lens such a light
//! towards a corner of the picture, as large as its f-number makes it.

use egui::{Color32, Mesh, Rect, Ui, vec2};
use focus::Brush;
use glam::DVec2;
use lens::{Aperture, Camera};
use project::{Preset, PresetContent};

/// Cells along a side of a picture.
const CELLS: usize = 26;
/// Parts of a cell along its side, whose mean it shows.
const PARTS: usize = 3;

/// What the shape of a light out of focus looks like.
const LIGHT: Color32 = Color32::from_rgb(236, 220, 176);

/// The f-number whose light fills the picture; the diameter of others falls with the square root, so that small ones can still be seen.
const WIDEST_F_NUMBER: f64 = 1.0;
/// The least diameter, as a share of the picture's.
const LEAST_DIAMETER: f64 = 0.2;
/// Where in the picture the light of a lens is, half-heights from the axis.
const TOWARDS_CORNER: DVec2 = DVec2::new(1.2, 0.7);

/// The picture of a preset in `rect`, for the current camera.
pub fn preset_picture(preset: &Preset, camera: &Camera, ui: &Ui, rect: Rect) -> Mesh {
    match &preset.content {
        PresetContent::Brush(brush) => dab(brush, ui.visuals().text_color(), rect),
        PresetContent::Bokeh(aperture) => bokeh_picture(aperture, rect),
        PresetContent::Lens(_) => match preset.apply_to_camera(camera) {
            Some(Ok(camera)) => light_through_lens(&camera, rect),
            _ => Mesh::default(),
        },
    }
}

/// What of each cell of the aperture is open.
pub fn bokeh_picture(aperture: &Aperture, rect: Rect) -> Mesh {
    cells(rect, LIGHT, |place| aperture.transmission(place))
}

/// The strength of a dab over its disc.
fn dab(brush: &Brush, color: Color32, rect: Rect) -> Mesh {
    cells(rect, color, |place| brush.strength * brush.falloff(place.length()))
}

/// A light in front of the focus, towards the upper right corner, as the lens cuts and weights it.
fn light_through_lens(camera: &Camera, rect: Rect) -> Mesh {
    let (lens, radius) = (camera.character_optics(), camera.aperture_radius);
    let diameter = (WIDEST_F_NUMBER / camera.f_number()).sqrt().clamp(LEAST_DIAMETER, 1.0);
    let inverse_depth = 2.0 * lens.at(TOWARDS_CORNER).inverse_focus_distance;
    let kappa = inverse_depth - lens.at(TOWARDS_CORNER).inverse_focus_distance;
    cells(rect, LIGHT, |place| {
        let place = place / diameter;
        let u = radius * place;
        let passes = place.length() <= 1.0 && lens.passes(TOWARDS_CORNER, inverse_depth, u);
        if passes { 0.7 * camera.aperture.transmission(place) * lens.edges.weight(u, kappa) } else { 0.0 }
    })
}

/// Cells that are as opaque as `opacity` says, in [0, 1], at their place in [−1, 1]², y up.
fn cells(rect: Rect, color: Color32, opacity: impl Fn(DVec2) -> f64) -> Mesh {
    let mut mesh = Mesh::default();
    let cell = rect.size() / CELLS as f32;
    for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
        let at = |cell: usize, part: usize| {
            let place = cell as f64 + (part as f64 + 0.5) / PARTS as f64;
            2.0 * place / CELLS as f64 - 1.0
        };
        let parts = (0..PARTS * PARTS).map(|k| DVec2::new(at(column, k % PARTS), -at(row, k / PARTS)));
        let opacity = parts.map(|place| opacity(place).clamp(0.0, 1.0)).sum::<f64>() / (PARTS * PARTS) as f64;
        if opacity > 0.0 {
            let corner = rect.min + vec2(column as f32, row as f32) * cell;
            mesh.add_colored_rect(Rect::from_min_size(corner, cell), color.gamma_multiply(opacity as f32));
        }
    }
    mesh
}
