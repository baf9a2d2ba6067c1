//! A preset and its file.
//!
//! ```text
//! {"format": "focus-brush preset", "version": 1, "name": "Soft focus", "brush": {…} | "lens": {…} | "bokeh": {…}}
//! ```

use super::brush_preset;
use super::lens_preset::LensPreset;
use crate::ProjectError;
use crate::camera::mask_rows::mask_to_json;
use crate::camera::{aperture_from_json, aperture_to_json};
use crate::disk::{read_text, write_verified};
use crate::json::{Field, Json};
use crate::named_file::named_file;
use focus::Brush;
use lens::{Aperture, ApertureShape, Camera};
use serde_json::{Value, json};
use std::path::Path;

/// The file's name of its format.
const FORMAT: &str = "focus-brush preset";

/// The newest version.
const VERSION: u32 = 1;

/// Maximum length of a name, characters.
const MAX_NAME_CHARS: usize = 80;

/// The kind of a preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PresetKind {
    /// How a brush paints.
    Brush,
    /// Focal length, f-number, sensor.
    Lens,
    /// The aperture's shape.
    Bokeh,
}

impl PresetKind {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 3] = [Self::Brush, Self::Lens, Self::Bokeh];

    /// Its name in files and folders.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brush => "brush",
            Self::Lens => "lens",
            Self::Bokeh => "bokeh",
        }
    }
}

/// A preset.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: String,
    /// Its settings.
    pub content: PresetContent,
}

/// The settings of a preset.
#[derive(Clone, Debug, PartialEq)]
pub enum PresetContent {
    /// A brush; its scene-dependent fields (size, symmetry) are ignored.
    Brush(Box<Brush>),
    /// A lens.
    Lens(LensPreset),
    /// An aperture's shape.
    Bokeh(Aperture),
}

