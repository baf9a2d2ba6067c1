//! Brush presets: the settings of a brush that do not depend on the scene.

use crate::ProjectError;
use focus::Brush;
use serde_json::{Map, Value};
use std::path::Path;

/// Fields that depend on the scene or on what is being painted: size, source of cloning, symmetry.
const SCENE_FIELDS: [&str; 7] =
    ["radius", "clone_offset", "mirror", "radial", "mirror_center", "mirror_axes", "mirror_by_object"];

/// `current` with all settings of the preset.
pub(super) fn apply_to_brush(preset: &Brush, current: &Brush) -> Brush {
    Brush {
        radius: current.radius,
        clone_offset: current.clone_offset,
        mirror: current.mirror,
        radial: current.radial,
        mirror_center: current.mirror_center,
        mirror_axes: current.mirror_axes,
        mirror_by_object: current.mirror_by_object,
        ..preset.clone()
    }
}

/// Reads the fields of `"brush"` of a file; missing ones are those of the default brush.
pub(super) fn read(file: &Path, value: &Value) -> Result<Brush, ProjectError> {
    let error = |field: String, problem: String, cure: &str| {
        Err(ProjectError::Field { file: file.to_owned(), field, problem, cure: cure.into() })
    };
    if let Some(scene_field) = SCENE_FIELDS.into_iter().find(|name| value.get(name).is_some()) {
        return error(
            format!("brush.{scene_field}"),
            "belongs to the scene and not to a preset".into(),
            "leave it out",
        );
    }
    let wrong =
        |problem: String| error("brush".into(), format!("cannot be used: {problem}"), "correct it there");
    match serde_json::from_value::<Brush>(value.clone()) {
        Err(problem) => wrong(problem.to_string()),
        Ok(brush) => match brush.problem() {
            Some(problem) => wrong(problem.into()),
            None => Ok(brush),
        },
    }
}

/// Inverse of [`read`].
pub(super) fn to_json(brush: &Brush) -> Value {
    let Ok(Value::Object(fields)) = serde_json::to_value(brush) else { return Value::Object(Map::new()) };
    Value::Object(fields.into_iter().filter(|(name, _)| !SCENE_FIELDS.contains(&name.as_str())).collect())
}
