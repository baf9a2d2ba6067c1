//! The aperture as seen from one point of the scene: radiance sent, occlusion, and the resulting image in the
//! picture.

use super::aperture_pad::{APERTURE_TIP, aperture_pad};
use crate::window::Action;
use crate::window::widgets::controls::{self, row, rows};
use crate::window::widgets::keys;
use document::SurfaceHit;
use egui::{Color32, Mesh, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2};
use glam::{DVec2, DVec3};
use lens::Aperture;
use session::{ApertureImage, BakedVisibility, CommandId, Session};

/// The grey of a closed aperture.
const CLOSED: u8 = 16;

/// The view's state between frames.
#[derive(Default)]
pub struct ApertureView {
    point: Option<SurfaceHit>,
    image: Option<ApertureImage>,
    /// The inputs from which the image was computed.
    image_key: Option<(DVec3, lens::Camera, lens::FocusOffset, u64)>,
}

impl ApertureView {
    /// Chooses the point to inspect.
    pub fn inspect(&mut self, hit: SurfaceHit) {
        self.point = Some(hit);
    }

    /// Whether a point is chosen.
    pub fn has_point(&self) -> bool {
        self.point.is_some()
    }

    /// The aperture as seen from the chosen point.
    pub fn image(&self) -> Option<&ApertureImage> {
        self.image.as_ref()
    }

    /// Draws the aperture pad and the details of the chosen point.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let Some(document) = session.document() else { return };
        if document.camera.aperture_radius <= 0.0 {
            ui.weak("A pinhole: there is no aperture to see.");
            return;
        }
        if let Some(hit) = self.point {
            let focus = session.focus_at(&hit).unwrap_or(lens::FocusOffset::STANDARD);
            let image_key = (hit.position, document.camera.clone(), focus, session.light_field_count());
            if self.image_key.as_ref() != Some(&image_key) {
                self.image = session.aperture_image(&hit);
                self.image_key = Some(image_key);
            }
        }
        ui.horizontal_top(|ui| {
            let response =
                captioned(ui, "from behind the camera", APERTURE_TIP, Sense::drag(), |ui, rect| match &self
                    .image
                {
                    Some(image) => paint_visible_aperture(ui, rect, image, 1.0),
                    None => paint_open(ui, rect, &document.camera.aperture),
                });
            aperture_pad(ui, &response, session, actions);
            if let Some(image) = &self.image {
                point_details(ui, image);
            }
            ui.vertical(|ui| {
                match (&self.image, self.point) {
                    (Some(_), _) => {}
                    (None, Some(_)) => {
                        note(ui, "The point is behind the camera: no part of the aperture is visible from it.");
                    }
                    (None, None) => {
                        note(ui, "Choose a point of the scene to see which part of the aperture is visible from it.");
                    }
                }
                let choose = if self.point.is_some() { "Another point" } else { "Choose a point" };
                for (id, label) in [(CommandId::Inspect, choose), (CommandId::OrbitAperture, "Look round")] {
                    if ui.button(label).on_hover_text(keys::command_tooltip(ui.ctx(), id)).clicked() {
                        actions.push(id.into());
                    }
                }
            });
        });
    }
}

/// A sentence beside the picture, in lines.
fn note(ui: &mut Ui, sentence: &str) {
    ui.set_max_width(NOTE_WIDTH.min(ui.available_width()));
    ui.add(egui::Label::new(egui::RichText::new(sentence).weak()).wrap());
}

/// Width of a sentence beside the picture, points.
const NOTE_WIDTH: f32 = 220.0;

/// Details of the chosen point: the image in the picture, the stored visibility, and numbers.
fn point_details(ui: &mut Ui, image: &ApertureImage) {
    let tip = "The aperture image of the point in the picture: rotated by 180° for near blur. Hatched \
               where occluded, dark outside the aperture's shape; the brightest radiance is shown \
               as white.";
    let sign = if image.circle_px < 0.0 { -1.0 } else { 1.0 };
    captioned(ui, "as it lands", tip, Sense::hover(), |ui, rect| {
        paint_visible_aperture(ui, rect, image, sign)
    });
    if let Some(sampled) = &image.baked {
        let tip = "What the light field stores, in one colour: the aperture cells visible from the nearest sample. The picture is \
                   summed from these.";
        captioned(ui, "as it is kept", tip, Sense::hover(), |ui, rect| {
            paint_sampled_visibility(ui, rect, sampled)
        });
    }
    rows(ui, "aperture", |ui| {
        let mut line = |label: &str, tip: &str, value: String| {
            row(ui, label, tip, |ui| ui.label(value));
        };
        let visible_percent = format!("{:.0} %", image.visible_share() * 100.0);
        line(
            "Sees",
            "The share of the open aperture that is visible from the point, traced with rays.",
            visible_percent,
        );
        let sampled_text = image.baked.as_ref().map_or("–".into(), |sampled| {
            let cells =
                if sampled.side == 1 { "all".into() } else { format!("{0} × {0} cells", sampled.side) };
            format!("{:.0} % ({cells})", sampled.visible_share() * 100.0)
        });
        line(
            "Light field",
            "The share stored as visible in the light field, and its resolution.",
            sampled_text,
        );
        line("Depth", "Axial depth from the shot camera.", controls::length_text(image.depth));
        let circle = controls::circle_text(image.circle_px);
        line("Lands as", "Its circle of confusion on the full-size picture.", circle);
        let lens::FocusOffset { t, anchor, gloss } = image.focus;
        let gloss = if gloss > 0.0 { format!(", gloss {gloss:.2}") } else { String::new() };
        let focus = format!("t {t:.4}, anchor {anchor:.2}{gloss}");
        line("Painted", "The focus of the point.", focus);
    });
}

