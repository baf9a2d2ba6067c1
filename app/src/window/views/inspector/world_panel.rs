//! The world: the environment that lights the scene and is visible behind all surfaces.

mod environment_picture;

use crate::window::Action;
use crate::window::widgets::controls::{self, proportional_value, row, rows};
use document::Document;
use egui::{Button, ComboBox, DragValue, Ui};
use environment_picture::{thumbnail_button, turning_strip};
use glam::{DVec3, Vec3};
use scene::{Backdrop, BuiltInEnvironment, Environment, Scene, World};
use session::Command;
use std::sync::Arc;

/// The kinds of environment that the panel offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EnvironmentKind {
    Own,
    BuiltIn(BuiltInEnvironment),
    Color,
    File,
}

/// Draws the settings of the world.
pub fn world_panel(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let scene = document.scene();
    let background = document.camera.background.map(|color| DVec3::from_array(color).as_vec3());
    let shown = World::from_scene(scene, background);
    let kind = environment_kind(scene);
    rows(ui, "world", |ui| {
        let tip = "The environment that lights the scene. Drop an equirectangular .hdr or .exr on the window \
                   to use it.";
        row(ui, "Environment", tip, |ui| environment_choice(ui, kind, &shown, actions));
        row(ui, "Built in", "Environments that come with the program.", |ui| {
            controls::beside(ui, |ui| {
                for built_in in BuiltInEnvironment::ALL {
                    let is_chosen = kind == EnvironmentKind::BuiltIn(built_in);
                    if thumbnail_button(ui, built_in, is_chosen).clicked() && !is_chosen {
                        actions.push(Command::SetWorld(Some(World::built_in(built_in))).into());
                    }
                }
            })
            .response
        });
        if let Some(source) = source_name(&shown, scene) {
            row(ui, "Source", "Source of the environment.", |ui| ui.add(egui::Label::new(source).truncate()));
        }
        let mut world = shown.clone();
        if let Environment::Uniform(color) = &mut world.environment {
            row(ui, "Color", "Linear radiance.", |ui| color_edit(ui, color));
        }
        if let Environment::Map(map) = &shown.environment {
            row(ui, "Picture", "Drag it to turn the environment.", |ui| {
                turning_strip(ui, map, &mut world.rotation)
            });
        }
        let mut degrees = world.rotation.to_degrees();
        let tip = "Rotates the environment about the vertical axis.";
        let response = row(ui, "Turn", tip, |ui| {
            ui.add(DragValue::new(&mut degrees).speed(1.0).range(-360.0..=360.0).suffix("°").max_decimals(1))
        });
        if response.changed() {
            world.rotation = degrees.to_radians();
        }
        let mut strength = f64::from(world.strength);
        let tip = "Scales the radiance of the environment.";
        if row(ui, "Strength", tip, |ui| ui.add(proportional_value(&mut strength, 0.0..=1e6))).changed() {
            world.strength = strength as f32;
        }
        row(ui, "Backdrop", "What the camera sees behind all surfaces. It does not light the scene.", |ui| {
            backdrop_buttons(ui, &mut world.backdrop)
        });
        if let Backdrop::Color(color) = &mut world.backdrop {
            row(ui, "Backdrop color", "Linear radiance of the backdrop.", |ui| color_edit(ui, color));
        }
        let problem = scene.floor_problem();
        let mut has_floor = scene.floor.is_some_and(|floor| floor.is_shown);
        let tip = match problem {
            None => {
                "Puts a matte floor under the scene that looks like the backdrop and catches shadows.".into()
            }
            Some(problem) => format!("No floor: {problem}."),
        };
        let changed = row(ui, "Floor", &tip, |ui| {
            ui.add_enabled(problem.is_none(), egui::Checkbox::new(&mut has_floor, "Catches shadows"))
        });
        if changed.changed() {
            actions.push(Command::SetFloor(has_floor).into());
        }
        let tip = "Maximum number of bounces of light between surfaces: 0 is direct light only.";
        row(ui, "Bounces", tip, |ui| bounces(ui, &mut world.bounces));
        if world != shown {
            actions.push(Command::SetWorld(Some(world)).into());
        }
    });
}

fn environment_kind(scene: &Scene) -> EnvironmentKind {
    match scene.world.as_ref().map(|world| &world.environment) {
        None => EnvironmentKind::Own,
        Some(environment) if is_scene_environment(environment, scene) => EnvironmentKind::Own,
        Some(Environment::Uniform(_)) => EnvironmentKind::Color,
        Some(environment) => environment.built_in().map_or(EnvironmentKind::File, EnvironmentKind::BuiltIn),
    }
}

