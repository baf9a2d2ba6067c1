//! The focus that is painted: as blur, and as raw numbers.

use crate::window::Action;
use crate::window::widgets::brush_controls::{push_brush_change, signed_circle_px, target_slider};
use crate::window::widgets::controls::{self, explained_row, format_number, proportional_value, row, rows};
use crate::window::widgets::ray_diagram::{ANCHORS, OFFSETS, explanation};
use document::Document;
use egui::{Button, Checkbox, DragValue, RichText, Ui};
use lens::FocusOffset;
use session::{Command, CommandId};

/// The brush's focus, its anchor and gloss, and buttons to fill with it.
pub fn focus_panel(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let mut brush = document.brush.clone();
    let optics = document.camera.optics();
    let px = signed_circle_px(&optics, brush.target.t);
    ui.horizontal(|ui| {
        ui.label(RichText::new("near").weak());
        let width = (ui.available_width() - 40.0).clamp(80.0, 260.0);
        if let Some(target) = target_slider(ui, &optics, brush.target, width) {
            brush.target = target;
        }
        ui.label(RichText::new("far").weak());
    });
    rows(ui, "focus", |ui| {
        let mut shown = px;
        let tip = "Diameter of the circle of confusion in the full-size picture: negative is near blur, \
                   positive far blur.";
        let response = row(ui, "Blur", tip, |ui| {
            let value = DragValue::new(&mut shown).speed(0.1).max_decimals(2).suffix(" px");
            ui.add_enabled(optics.aperture_radius > 0.0, value)
        });
        if response.changed()
            && let Some(kappa) = optics.kappa_for_circle_px(shown)
            && let Some(t) = optics.offset_for_kappa(kappa, optics.inverse_focus_distance, 1.0)
        {
            brush.target.t = t;
        }
        if optics.aperture_radius > 0.0 {
            exact_rows(ui, document, &mut brush.target);
        }
        let tip = "The raw focus offset: the distance that rays travel behind the lens, relative to the \
                   anchor's. 1 is no offset.";
        let explain = |ui: &mut Ui| explanation(ui, tip, &OFFSETS);
        explained_row(ui, "t", explain, |ui| {
            ui.add(DragValue::new(&mut brush.target.t).speed(0.0005).fixed_decimals(4))
        });
        let tip = "What the blur is relative to. Lens: it still varies with depth and focus distance. Point: \
                   this blur, wherever the camera focuses. Key: A.";
        let explain = |ui: &mut Ui| explanation(ui, tip, &ANCHORS);
        explained_row(ui, "Anchor", explain, |ui| {
            controls::beside(ui, |ui| {
                for (anchor, label) in [(0.0, "Lens"), (1.0, "Point")] {
                    if ui
                        .add(Button::selectable(brush.target.anchor == anchor, label))
                        .on_hover_ui(explain)
                        .clicked()
                    {
                        brush.target.anchor = anchor;
                    }
                }
                let mix = ui.add(
                    DragValue::new(&mut brush.target.anchor).range(0.0..=1.0).speed(0.005).fixed_decimals(2),
                );
                controls::set_accessible_name(&mix, "Anchor mix");
                mix
            })
            .inner
        });
        row(ui, "Gloss", CommandId::ToggleGloss.info().tooltip, |ui| {
            let gloss = &mut brush.target.gloss;
            let mut obeys = *gloss >= 1.0;
            let in_part = *gloss > 0.0 && !obeys;
            let response = ui.add(Checkbox::new(&mut obeys, "obeys the paint").indeterminate(in_part));
            if response.clicked() {
                *gloss = if obeys { 1.0 } else { 0.0 };
            }
            response
        });
    });
    ui.add(egui::Label::new(RichText::new(target_sentence(brush.target, px)).weak()).wrap());
    ui.horizontal_wrapped(|ui| {
        fill_button(ui, CommandId::FillAll, "Fill everything", actions);
        let tip = "Set the chosen focus for the background, behind all surfaces.";
        if ui.button("Fill background").on_hover_text(tip).clicked() {
            actions.push(Command::SetBackgroundFocus(brush.target).into());
        }
        fill_button(ui, CommandId::ResetMap, "Reset all", actions);
    });
    push_brush_change(document, brush, actions);
}

