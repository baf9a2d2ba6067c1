//! Settings of the brush.

use super::falloff_editor::{falloff_choice, falloff_editor};
use super::presets::preset_row;
use crate::window::widgets::brush_controls::{
    HARDNESS_TIP, SIZE_TIP, STRENGTH_TIP, largest_radius, push_brush_change,
};
use crate::window::widgets::controls::{self, format_number, proportional_value, row, rows};
use crate::window::{Action, ViewSettings};
use document::{Document, SurfaceHit};
use egui::{ComboBox, DragValue, Slider, Ui};
use focus::{Brush, BrushMode, Channels};
use project::{PresetKind, PresetLibrary};

/// Size, strength, hardness, spacing, mode and limits.
pub fn brush_panel(
    ui: &mut Ui,
    document: &Document,
    settings: &mut ViewSettings,
    presets: &PresetLibrary,
    hover: Option<SurfaceHit>,
    actions: &mut Vec<Action>,
) {
    let mut brush = document.brush.clone();
    rows(ui, "brush", |ui| {
        let current = &document.brush;
        let camera = &document.camera;
        preset_row(ui, presets, camera, PresetKind::Brush, |preset| preset.matches_brush(current), actions);
        row(ui, "Size", SIZE_TIP, |ui| {
            controls::beside(ui, |ui| {
                let largest = largest_radius(document);
                let value = proportional_value(&mut brush.radius, largest * 1e-4..=largest)
                    .custom_formatter(format_number);
                let response = ui.add(value.suffix(" m"));
                ui.weak(format!(
                    "{} px",
                    controls::significant_digits(radius_px(document, hover, brush.radius))
                ))
                .on_hover_text(
                    "The same in picture pixels, at the depth under the pointer or at the focus distance.",
                );
                response
            })
            .inner
        });
        row(ui, "Strength", STRENGTH_TIP, |ui| {
            controls::slider(ui, Slider::new(&mut brush.strength, 0.0..=1.0).max_decimals(2))
        });
        let tip =
            "The share of the strength applied by one dab: below 1 a stroke builds up where dabs overlap.";
        row(ui, "Flow", tip, |ui| {
            controls::slider(ui, Slider::new(&mut brush.flow, 0.01..=1.0).max_decimals(2))
        });
        row(ui, "Hardness", HARDNESS_TIP, |ui| {
            let drawn = brush.drawn_falloff.is_some();
            let slider = Slider::new(&mut brush.hardness, 0.0..=1.0).max_decimals(2);
            ui.add_enabled_ui(!drawn, |ui| controls::slider(ui, slider)).inner
        });
        let tip = "How the strength falls off from the centre to the rim: by hardness, or as drawn.";
        row(ui, "Falloff", tip, |ui| falloff_choice(ui, &mut brush));
        let tip = "Distance between dabs as a share of the radius.";
        row(ui, "Spacing", tip, |ui| {
            ui.add(DragValue::new(&mut brush.spacing).range(0.01..=10.0).speed(0.005).max_decimals(2))
        });
        let tip =
            "Set moves the focus toward the chosen one. Add and Subtract offset the existing focus by it.";
        row(ui, "Mode", tip, |ui| {
            let modes = [(BrushMode::Set, "Set"), (BrushMode::Add, "Add"), (BrushMode::Subtract, "Subtract")];
            let name =
                modes.iter().find(|(mode, _)| *mode == brush.mode).map_or("by the tool", |(_, name)| name);
            let combo = ComboBox::from_id_salt("brush mode").selected_text(name);
            combo
                .show_ui(ui, |ui| {
                    for (mode, name) in modes {
                        ui.selectable_value(&mut brush.mode, mode, name);
                    }
                })
                .response
        });
        let tip = "What the brush changes: the blur t, its anchor, whether gloss follows it, all three, or \
                   only the layer mask.";
        row(ui, "Touches", tip, |ui| {
            let channels = [
                (Channels::All, "blur, anchor, gloss"),
                (Channels::T, "blur only"),
                (Channels::Anchor, "anchor only"),
                (Channels::Gloss, "gloss only"),
                (Channels::Mask, "mask only"),
            ];
            let name =
                channels.iter().find(|(channel, _)| *channel == brush.channels).map_or("", |(_, name)| name);
            let combo = ComboBox::from_id_salt("brush channels").selected_text(name);
            combo
                .show_ui(ui, |ui| {
                    for (channel, name) in channels {
                        ui.selectable_value(&mut brush.channels, channel, name);
                    }
                })
                .response
        });
        let tip = "Surfaces whose normals differ from that under the pointer by more than this are not \
                   painted: 90° keeps paint from going through thin walls.";
        row(ui, "Facing", tip, |ui| {
            ui.add(
                DragValue::new(&mut brush.normal_limit_degrees)
                    .range(0.0..=180.0)
                    .speed(0.5)
                    .suffix("°")
                    .max_decimals(0),
            )
        });
    });
    falloff_editor(ui, &mut brush);
    rows(ui, "brush manner", |ui| {
        mirror_rows(ui, document, &mut brush);
        let tip =
            "Number of copies of every stroke around the vertical axis through the mirror centre; 1 is off.";
        row(ui, "Radial", tip, |ui| {
            ui.add(DragValue::new(&mut brush.radial).range(1..=focus::Symmetry::MAX_RADIAL).speed(0.05))
        });
        let tip = "Length of the string by which the pointer pulls the brush: longer gives a steadier line.";
        row(ui, "Stabiliser", tip, |ui| {
            ui.add(
                DragValue::new(&mut settings.stabiliser)
                    .range(0.0..=200.0)
                    .speed(0.5)
                    .max_decimals(0)
                    .suffix(" px"),
            )
        });
        let tip = "How far light pen pressure reduces the strength: 0 not at all, 1 down to nothing. A mouse \
                   has full pressure.";
        row(ui, "Pen: strength", tip, |ui| {
            controls::slider(ui, Slider::new(&mut brush.pressure_to_strength, 0.0..=1.0).max_decimals(2))
        });
        let tip = "How far light pen pressure reduces the size: 0 not at all, 1 down to nothing. A mouse has \
                   full pressure.";
        row(ui, "Pen: size", tip, |ui| {
            controls::slider(ui, Slider::new(&mut brush.pressure_to_radius, 0.0..=1.0).max_decimals(2))
        });
    });
    push_brush_change(document, brush, actions);
}

