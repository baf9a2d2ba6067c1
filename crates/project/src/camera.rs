//! The camera as JSON.
//!
//! ```text
//! {"width": 960, "height": 540, "yfov": 0.7, "focus_distance": 3.0 | "inf", "aperture_radius": 0.0125,
//!  "sensor_height": 0.024, "shift": [x, y], "camera_to_world": 4×4 rows, "background": [r, g, b],
//!  "aperture": {"shape": "disc" | "polygon" | "square" | "mask", "blades": 6, "rotation": rad,
//!               "roundness": 0..1, "ratio": 1.0, "mask": FILE | {"name": …, "rows": […]}},
//!  "character": {"edges": -1..1, "rims": [{"radius": ρ, "distance": ℓ}], …}}
//! ```
//!
//! yfov is the full angle in rad, lengths are scene units, focus_distance is axial, to the focus plane;
//! shift moves the sensor right and up, in picture heights (none: [0, 0]); camera_to_world has glTF axes (looks down −Z, +Y up). Any field may be missing.

mod aperture_mask_file;
pub(crate) mod character;
pub(crate) mod mask_rows;

pub use aperture_mask_file::read_aperture_mask;

use crate::ProjectError;
use crate::disk::write_bytes;
use crate::json::{Field, Fields, Json};
use crate::named_file::named_file;
use character::{character_from_json, character_to_json};
use glam::{DMat4, DVec2, DVec4};
use lens::{Aperture, ApertureMask, ApertureShape, Camera};
use mask_rows::mask_from_json;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

const FIELDS: [&str; 11] = [
    "width",
    "height",
    "yfov",
    "focus_distance",
    "aperture_radius",
    "sensor_height",
    "shift",
    "camera_to_world",
    "background",
    "aperture",
    "character",
];
const APERTURE_FIELDS: [&str; 6] = ["shape", "blades", "rotation", "roundness", "ratio", "mask"];

/// Number of corners of a polygon whose file gives none.
const DEFAULT_BLADES: u32 = 6;

/// Reads a camera file. Missing fields take the value of `defaults`. Unknown fields are errors, since a misspelt one
/// would otherwise go unnoticed. A mask lies in the folder of the camera file or below it.
///
/// # Errors
/// The file or its mask cannot be read, a field is unknown or of the wrong type, or the camera is invalid.
pub fn read_camera(file: &Path, defaults: &Camera) -> Result<Camera, ProjectError> {
    camera_from_fields(file, &Json::read(file)?, defaults, &|path| {
        read_aperture_mask(&named_file(file, path)?, path)
    })
}

/// Parses a camera from the JSON text of `file` (used in messages); `mask` loads an aperture mask by the name given
/// in the text.
///
/// # Errors
/// As [`read_camera`].
pub fn camera_from_json(
    file: &Path,
    text: &str,
    defaults: &Camera,
    mask: &dyn Fn(&str) -> Result<ApertureMask, ProjectError>,
) -> Result<Camera, ProjectError> {
    camera_from_fields(file, &Json::parse(file, text)?, defaults, mask)
}

fn camera_from_fields(
    file: &Path,
    json: &Json,
    defaults: &Camera,
    mask: &dyn Fn(&str) -> Result<ApertureMask, ProjectError>,
) -> Result<Camera, ProjectError> {
    let fields = Field::root(file, json).object()?;
    fields.allow_only(&FIELDS)?;
    let number = |name, default| fields.get(name).map_or(Ok(default), |field| field.number());
    let whole = |name, default| fields.get(name).map_or(Ok(default), |field| field.whole_number());
    let camera = Camera {
        width: whole("width", defaults.width)?,
        height: whole("height", defaults.height)?,
        yfov: number("yfov", defaults.yfov)?,
        focus_distance: match fields.get("focus_distance") {
            Some(field) if field.text().is_ok_and(|text| text == "inf") => f64::INFINITY,
            Some(field) => field.number()?,
            None => defaults.focus_distance,
        },
        aperture_radius: number("aperture_radius", defaults.aperture_radius)?,
        sensor_height: number("sensor_height", defaults.sensor_height)?,
        shift: match fields.get("shift") {
            Some(field) => DVec2::from_array(field.numbers()?),
            None => defaults.shift,
        },
        camera_to_world: match fields.get("camera_to_world") {
            Some(field) => {
                let [x, y, z, w] = field.rows::<4, 4>()?.map(DVec4::from_array);
                if w != DVec4::W {
                    return Err(field.error("is not a rigid motion", "its last row must be 0, 0, 0, 1"));
                }
                DMat4::from_cols(x, y, z, w).transpose()
            }
            None => defaults.camera_to_world,
        },
        background: match fields.get("background") {
            Some(field) => Some(field.numbers()?),
            None => defaults.background,
        },
        aperture: match fields.get("aperture") {
            Some(field) => aperture_from_json(&field.object()?, mask)?,
            None => defaults.aperture.clone(),
        },
        character: defaults.character,
    };
    let camera = match fields.get("character") {
        Some(field) => {
            let character = character_from_json(&field.object()?, camera.aperture_radius)?;
            Camera { character, ..camera }
        }
        None => camera,
    };
    camera.validate().map_err(|error| ProjectError::Field {
        file: file.to_owned(),
        field: error.field.replace("aperture ", "aperture.").replace("character ", "character."),
        problem: "cannot be used".to_string(),
        cure: format!("it must be {}", error.must),
    })?;
    Ok(camera)
}

