//! Settings of the lens in photographic terms, and of the picture.

use super::presets::{bokeh_thumbnails, preset_row};
use super::shape_panel::shape_panel;
use crate::window::view_settings::LARGEST_TOLERANCE_PX;
use crate::window::widgets::controls::{self, finish_edit, format_number, proportional_value, row, rows};
use crate::window::{Action, ViewSettings};
use document::{CameraEdit, Document};
use egui::{Button, ComboBox, DragValue, Slider, Ui};
use glam::DVec3;
use lens::{Camera, Exposure};
use project::{FocusHold, PresetKind, PresetLibrary};
use render::{OcioViews, ToneCurve};
use session::{Command, CommandId, Session};
use std::collections::BTreeSet;

/// Full stops in the f-number's menu.
const STOPS: [f64; 9] = [0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 16.0];

/// f-number, focal length, focus distance, aperture radius and shape, pose and angle of view.
pub fn lens_panel(ui: &mut Ui, document: &Document, presets: &PresetLibrary, actions: &mut Vec<Action>) {
    let camera = &document.camera;
    let optics = camera.optics();
    let edit = |edit: CameraEdit| Action::from(Command::EditCamera(edit));
    rows(ui, "lens", |ui| {
        if document.scene_cameras().count() > 1 {
            scene_camera_row(ui, document, actions);
        }
        preset_row(ui, presets, camera, PresetKind::Lens, |preset| preset.matches_camera(camera), actions);
        let mut number = camera.f_number();
        let tip = "The f-number: focal length over the aperture's diameter. Smaller means more blur. Keys: + \
                   and −.";
        let response = row(ui, "f-number", tip, |ui| {
            controls::beside(ui, |ui| {
                let value = proportional_value(&mut number, 0.05..=1e6)
                    .prefix("f/")
                    .custom_formatter(|n, d| if n.is_finite() { format_number(n, d) } else { "∞".into() });
                let response = ui.add(value);
                ui.menu_button("Stops", |ui| {
                    for stop in STOPS {
                        if ui.button(format!("f/{stop}")).clicked() {
                            actions.push(edit(CameraEdit::FNumber(stop)));
                            actions.push(Command::FinishEdit.into());
                            ui.close();
                        }
                    }
                })
                .response
                .on_hover_text("Choose a full stop.");
                response
            })
            .inner
        });
        if response.changed() {
            actions.push(edit(CameraEdit::FNumber(number)));
        }
        finish_edit(&response, actions);

        let mut radius = camera.aperture_radius * 1e3;
        let tip = "Half the side of the aperture's bounding square, in mm if the scene is in metres. 0 is a \
                   pinhole.";
        let response = row(ui, "Aperture radius", tip, |ui| {
            ui.add(proportional_value(&mut radius, 0.0..=1e6).suffix(" mm").custom_formatter(format_number))
        });
        if response.changed() {
            actions.push(edit(CameraEdit::ApertureRadius(radius / 1e3)));
        }
        finish_edit(&response, actions);

        let tip = "Thin lens: derived from sensor height, angle of view and focus distance.";
        row(ui, "Focal length", tip, |ui| {
            ui.label(format!("{} mm", controls::significant_digits(optics.focal_length() * 1e3)))
        });
        focus_distance_row(ui, document, actions);
        focus_hold_row(ui, document, actions);

        let mut degrees = camera.yfov.to_degrees();
        let response = row(ui, "Angle of view", "Full vertical angle of view.", |ui| {
            ui.add(DragValue::new(&mut degrees).speed(0.1).range(0.1..=179.0).suffix("°").max_decimals(2))
        });
        if response.changed() {
            actions.push(edit(CameraEdit::YFov(degrees.to_radians())));
        }
        finish_edit(&response, actions);

        let mut sensor = camera.sensor_height * 1e3;
        let tip = "Height of the sensor: determines how much blur a focus offset gives.";
        let response = row(ui, "Sensor height", tip, |ui| {
            ui.add(proportional_value(&mut sensor, 1e-3..=1e6).suffix(" mm").custom_formatter(format_number))
        });
        if response.changed() {
            actions.push(edit(CameraEdit::SensorHeight(sensor / 1e3)));
        }
        finish_edit(&response, actions);
        shift_rows(ui, camera, actions);
        preset_row(ui, presets, camera, PresetKind::Bokeh, |preset| preset.matches_camera(camera), actions);
        shape_panel(ui, camera, actions);
    });
    bokeh_thumbnails(ui, presets, camera, actions);
}