/// The mirrored axes and the mirror centre.
fn mirror_rows(ui: &mut Ui, document: &Document, brush: &mut Brush) {
    let tip =
        "Also paint the mirror image of every stroke: X left and right, Y up and down, Z front and back.";
    row(ui, "Mirror", tip, |ui| {
        controls::beside(ui, |ui| {
            let (low, high) = document.stage.bounds;
            let middle = ((low + high) / 2.0).to_array();
            let was_off = brush.mirror == [false; 3];
            for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
                let response = ui.toggle_value(&mut brush.mirror[axis], name).on_hover_text(tip);
                controls::set_accessible_name(&response, &format!("Mirror {name}"));
            }
            let is_on = !brush.symmetry().is_none();
            if was_off && is_on && brush.mirror_center == [0.0; 3] {
                brush.mirror_center = middle;
            }
        })
        .response
    });
    let tip = "The centre about which strokes, fills and gradients are mirrored and rotated: the scene, the \
               world, or the object they start on, with its own axes.";
    let is_on = !brush.symmetry().is_none();
    let (low, high) = document.stage.bounds;
    let middle = ((low + high) / 2.0).to_array();
    let previous_pivot = match brush.mirror_by_object {
        true => MirrorPivot::Object,
        false if brush.mirror_center == middle => MirrorPivot::Scene,
        false => MirrorPivot::World,
    };
    let mut pivot = previous_pivot;
    row(ui, "Mirror at", tip, |ui| {
        let combo = ComboBox::from_id_salt("mirror at").selected_text(pivot.name());
        let add = |ui: &mut Ui| {
            let choice = combo.show_ui(ui, |ui| {
                for choice in [MirrorPivot::Scene, MirrorPivot::World, MirrorPivot::Object] {
                    ui.selectable_value(&mut pivot, choice, choice.name());
                }
            });
            choice.response
        };
        ui.add_enabled_ui(is_on, add).inner
    });
    if pivot != previous_pivot {
        brush.mirror_by_object = pivot == MirrorPivot::Object;
        brush.mirror_axes = focus::WORLD_AXES;
        brush.mirror_center = if pivot == MirrorPivot::World { [0.0; 3] } else { middle };
    }
}

/// The centre of mirror and radial symmetry.
#[derive(Clone, Copy, PartialEq)]
enum MirrorPivot {
    Scene,
    World,
    Object,
}

impl MirrorPivot {
    fn name(self) -> &'static str {
        match self {
            Self::Scene => "the scene's middle",
            Self::World => "the world's origin",
            Self::Object => "the painted object",
        }
    }
}

/// The brush's radius in the full-size picture, px.
fn radius_px(document: &Document, hover: Option<SurfaceHit>, radius: f64) -> f64 {
    let camera = &document.camera;
    let inverse_depth = match hover.map(|hit| camera.camera_from_world(hit.position).z) {
        Some(depth) if depth > 0.0 => 1.0 / depth,
        _ => 1.0 / camera.focus_distance,
    };
    radius * inverse_depth / (camera.yfov / 2.0).tan() * camera.height as f64 / 2.0
}
