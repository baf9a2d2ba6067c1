//! The character of a lens as JSON.
//!
//! ```text
//! {"widest_radius": R₀, "field_curvature": C, "longitudinal_colour": [red, blue], "lateral_colour": [red, blue],
//!  "edges": -1..1, "rims": [{"radius": ρ, "distance": ℓ}, …], "cos4": true}
//! ```
//!
//! Lengths are scene units; what is missing is not there. `widest_radius` is the radius of the lens fully open: that of the camera or
//! preset if the file gives none.

use crate::ProjectError;
use crate::json::Fields;
use lens::{Character, Rim};
use serde_json::{Value, json};

const FIELDS: [&str; 7] =
    ["widest_radius", "field_curvature", "longitudinal_colour", "lateral_colour", "edges", "rims", "cos4"];

/// The character that these fields give to a lens with this aperture radius, scene units. Ranges are left to
/// [`Character::validate`].
///
/// # Errors
/// A field is unknown or of the wrong type, or there are more than two rims.
pub(crate) fn character_from_json(
    fields: &Fields<'_>,
    aperture_radius: f64,
) -> Result<Character, ProjectError> {
    fields.allow_only(&FIELDS)?;
    let number = |name, default| fields.get(name).map_or(Ok(default), |field| field.number());
    let pair = |name| fields.get(name).map_or(Ok([0.0; 2]), |field| field.numbers());
    let mut rims = [None; 2];
    if let Some(list) = fields.get("rims") {
        let objects = list.list()?;
        if objects.len() > rims.len() {
            return Err(list.error(format!("has {} rims", objects.len()), "give two at most"));
        }
        for (rim, field) in rims.iter_mut().zip(&objects) {
            *rim = Some(rim_from_json(&field.object()?)?);
        }
    }
    let widest = (aperture_radius > 0.0).then_some(aperture_radius);
    Ok(Character {
        widest_radius: fields.get("widest_radius").map_or(Ok(widest), |field| field.number().map(Some))?,
        field_curvature: number("field_curvature", 0.0)?,
        longitudinal_colour: pair("longitudinal_colour")?,
        lateral_colour: pair("lateral_colour")?,
        edges: number("edges", 0.0)?,
        rims,
        has_cos4_falloff: fields.get("cos4").map_or(Ok(false), |field| field.boolean())?,
    })
}

fn rim_from_json(fields: &Fields<'_>) -> Result<Rim, ProjectError> {
    fields.allow_only(&["radius", "distance"])?;
    let required = |name: &'static str| match fields.get(name) {
        Some(field) => field.number(),
        None => Err(fields.error(format!("has no \"{name}\""), "add it")),
    };
    Ok(Rim { radius: required("radius")?, distance: required("distance")? })
}

/// The character as the JSON value that [`character_from_json`] reads.
pub(crate) fn character_to_json(character: &Character) -> Value {
    let mut json = json!({});
    let mut set = |name: &str, value: Value| json[name] = value;
    if let Some(radius) = character.widest_radius {
        set("widest_radius", json!(radius));
    }
    if character.field_curvature != 0.0 {
        set("field_curvature", json!(character.field_curvature));
    }
    for (name, colours) in
        [("longitudinal_colour", character.longitudinal_colour), ("lateral_colour", character.lateral_colour)]
    {
        if colours != [0.0; 2] {
            set(name, json!(colours));
        }
    }
    if character.edges != 0.0 {
        set("edges", json!(character.edges));
    }
    let rims = character.rims().map(|rim| json!({"radius": rim.radius, "distance": rim.distance}));
    let rims: Vec<Value> = rims.collect();
    if !rims.is_empty() {
        set("rims", json!(rims));
    }
    if character.has_cos4_falloff {
        set("cos4", json!(true));
    }
    json
}