/// Whether an environment is the one provided by the scene's file.
fn is_scene_environment(environment: &Environment, scene: &Scene) -> bool {
    let own = scene.embedded_world.as_ref().map(|own| &own.environment);
    match (environment, own) {
        // The usual case, without comparing texels.
        (Environment::Map(map), Some(Environment::Map(own))) if Arc::ptr_eq(map, own) => true,
        (environment, own) => Some(environment) == own,
    }
}

/// The file name of an environment map, or the scene's name for its own.
fn source_name(world: &World, scene: &Scene) -> Option<String> {
    let Environment::Map(map) = &world.environment else { return None };
    if is_scene_environment(&world.environment, scene) {
        return Some(format!("{} of the scene", map.name));
    }
    let name = std::path::Path::new(&map.name).file_name();
    Some(name.map_or_else(|| map.name.clone(), |name| name.to_string_lossy().into_owned()))
}

fn environment_choice(
    ui: &mut Ui,
    kind: EnvironmentKind,
    shown: &World,
    actions: &mut Vec<Action>,
) -> egui::Response {
    let choices = [
        (
            EnvironmentKind::Own,
            "The scene's own",
            "The environment of the scene's file (EXT_lights_image_based); a scene without light gets the \
             studio.",
        ),
        (EnvironmentKind::BuiltIn(BuiltInEnvironment::Studio), "Studio", "A soft neutral studio."),
        (
            EnvironmentKind::BuiltIn(BuiltInEnvironment::Overcast),
            "Overcast",
            "A cloudy sky over open ground.",
        ),
        (EnvironmentKind::BuiltIn(BuiltInEnvironment::Evening), "Evening", "A low sun and its sky."),
        (EnvironmentKind::Color, "Color", "The same radiance from all directions."),
        (EnvironmentKind::File, "Picture…", "An equirectangular image, .hdr or .exr."),
    ];
    let label = choices.iter().find(|(choice, ..)| *choice == kind).map_or("", |(_, label, _)| label);
    let mut chosen = None;
    let response = ComboBox::from_id_salt("environment")
        .selected_text(label)
        .show_ui(ui, |ui| {
            for (choice, label, tip) in choices {
                if ui.selectable_label(kind == choice, label).on_hover_text(tip).clicked() {
                    chosen = Some(choice);
                }
            }
        })
        .response;
    match chosen {
        Some(EnvironmentKind::Own) => actions.push(Command::SetWorld(None).into()),
        Some(EnvironmentKind::BuiltIn(built_in)) => {
            actions.push(Command::SetWorld(Some(World::built_in(built_in))).into());
        }
        Some(EnvironmentKind::Color) => {
            let color = match shown.environment {
                Environment::Uniform(color) if color != Vec3::ZERO => color,
                _ => Vec3::splat(0.5),
            };
            actions.push(Command::SetWorld(Some(World::uniform(color))).into());
        }
        Some(EnvironmentKind::File) => actions.push(Action::ChooseEnvironment),
        None => {}
    }
    response
}

fn backdrop_buttons(ui: &mut Ui, backdrop: &mut Backdrop) -> egui::Response {
    ui.horizontal(|ui| {
        let is_environment = *backdrop == Backdrop::Environment;
        if ui
            .add(Button::selectable(is_environment, "Environment"))
            .on_hover_text("The camera sees the environment.")
            .clicked()
        {
            *backdrop = Backdrop::Environment;
        }
        if ui
            .add(Button::selectable(!is_environment, "Plain"))
            .on_hover_text("The camera sees a plain colour.")
            .clicked()
            && is_environment
        {
            *backdrop = World::studio().backdrop;
        }
    })
    .response
}

fn color_edit(ui: &mut Ui, color: &mut Vec3) -> egui::Response {
    let mut rgb = color.to_array();
    let response = ui.color_edit_button_rgb(&mut rgb);
    if response.changed() {
        *color = Vec3::from_array(rgb);
    }
    response
}

fn bounces(ui: &mut Ui, bounces: &mut Option<u32>) -> egui::Response {
    ui.horizontal(|ui| {
        let mut all = bounces.is_none();
        if ui.checkbox(&mut all, "All").on_hover_text("As many bounces as contribute.").changed() {
            *bounces = if all { None } else { Some(2) };
        }
        if let Some(count) = bounces {
            ui.add(DragValue::new(count).range(0..=64));
        }
    })
    .response
}
