//! `focus-brush keys`.

use super::new::check_project_name;
use crate::cli::arguments::KeysArguments;
use crate::cli::camera_presets::with_presets;
use crate::cli::console::{Console, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::check_folder;
use document::{Input, chief_ray, pick};
use focus::{FocusTarget, Key, KeyedCharacter, LayerStack, LensMotion};
use glam::DVec2;
use lens::Character;
use project::{ProjectFile, read_keys};
use serde_json::json;
use std::path::Path;
use trace::Tracer;

/// Sets keys of a project, or lists the existing ones.
///
/// # Errors
/// The project cannot be opened or saved, or a key is invalid.
pub fn run(arguments: &KeysArguments, console: &Console) -> Result<(), Failure> {
    let Some(output) = &arguments.output else {
        print_keys(&ProjectFile::load(&arguments.project)?);
        return Ok(());
    };
    check_project_name(output)?;
    check_folder(output)?;
    let mut project = ProjectFile::load(&arguments.project)?;
    if let Some(file) = &arguments.set {
        project.lens_motion = read_keys(file)?;
    }
    set_lens(arguments, &mut project.lens_motion, console)?;
    set_character(arguments, &mut project)?;
    for (name, opacity, seconds) in &arguments.opacity {
        if !(0.0..=1.0).contains(opacity) {
            return Err(project_failure(
                &arguments.project,
                &format!("{opacity} not a valid opacity (give 0 to 1)"),
            ));
        }
        let index = project.layers.as_ref().and_then(|layers| layer_index(layers, name));
        let layers = project.layers.as_mut().zip(index);
        let Some(layer) = layers.and_then(|(layers, index)| layers.layer_mut(index)) else {
            return Err(project_failure(
                &arguments.project,
                &format!("no layer is called {name:?} ({})", layer_names_sentence(&project)),
            ));
        };
        check_key_added(
            layer.motion.opacity.insert(Key { seconds: *seconds, value: *opacity, ease: arguments.ease }),
            arguments,
        )?;
    }
    if !project.lens_motion.is_valid() {
        return Err(project_failure(
            &arguments.project,
            "distances and f-numbers must be above 0, characters those of lens files",
        ));
    }
    project.save(output)?;
    console.note(&format!("wrote {}", output.display()));
    Ok(())
}

fn set_lens(arguments: &KeysArguments, motion: &mut LensMotion, console: &Console) -> Result<(), Failure> {
    let ease = arguments.ease;
    for &(distance, seconds) in &arguments.distance {
        let value = FocusTarget::Distance(distance);
        check_key_added(motion.focus.insert(Key { seconds, value, ease }), arguments)?;
    }
    for &(value, seconds) in &arguments.f_number {
        check_key_added(motion.f_number.insert(Key { seconds, value, ease }), arguments)?;
    }
    if arguments.point.is_empty() {
        return Ok(());
    }
    let input = Input::open(&arguments.project, console.resources(), console)?;
    let (camera, tracer) = (&input.camera, Tracer::new(input.scene.clone()));
    for &(place, seconds) in &arguments.point {
        let position = place / DVec2::new(camera.width.into(), camera.height.into());
        let picked = pick(&tracer, &chief_ray(camera, position));
        let Some(hit) = picked else {
            let [x, y] = place.to_array();
            let what = format!(
                "no surface is visible at {x},{y} of {} × {} px (choose another position)",
                camera.width, camera.height
            );
            return Err(project_failure(&arguments.project, &what));
        };
        check_key_added(
            motion.focus.insert(Key { seconds, value: FocusTarget::Point(hit.point), ease }),
            arguments,
        )?;
    }
    Ok(())
}

/// Sets keys of the character: as it is on the project's camera.
fn set_character(arguments: &KeysArguments, project: &mut ProjectFile) -> Result<(), Failure> {
    let camera = project.cameras.get(project.active_camera).map(|named| named.camera.clone());
    let camera = camera.unwrap_or_default();
    for (lens, seconds) in &arguments.character {
        let character = match lens.as_str() {
            "none" => Character::default(),
            name => with_presets(camera.clone(), Some(name.as_ref()), None)?.character,
        };
        let key = Key { seconds: *seconds, value: KeyedCharacter(character), ease: arguments.ease };
        check_key_added(project.lens_motion.character.insert(key), arguments)?;
    }
    Ok(())
}

fn layer_index(layers: &LayerStack, name: &str) -> Option<usize> {
    layers.layers().iter().position(|layer| layer.name == name)
}

fn layer_names_sentence(project: &ProjectFile) -> String {
    match &project.layers {
        None => "it has a single layer, which always has full opacity; add one to fade".into(),
        Some(layers) => {
            let names: Vec<_> = layers.layers().iter().map(|layer| format!("{:?}", layer.name)).collect();
            format!("there are {}", names.join(", "))
        }
    }
}

fn check_key_added(is_added: bool, arguments: &KeysArguments) -> Result<(), Failure> {
    if is_added {
        Ok(())
    } else {
        Err(project_failure(&arguments.project, "has the maximum number of keys (remove some)"))
    }
}

fn project_failure(project: &Path, what: &str) -> Failure {
    Failure::bad_input(format!("{}: {what}", project.display()))
}

fn print_keys(project: &ProjectFile) {
    let layers = project.layers.iter().flat_map(|layers| layers.layers());
    let animated = layers.filter(|layer| !layer.motion.is_empty());
    let layers: Vec<_> = animated.map(|layer| json!({ "layer": layer.name, "keys": layer.motion })).collect();
    print_json(&json!({ "lens": project.lens_motion, "layers": layers }));
}