/// Parses an aperture from its JSON fields. A mask is either the name of a picture file, loaded by `mask`, or given
/// inline.
pub(crate) fn aperture_from_json(
    fields: &Fields<'_>,
    mask: &dyn Fn(&str) -> Result<ApertureMask, ProjectError>,
) -> Result<Aperture, ProjectError> {
    fields.allow_only(&APERTURE_FIELDS)?;
    let number = |name, default| fields.get(name).map_or(Ok(default), |field| field.number());
    let ratio = number("ratio", 1.0)?;
    let name = fields.get("shape").map_or(Ok("disc"), |field| field.text())?;
    let shape = match (name, fields.get("mask"), fields.get("shape")) {
        ("disc", ..) => ApertureShape::Disc,
        ("square", ..) => ApertureShape::Square,
        ("polygon", ..) => ApertureShape::Polygon {
            blades: fields.get("blades").map_or(Ok(DEFAULT_BLADES), |field| field.whole_number())?,
            rotation: number("rotation", 0.0)?,
            roundness: number("roundness", 0.0)?,
        },
        ("mask", Some(field), _) => ApertureShape::Mask(Arc::new(match field.value {
            Json::Object(_) => mask_from_json(&field)?,
            _ => mask(field.text()?)?,
        })),
        ("mask", None, Some(shape)) => {
            return Err(shape.error("is \"mask\", but no mask is given", "add \"mask\": FILE"));
        }
        (_, _, Some(shape)) => {
            return Err(
                shape.error(format!("\"{name}\" is not a shape"), "give disc, polygon, square or mask")
            );
        }
        (_, _, None) => unreachable!("a missing shape is a disc"),
    };
    Ok(Aperture { shape, ratio })
}

/// Writes a camera file. A mask is stored by name, not copied.
///
/// # Errors
/// The file cannot be written.
pub fn write_camera(file: &Path, camera: &Camera) -> Result<(), ProjectError> {
    let text = serde_json::to_string_pretty(&camera_to_json(camera)).expect("a JSON value has a text");
    write_bytes(file, (text + "\n").as_bytes())
}

/// The camera as the JSON value of a camera file.
pub fn camera_to_json(camera: &Camera) -> Value {
    let rows = camera.camera_to_world.transpose().to_cols_array_2d();
    let focus_distance = match camera.focus_distance {
        distance if distance.is_infinite() => json!("inf"),
        distance => json!(distance),
    };
    let mut json = json!({
        "width": camera.width,
        "height": camera.height,
        "yfov": camera.yfov,
        "focus_distance": focus_distance,
        "aperture_radius": camera.aperture_radius,
        "sensor_height": camera.sensor_height,
        "camera_to_world": rows,
        "aperture": aperture_to_json(&camera.aperture),
    });
    if camera.shift != DVec2::ZERO {
        json["shift"] = json!(camera.shift.to_array());
    }
    if let Some(background) = camera.background {
        json["background"] = json!(background);
    }
    if !camera.character.is_neutral() {
        json["character"] = character_to_json(&camera.character);
    }
    json
}

/// The aperture as a JSON value; a mask is stored by name, not copied.
pub(crate) fn aperture_to_json(aperture: &Aperture) -> Value {
    let mut json = match &aperture.shape {
        ApertureShape::Disc => json!({"shape": "disc"}),
        ApertureShape::Square => json!({"shape": "square"}),
        ApertureShape::Polygon { blades, rotation, roundness } => {
            json!({"shape": "polygon", "blades": blades, "rotation": rotation, "roundness": roundness})
        }
        ApertureShape::Mask(mask) => json!({"shape": "mask", "mask": mask.file}),
    };
    json["ratio"] = json!(aperture.ratio);
    json
}