fn shift_rows(ui: &mut Ui, camera: &Camera, actions: &mut Vec<Action>) {
    let reach = 100.0 * Camera::LARGEST_SHIFT;
    for (axis, label, direction) in [(0, "Shift right", "to the right"), (1, "Shift up", "upwards")] {
        let tip = format!(
            "Shifts the sensor {direction}, in picture heights: the picture moves, perspective is unchanged."
        );
        let mut percent = 100.0 * camera.shift[axis];
        let response = row(ui, label, &tip, |ui| {
            ui.add(DragValue::new(&mut percent).speed(0.2).range(-reach..=reach).suffix(" %").max_decimals(3))
        });
        if response.changed() {
            let mut shift = camera.shift;
            shift[axis] = percent / 100.0;
            actions.push(Command::EditCamera(CameraEdit::Shift(shift)).into());
        }
        finish_edit(&response, actions);
    }
}

fn focus_distance_row(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let camera = &document.camera;
    let mut distance = camera.focus_distance;
    let tip = "Distance to the plane of focus along the axis. Keys: Shift+, and Shift+.";
    let response = row(ui, "Focus distance", tip, |ui| {
        controls::beside(ui, |ui| {
            let value = proportional_value(&mut distance, 1e-6..=f64::INFINITY).custom_formatter(|n, d| {
                if n.is_finite() { format!("{} m", format_number(n, d)) } else { "∞".into() }
            });
            let value = value.custom_parser(|text| match text.trim().trim_end_matches('m').trim() {
                "inf" | "∞" | "infinity" => Some(f64::INFINITY),
                number => number.parse().ok(),
            });
            let response = ui.add(value);
            let pick = CommandId::FocusHere.info();
            if ui.button("Pick").on_hover_text(pick.tooltip).clicked() {
                actions.push(pick.id.into());
            }
            if ui
                .add(Button::selectable(distance.is_infinite(), "∞"))
                .on_hover_text("Focus at infinity, or back at 10 m.")
                .clicked()
            {
                let distance = if distance.is_infinite() { 10.0 } else { f64::INFINITY };
                actions.push(Command::EditCamera(CameraEdit::FocusDistance(distance)).into());
                actions.push(Command::FinishEdit.into());
            }
            response
        })
        .inner
    });
    if response.changed() && distance != camera.focus_distance {
        actions.push(Command::EditCamera(CameraEdit::FocusDistance(distance)).into());
    }
    finish_edit(&response, actions);
}

fn focus_hold_row(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let camera = &document.camera;
    let tip = "What stays in focus when the camera moves: a point of the scene (Focus here chooses another), an object, or \
               nothing, so that the distance stays.";
    let shown = match &document.focus_hold {
        FocusHold::Point(_) => "a point",
        FocusHold::Object(name) => name,
        FocusHold::Distance => "the distance",
    };
    let mut choose = |ui: &mut Ui, label: &str, hold: FocusHold| {
        if ui.selectable_label(label == shown, label).clicked() {
            actions.push(Command::EditCamera(CameraEdit::FocusOn(hold)).into());
            actions.push(Command::FinishEdit.into());
        }
    };
    row(ui, "Focus held on", tip, |ui| {
        let combo = ComboBox::from_id_salt("focus hold").selected_text(shown).truncate();
        combo
            .show_ui(ui, |ui| {
                let ahead = camera.world_from_camera(DVec3::Z * camera.focus_distance);
                if ahead.is_finite() {
                    choose(ui, "a point", FocusHold::Point(ahead));
                }
                choose(ui, "the distance", FocusHold::Distance);
                let names: BTreeSet<&str> =
                    document.scene().nodes.iter().map(|node| node.name.as_str()).collect();
                for name in names.into_iter().filter(|name| !name.is_empty()) {
                    choose(ui, name, FocusHold::Object(name.into()));
                }
            })
            .response
    });
}

fn scene_camera_row(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let current = document
        .scene_cameras()
        .find(|(_, camera)| camera.camera_to_world == document.camera.camera_to_world);
    let name = current.map_or("own", |(name, _)| name).to_string();
    row(ui, "Camera", "A camera of the scene or of one of its photographs; the lens is not changed.", |ui| {
        let combo = ComboBox::from_id_salt("camera").selected_text(&name);
        combo
            .show_ui(ui, |ui| {
                for (candidate, camera) in document.scene_cameras() {
                    if ui.selectable_label(candidate == name, candidate).clicked() {
                        actions.push(Command::EditCamera(CameraEdit::Whole(Box::new(camera))).into());
                        actions.push(Command::FinishEdit.into());
                    }
                }
            })
            .response
    });
}