/// The same blur in other units.
fn exact_rows(ui: &mut Ui, document: &Document, target: &mut FocusOffset) {
    let optics = document.camera.optics();
    let per_px = optics.circle_of_confusion(1.0) / optics.circle_of_confusion_px(1.0);
    let height = document.camera.height as f64;
    let px = signed_circle_px(&optics, target.t);
    let set = |target: &mut FocusOffset, px: f64| {
        let kappa = optics.kappa_for_circle_px(px);
        if let Some(t) = kappa.and_then(|k| optics.offset_for_kappa(k, optics.inverse_focus_distance, 1.0)) {
            target.t = t;
        }
    };
    let mut mm = px * per_px * 1e3;
    let tip = "The same diameter on the sensor, in mm if the scene is in metres.";
    let response = row(ui, "on the sensor", tip, |ui| {
        ui.add(DragValue::new(&mut mm).speed(0.002).max_decimals(4).suffix(" mm"))
    });
    if response.changed() {
        set(target, mm / 1e3 / per_px);
    }
    let mut percent = px / height * 100.0;
    let tip = "The same diameter as a share of the picture's height.";
    let response = row(ui, "of the height", tip, |ui| {
        ui.add(DragValue::new(&mut percent).speed(0.01).max_decimals(3).suffix(" %"))
    });
    if response.changed() {
        set(target, percent / 100.0 * height);
    }
    // κ = 1/s − 1/z: the defocus of the unpainted lens at depth z.
    let kappa = optics.kappa(optics.inverse_focus_distance, FocusOffset::new(target.t, 1.0));
    let inverse = optics.inverse_focus_distance - kappa;
    let mut depth = if inverse > 0.0 { 1.0 / inverse } else { f64::INFINITY };
    let tip = "The depth at which the unpainted lens would give the same blur. Stronger far blur than at \
               infinity corresponds to no depth.";
    let response = row(ui, "looks like at", tip, |ui| {
        let beyond = inverse < 0.0;
        let value =
            proportional_value(&mut depth, 1e-6..=f64::INFINITY).custom_formatter(move |n, d| match n {
                _ if beyond => "beyond ∞".into(),
                n if n.is_finite() => format!("{} m", format_number(n, d)),
                _ => "∞".into(),
            });
        ui.add(value.custom_parser(|text| match text.trim().trim_end_matches('m').trim() {
            "inf" | "∞" | "infinity" => Some(f64::INFINITY),
            number => number.parse().ok(),
        }))
    });
    if response.changed() && depth > 0.0 {
        let kappa = optics.inverse_focus_distance - 1.0 / depth;
        if let Some(t) = optics.offset_for_kappa(kappa, optics.inverse_focus_distance, 1.0) {
            target.t = t;
        }
    }
}

fn fill_button(ui: &mut Ui, id: CommandId, label: &str, actions: &mut Vec<Action>) {
    if ui.button(label).on_hover_text(id.info().tooltip).clicked() {
        actions.push(id.into());
    }
}

/// A sentence that describes the focus.
fn target_sentence(target: FocusOffset, px: f64) -> String {
    let blur = controls::circle_amount_text(px);
    let painted = match target.anchor {
        _ if target.is_standard() => return "Paints the ordinary lens.".into(),
        1.0 if target.t == 1.0 => "Paints perfectly sharp, wherever the lens focuses".into(),
        1.0 => format!("Paints {blur}, wherever the lens focuses"),
        0.0 => format!("Paints {blur} on top of the lens's own"),
        anchor => format!("Paints {blur} and {:.0} % of the lens's own", (1.0 - anchor) * 100.0),
    };
    let gloss = if target.gloss > 0.0 { "; what is mirrored there, too" } else { "" };
    format!("{painted}{gloss}.")
}
