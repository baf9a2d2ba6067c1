//! A lens in a photographer's terms.

use crate::ProjectError;
use crate::camera::character::{character_from_json, character_to_json};
use crate::json::Fields;
use lens::{Camera, Character};
use serde_json::{Value, json};

/// Focal length, f-number and sensor size. The camera's pose, its focus distance, the picture's size and the
/// aperture's shape are not part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensPreset {
    /// f of the thin lens, scene units (glTF: metres), > 0.
    pub focal_length: f64,
    /// f/(2R), > 0; infinite for a pinhole.
    pub f_number: f64,
    /// Height of the sensor, scene units, > 0.
    pub sensor_height: f64,
    /// What it does beside focusing; lengths in scene units.
    pub character: Character,
}

impl LensPreset {
    /// The preset that has the lens and aperture of a camera.
    pub fn from_camera(camera: &Camera) -> Self {
        Self {
            focal_length: camera.optics().focal_length(),
            f_number: camera.f_number(),
            sensor_height: camera.sensor_height,
            character: camera.character,
        }
    }

    /// The camera with this lens, focused at the same distance: 1/d = 1/f − 1/s gives the image distance and thus the
    /// angle of view. `None` if the camera focuses nearer than the focal length, which no lens can.
    pub fn apply_to(&self, camera: &Camera) -> Option<Camera> {
        let inverse_image_distance = 1.0 / self.focal_length - 1.0 / camera.focus_distance;
        (inverse_image_distance > 0.0).then(|| Camera {
            sensor_height: self.sensor_height,
            yfov: 2.0 * (self.sensor_height * inverse_image_distance / 2.0).atan(),
            aperture_radius: self.aperture_radius(),
            character: self.character,
            ..camera.clone()
        })
    }

    /// R, scene units.
    fn aperture_radius(&self) -> f64 {
        self.focal_length / (2.0 * self.f_number)
    }

    /// Reads the fields of `"lens"`.
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self, ProjectError> {
        fields.allow_only(&["focal_length", "f_number", "sensor_height", "character"])?;
        let positive = |name| match fields.get(name) {
            Some(field) if name == "f_number" && field.text().is_ok_and(|text| text == "inf") => {
                Ok(f64::INFINITY)
            }
            Some(field) => match field.number()? {
                number if number > 0.0 => Ok(number),
                number => Err(field.error(format!("is {number}"), "give a number above 0")),
            },
            None => Err(fields.error(format!("has no \"{name}\""), "add it")),
        };
        let plain = Self {
            focal_length: positive("focal_length")?,
            f_number: positive("f_number")?,
            sensor_height: positive("sensor_height")?,
            character: Character::default(),
        };
        let Some(field) = fields.get("character") else { return Ok(plain) };
        let character = character_from_json(&field.object()?, plain.aperture_radius())?;
        // No camera's image distance is less than the focal length.
        character.validate(plain.focal_length).map_err(|error| {
            let name = error.field.trim_start_matches("character ");
            field.error(format!("has a \"{name}\" that cannot be used"), format!("it must be {}", error.must))
        })?;
        Ok(Self { character, ..plain })
    }

    /// Inverse of [`Self::read`].
    pub(super) fn to_json(self) -> Value {
        let f_number = if self.f_number.is_finite() { json!(self.f_number) } else { json!("inf") };
        let mut json = json!({ "focal_length": self.focal_length, "f_number": f_number, "sensor_height": self.sensor_height });
        if !self.character.is_neutral() {
            json["character"] = character_to_json(&self.character);
        }
        json
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lens_on_another_camera_is_the_same_lens() {
        let character = Character { edges: 0.5, ..Character::default() };
        let preset = LensPreset { focal_length: 0.085, f_number: 1.4, sensor_height: 0.024, character };
        for focus_distance in [0.3, 2.0, f64::INFINITY] {
            let camera = preset.apply_to(&Camera { focus_distance, ..Camera::default() }).unwrap();
            camera.validate().unwrap();
            assert_eq!(camera.character, character);
            let preset = LensPreset::from_camera(&camera);
            assert!((preset.focal_length / 0.085 - 1.0).abs() < 1e-12, "{preset:?}");
            assert!((preset.f_number / 1.4 - 1.0).abs() < 1e-12, "{preset:?}");
        }
        let too_near = Camera { focus_distance: 0.085, ..Camera::default() };
        assert_eq!(preset.apply_to(&too_near), None);
    }
}