/// Picture size, exposure, display and preview quality.
pub fn picture_panel(
    ui: &mut Ui,
    session: &Session,
    document: &Document,
    settings: &mut ViewSettings,
    actions: &mut Vec<Action>,
) {
    let camera = &document.camera;
    rows(ui, "picture", |ui| {
        let (mut width, mut height) = (camera.width, camera.height);
        let side = 1..=lens::Camera::LARGEST_SIDE_PX;
        let tip = "Size of the exported picture.";
        let response = row(ui, "Size", tip, |ui| {
            controls::beside(ui, |ui| {
                let first =
                    ui.add(DragValue::new(&mut width).range(side.clone()).update_while_editing(false));
                controls::set_accessible_name(&first, "Picture width, px");
                ui.label("×");
                let second = ui.add(DragValue::new(&mut height).range(side).update_while_editing(false));
                controls::set_accessible_name(&second, "Picture height, px");
                ui.label("px");
                first.union(second)
            })
            .inner
        });
        if (width, height) != (camera.width, camera.height) {
            actions.push(Command::EditCamera(CameraEdit::Size(width, height)).into());
        }
        finish_edit(&response, actions);

        let tip = "Normalise keeps a white scene white. Conserve shows the energy of the model, with rims \
                   where the focus changes abruptly. Key: N.";
        row(ui, "Exposure", tip, |ui| {
            controls::beside(ui, |ui| {
                for (exposure, label) in
                    [(Exposure::Normalise, "Normalise"), (Exposure::Conserve, "Conserve")]
                {
                    if ui
                        .add(Button::selectable(document.exposure == exposure, label))
                        .on_hover_text(tip)
                        .clicked()
                    {
                        actions.push(Command::SetExposure(exposure).into());
                    }
                }
            })
            .response
        });

        row(ui, "Display", "Brightness of the display only; exported pictures are not affected.", |ui| {
            let value = DragValue::new(&mut settings.display_stops).speed(0.02).range(-10.0..=10.0);
            ui.add(value.suffix(" stops").max_decimals(2))
        });

        let tip = "Tone curve of the display, or a view of the OpenColorIO configuration named by $OCIO; \
                   exported EXRs are not affected.";
        row(ui, "Tone mapping", tip, |ui| {
            let combo = ComboBox::from_id_salt("tone mapping").selected_text(settings.tone_curve.name());
            combo
                .truncate()
                .show_ui(ui, |ui| {
                    for curve in ToneCurve::ALL {
                        ui.selectable_value(&mut settings.tone_curve, curve, curve.name());
                    }
                    let views = OcioViews::from_environment();
                    for curve in (0..views.len() as u16).map(ToneCurve::Ocio) {
                        ui.selectable_value(&mut settings.tone_curve, curve, curve.name());
                    }
                    if let Some(problem) = &views.problem {
                        ui.label(problem);
                    }
                })
                .response
        });

        let tip = "Longest side of the live picture: smaller is faster. Exports are always full size.";
        row(ui, "Preview", tip, |ui| {
            let text = |size: u32| format!("{size} px");
            let combo = ComboBox::from_id_salt("preview size").selected_text(text(settings.preview_size));
            combo
                .show_ui(ui, |ui| {
                    for size in [320, 640, 960, 1280, 1920] {
                        if ui.selectable_label(settings.preview_size == size, text(size)).clicked() {
                            settings.preview_size = size;
                            actions.push(Command::SetPreviewSize(size).into());
                        }
                    }
                })
                .response
        });

        let tip = "How coarsely the live picture may draw blurred areas: side of the merged samples in a \
                   blur of 16 px. 0 draws every sample. The exact picture follows automatically when nothing \
                   changes.";
        row(ui, "Tolerance", tip, |ui| {
            let slider = Slider::new(&mut settings.tolerance_px, 0.0..=LARGEST_TOLERANCE_PX);
            controls::slider(ui, slider.max_decimals(1).suffix(" px"))
        });
    });
    if let Some(summary) = tolerance_summary(session) {
        ui.weak(summary).on_hover_text(
            "Effect of the tolerance: draw times of the live and the exact \
                                        picture, and the PSNR between them.",
        );
    }
}

/// Draw times and PSNR of the live picture, once measured.
fn tolerance_summary(session: &Session) -> Option<String> {
    let costs = session.preview()?.costs;
    let live = costs.viewing_seconds.map(|seconds| format!("live {}", controls::seconds_text(seconds)));
    let exact = costs.exact_seconds.map(|seconds| format!("exact {}", controls::seconds_text(seconds)));
    let close = costs.viewing_psnr.map(|psnr| format!("{psnr:.0} dB"));
    let parts: Vec<String> = [live, exact, close].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join(" · "))
}
