//! Gaussian splats: where they stand, and which of them are hidden.

use crate::window::Action;
use crate::window::widgets::controls::{beside, format_number, proportional_value, row, rows};
use document::Document;
use egui::{DragValue, Response, Ui};
use glam::{DQuat, DVec3, EulerRot};
use scene::{PlacedCloud, SplatCleanup, SplatEdit, SplatTransform};
use session::Command;

/// What is being edited, until it is shown.
#[derive(Default)]
pub struct SplatsRows {
    /// The edit that is shown, and the one that is being made of it.
    draft: Option<(SplatEdit, SplatEdit)>,
}

impl SplatsRows {
    /// Draws the settings of the scene's splats, if it has any. A change is made when its control is released.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let Some(splats) = &document.scene().splats else { return };
        let (shown, mut edit) = match self.draft.take() {
            Some((shown, edit)) if shown == splats.edit => (shown, edit),
            _ => (splats.edit.clone(), splats.edit.clone()),
        };
        let mut released = None;
        let mut note = |response: Response, name: &'static str| {
            if response.drag_stopped() || response.lost_focus() || response.clicked() {
                released = Some(name);
            }
        };
        ui.label(format!("{} splats, {} hidden", splats.cloud.len(), splats.cloud.hidden_count()));
        rows(ui, "splats", |ui| {
            transform_rows(ui, &mut edit.transform, &mut note);
            crop_rows(ui, splats, &mut edit, &mut note);
            cleanup_rows(ui, &mut edit.cleanup, &mut note);
        });
        if let Some(name) = released.filter(|_| edit != shown && edit.is_valid()) {
            actions.push(Command::EditSplats(name, edit.clone().into()).into());
        }
        self.draft = Some((shown, edit));
    }
}

type Note<'a> = dyn FnMut(Response, &'static str) + 'a;

fn transform_rows(ui: &mut Ui, transform: &mut SplatTransform, note: &mut Note<'_>) {
    let tip = "Moves the splats, from where their file puts them.";
    note(row(ui, "Position", tip, |ui| vector(ui, &mut transform.translation)), "Move splats");
    let (x, y, z) = transform.rotation.to_euler(EulerRot::XYZ);
    // Of the angles of no turn some are −0.
    let mut degrees = DVec3::new(x, y, z).map(f64::to_degrees) + DVec3::ZERO;
    let before = degrees;
    let tip = "Turns the splats about the axes x, y and z, degrees.";
    note(row(ui, "Turn", tip, |ui| vector(ui, &mut degrees)), "Turn splats");
    if degrees != before {
        let [x, y, z] = degrees.to_array().map(f64::to_radians);
        transform.rotation = DQuat::from_euler(EulerRot::XYZ, x, y, z).normalize();
    }
    let tip = "Makes all splats larger or smaller, so that lengths are those of the scene.";
    let scale = |ui: &mut Ui| ui.add(proportional_value(&mut transform.scale, 1e-6..=1e6));
    note(row(ui, "Scale", tip, scale), "Scale splats");
}

fn crop_rows(ui: &mut Ui, splats: &PlacedCloud, edit: &mut SplatEdit, note: &mut Note<'_>) {
    let mut is_cropped = edit.crop.is_some();
    let tip = "Hides what lies outside of a box.";
    let response = row(ui, "Crop", tip, |ui| ui.checkbox(&mut is_cropped, ""));
    if response.changed() {
        edit.crop = is_cropped.then(|| splats.bounds());
    }
    note(response, "Crop splats");
    if let Some((low, high)) = &mut edit.crop {
        let lower =
            row(ui, "Lower corner", "The corner of the box with the least x, y and z.", |ui| vector(ui, low));
        let upper = row(ui, "Upper corner", "The opposite corner of the box.", |ui| vector(ui, high));
        *high = high.max(*low);
        note(lower, "Crop splats");
        note(upper, "Crop splats");
    }
}

fn cleanup_rows(ui: &mut Ui, cleanup: &mut SplatCleanup, note: &mut Note<'_>) {
    let tip = "Hides splats that are fainter than this opacity.";
    let opacity = |ui: &mut Ui| {
        ui.add(DragValue::new(&mut cleanup.min_opacity).speed(0.005).range(0.0..=1.0).max_decimals(3))
    };
    note(row(ui, "Hide fainter", tip, opacity), "Hide faint splats");
    let tip = "Hides splats that are longer than this (one standard deviation). 0 hides none.";
    note(row(ui, "Hide larger", tip, |ui| limit(ui, &mut cleanup.max_size)), "Hide large splats");
    let tip = "Hides floaters: splats with fewer than eight others within this distance. 0 hides none.";
    note(row(ui, "Hide alone", tip, |ui| limit(ui, &mut cleanup.max_distance)), "Hide floaters");
}

/// A length, or 0 for no limit.
fn limit(ui: &mut Ui, limit: &mut Option<f64>) -> Response {
    let mut length = limit.unwrap_or(0.0);
    // From 0, too, a drag leads somewhere.
    let speed = (0.01 * length).max(1e-3);
    let value = DragValue::new(&mut length).speed(speed).range(0.0..=1e9);
    let response = ui.add(value.custom_formatter(format_number));
    if response.changed() {
        *limit = (length > 0.0).then_some(length);
    }
    response
}

/// Three numbers beside each other.
fn vector(ui: &mut Ui, value: &mut DVec3) -> Response {
    let edited = beside(ui, |ui| {
        let axes = [(&mut value.x, "x"), (&mut value.y, "y"), (&mut value.z, "z")];
        let fields = axes.map(|(number, axis)| {
            let field = DragValue::new(number).speed(0.01).range(-1e9..=1e9).max_decimals(4);
            ui.add(field).on_hover_text(axis)
        });
        let [x, y, z] = fields;
        x | y | z
    });
    edited.inner
}