impl Preset {
    /// A preset with this name and content.
    ///
    /// # Errors
    /// A sentence for the user, if the name is empty or too long.
    pub fn new(name: &str, content: PresetContent) -> Result<Self, &'static str> {
        let name = name.trim();
        if name.is_empty() {
            return Err("a preset needs a name");
        }
        if name.chars().count() > MAX_NAME_CHARS || name.chars().any(char::is_control) {
            return Err("a preset's name has at most 80 characters, all in one line");
        }
        Ok(Self { name: name.to_string(), content })
    }

    /// What the preset sets: a brush, a lens or a bokeh.
    pub fn kind(&self) -> PresetKind {
        match self.content {
            PresetContent::Brush(_) => PresetKind::Brush,
            PresetContent::Lens(_) => PresetKind::Lens,
            PresetContent::Bokeh(_) => PresetKind::Bokeh,
        }
    }

    /// The brush with this preset applied, or `None` if it is not a brush preset: size and symmetry stay.
    pub fn apply_to_brush(&self, current: &Brush) -> Option<Brush> {
        match &self.content {
            PresetContent::Brush(brush) => Some(brush_preset::apply_to_brush(brush, current)),
            _ => None,
        }
    }

    /// The camera with this preset applied, or `None` if it is a brush preset.
    ///
    /// # Errors
    /// Why the camera cannot have it, as a sentence for the user.
    pub fn apply_to_camera(&self, current: &Camera) -> Option<Result<Camera, String>> {
        match &self.content {
            PresetContent::Brush(_) => None,
            PresetContent::Lens(lens) => Some(lens.apply_to(current).ok_or_else(|| {
                let distance = current.focus_distance;
                format!(
                    "{}: this lens cannot focus as near as {distance} (focus farther away first)",
                    self.name
                )
            })),
            PresetContent::Bokeh(aperture) => {
                Some(Ok(Camera { aperture: aperture.clone(), ..current.clone() }))
            }
        }
    }

    /// Whether `brush` has this preset's settings; false for a lens preset.
    pub fn matches_brush(&self, brush: &Brush) -> bool {
        self.apply_to_brush(brush).is_some_and(|own| own == *brush)
    }

    /// Whether the camera's lens, or its aperture's shape, has this preset's settings, to a millionth.
    pub fn matches_camera(&self, camera: &Camera) -> bool {
        let near = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < 1e-6;
        match &self.content {
            PresetContent::Brush(_) => false,
            PresetContent::Bokeh(aperture) => *aperture == camera.aperture,
            PresetContent::Lens(lens) => {
                let current = LensPreset::from_camera(camera);
                near(current.focal_length, lens.focal_length)
                    && near(current.f_number, lens.f_number)
                    && near(current.sensor_height, lens.sensor_height)
                    && current.character == lens.character
            }
        }
    }

    /// Reads a preset file. The path of an aperture mask is relative to it.
    ///
    /// # Errors
    /// The file cannot be read, is not a preset, or has invalid settings.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        Self::parse(file, &read_text(file)?)
    }

    /// Parses the text of `file`.
    pub(super) fn parse(file: &Path, text: &str) -> Result<Self, ProjectError> {
        let json = Json::parse(file, text)?;
        let fields = Field::root(file, &json).object()?;
        let file_error = |problem: &str, cure: &str| ProjectError::content(file, problem, cure);
        match fields.get("format") {
            Some(format) if format.text().is_ok_and(|text| text == FORMAT) => {}
            _ => {
                return Err(file_error(
                    "is no preset",
                    "give a file that says \"format\": \"focus-brush preset\"",
                ));
            }
        }
        match fields.get("version").map_or(Ok(VERSION), |field| field.whole_number())? {
            version if version > VERSION => {
                let (file, version, newest) = (file.to_owned(), version.into(), VERSION.into());
                return Err(ProjectError::Newer { file, version, newest });
            }
            _ => {}
        }
        fields.allow_only(&["format", "version", "name", "brush", "lens", "bokeh"])?;
        let kinds = PresetKind::ALL.map(PresetKind::name);
        let present: Vec<_> = kinds.into_iter().filter(|name| fields.get(name).is_some()).collect();
        let [kind] = present[..] else {
            return Err(file_error(
                "must have exactly one of brush, lens and bokeh",
                "give one, and only one, of them",
            ));
        };
        let Some(field) = fields.get(kind) else {
            return Err(file_error("is empty", "give brush, lens or bokeh"));
        };
        let content = match kind {
            "brush" => {
                // Parsed a second time, by serde, which checks the fields.
                let value: Value = serde_json::from_str(text).unwrap_or_default();
                let brush = brush_preset::read(file, &value["brush"])?;
                PresetContent::Brush(Box::new(brush))
            }
            "lens" => PresetContent::Lens(LensPreset::read(&field.object()?)?),
            _ => {
                let mask = |name: &str| crate::read_aperture_mask(&named_file(file, name)?, name);
                let aperture = aperture_from_json(&field.object()?, &mask)?;
                aperture.validate().map_err(|error| {
                    let problem = format!("{} cannot be used", error.field);
                    field.error(problem, format!("it must be {}", error.must))
                })?;
                PresetContent::Bokeh(aperture)
            }
        };
        let Some(name) = fields.get("name") else { return Err(file_error("has no name", "add \"name\"")) };
        Self::new(name.text()?, content).map_err(|problem| name.error(problem, "give another name"))
    }

    /// The text of its file.
    pub(super) fn to_text(&self) -> String {
        let content = match &self.content {
            PresetContent::Brush(brush) => brush_preset::to_json(brush),
            PresetContent::Lens(lens) => lens.to_json(),
            PresetContent::Bokeh(aperture) => {
                let mut json = aperture_to_json(aperture);
                if let ApertureShape::Mask(mask) = &aperture.shape {
                    json["mask"] = mask_to_json(mask);
                }
                json
            }
        };
        let mut json = json!({ "format": FORMAT, "version": VERSION, "name": self.name });
        json[self.kind().name()] = content;
        format!("{json:#}\n")
    }

    /// Writes a preset file; a mask is written inline.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), ProjectError> {
        let text = self.to_text();
        write_verified(file, text.as_bytes(), |back| {
            let back = std::str::from_utf8(back).map_err(|error| error.to_string())?;
            Self::parse(file, back).map(|_| ()).map_err(|error| error.to_string())
        })
    }
}
