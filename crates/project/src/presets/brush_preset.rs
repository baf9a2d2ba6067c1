//! What of a brush is no matter of the scene that it was made in.

use super::preset::Place;
use crate::ProjectError;
use focus::Brush;
use serde_json::{Map, Value};

/// Fields that belong to the scene, or to what is being painted in it: size, where cloning takes from, symmetry.
const OF_THE_SCENE: [&str; 7] =
    ["radius", "clone_offset", "mirror", "radial", "mirror_center", "mirror_axes", "mirror_by_object"];

/// `current` with all that a preset says of a brush.
pub(super) fn applied(preset: &Brush, current: &Brush) -> Brush {
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

/// Reads the fields of `"brush"`; those that are missing are the default brush's.
pub(super) fn read(place: &Place<'_>, value: &Value) -> Result<Brush, ProjectError> {
    if let Some(own) = OF_THE_SCENE.into_iter().find(|name| value.get(name).is_some()) {
        return Err(place.error(own, "belongs to the scene and not to a preset", "leave it out"));
    }
    let brush: Brush = serde_json::from_value(value.clone())
        .map_err(|error| place.error("", format!("cannot be used: {error}"), "mend it there"))?;
    match brush.problem() {
        Some(problem) => Err(place.error("", format!("cannot be used: {problem}"), "mend it there")),
        None => Ok(brush),
    }
}

/// Inverse of [`read`].
pub(super) fn to_json(brush: &Brush) -> Value {
    let Ok(Value::Object(fields)) = serde_json::to_value(brush) else { return Value::Object(Map::new()) };
    Value::Object(fields.into_iter().filter(|(name, _)| !OF_THE_SCENE.contains(&name.as_str())).collect())
}