/// A square picture as tall as there is room for, with a caption below.
fn captioned(ui: &mut Ui, caption: &str, tip: &str, sense: Sense, paint: impl FnOnce(&Ui, Rect)) -> Response {
    let drawn = ui.vertical(|ui| {
        let line = ui.text_style_height(&egui::TextStyle::Body) + ui.spacing().item_spacing.y;
        let side = (ui.available_height() - line).clamp(60.0, 320.0);
        ui.set_width(side);
        let (rect, response) = ui.allocate_exact_size(vec2(side, side), sense);
        paint(ui, rect);
        ui.vertical_centered(|ui| ui.add(egui::Label::new(egui::RichText::new(caption).weak()).truncate()));
        response.on_hover_text(tip)
    });
    drawn.inner
}

/// Draws the aperture's shape.
fn paint_open(ui: &Ui, rect: Rect, aperture: &Aperture) {
    const SIDE: usize = 64;
    /// Sample points per side of a cell: smooths the outline.
    const POINTS: usize = 4;
    let open = |column: usize, row: usize| {
        let along = |k: usize| (0..POINTS).map(move |j| ((k * POINTS + j) as f64 + 0.5) * 2.0);
        let coordinate = |k: f64| k / (SIDE * POINTS) as f64 - 1.0;
        let points = along(row).flat_map(|y| along(column).map(move |x| (x, y)));
        let light = points.map(|(x, y)| aperture.transmission(DVec2::new(coordinate(x), -coordinate(y))));
        light.sum::<f64>() / (POINTS * POINTS) as f64
    };
    paint_cells(ui, rect, SIDE, 1.0, |column, row| {
        let open = open(column, row);
        (open > 0.0).then(|| Color32::from_gray(CLOSED + (180.0 * open) as u8))
    });
}

/// Draws the visible part of the aperture, rotated by 180° if `sign` is −1.
fn paint_visible_aperture(ui: &Ui, rect: Rect, image: &ApertureImage, sign: f32) {
    let brightest = image.cells.iter().flat_map(|cell| cell.radiance).fold(0.0f32, f32::max);
    let gain = if brightest > 0.0 { 1.0 / brightest } else { 1.0 };
    paint_cells(ui, rect, image.side, sign, |column, row| {
        let cell = &image.cells[row * image.side + column];
        let color = if cell.is_visible {
            let [r, g, b] = cell.radiance.map(|c| encoded(c * gain));
            Color32::from_rgb(r, g, b)
        } else {
            Color32::from_gray(if (column + row) % 4 < 2 { 52 } else { 34 })
        };
        (cell.transmission > 0.0).then(|| color.gamma_multiply(0.35 + 0.65 * cell.transmission))
    });
}

/// Draws `side` × `side` cells where `color` gives one, and a cross through the centre.
fn paint_cells(ui: &Ui, rect: Rect, side: usize, sign: f32, color: impl Fn(usize, usize) -> Option<Color32>) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, Color32::from_gray(CLOSED));
    let cell_side = rect.width() / side as f32;
    let mut mesh = Mesh::default();
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        if let Some(color) = color(column, row) {
            let middle = vec2(column as f32 + 0.5, row as f32 + 0.5) * cell_side - rect.size() / 2.0;
            let place = Rect::from_center_size(rect.center() + middle * sign, vec2(cell_side, cell_side));
            mesh.add_colored_rect(place, color);
        }
    }
    painter.add(Shape::mesh(mesh));
    let middle = Stroke::new(1.0, Color32::from_white_alpha(40));
    painter.line_segment([pos2(rect.left(), rect.center().y), pos2(rect.right(), rect.center().y)], middle);
    painter.line_segment([pos2(rect.center().x, rect.top()), pos2(rect.center().x, rect.bottom())], middle);
}

/// Draws the visible cells of a light-field sample in its colour.
fn paint_sampled_visibility(ui: &Ui, rect: Rect, sampled: &BakedVisibility) {
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, Color32::from_gray(CLOSED));
    let brightest = sampled.radiance.into_iter().fold(0.0f32, f32::max);
    let gain = if brightest > 0.0 { 1.0 / brightest } else { 1.0 };
    let [r, g, b] = sampled.radiance.map(|c| encoded(c * gain));
    let cell_side = rect.width() / sampled.side as f32;
    let mut mesh = Mesh::default();
    for (k, is_visible) in sampled.cells.iter().enumerate() {
        let corner = vec2((k % sampled.side) as f32, (k / sampled.side) as f32) * cell_side;
        let place = Rect::from_min_size(rect.min + corner, vec2(cell_side, cell_side));
        let color = if *is_visible { Color32::from_rgb(r, g, b) } else { Color32::from_gray(34) };
        mesh.add_colored_rect(place.shrink(if sampled.side > 1 { 0.5 } else { 0.0 }), color);
    }
    painter.add(Shape::mesh(mesh));
}

/// sRGB encoding of one channel.
fn encoded(linear: f32) -> u8 {
    egui::ecolor::gamma_u8_from_linear_f32(linear)
}
