//! Recorded strokes as JSON: what was painted as data, to be painted again.
//!
//! ```text
//! {"format": "focus-brush strokes", "version": 1, "strokes": [
//!   {"layer": "Paint", "brush": {…},
//!    "view": {"camera_to_world": [16 numbers, by columns], "yfov": 0.7, "aspect": 1.78},
//!    "points": [[0.5, 0.25, 1.0], …]}]}
//! ```
//!
//! A point is where the pen was in the view it painted in ((0, 0) the upper left corner, (1, 1) the lower right) and
//! how hard it pressed, in [0, 1]. When is not recorded: dabs follow the path, not the clock.

use crate::ProjectError;
use crate::disk::{read_bytes, write_verified};
use focus::Brush;
use glam::{DMat4, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What the file calls its format.
const FORMAT: &str = "focus-brush strokes";

/// The version that is written.
const VERSION: u64 = 1;

/// A perspective view that was painted in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewFrame {
    /// Its pose, glTF axes: looks down −Z, +Y up.
    pub camera_to_world: DMat4,
    /// Full vertical angle of view, rad.
    pub yfov: f64,
    /// Width over height.
    pub aspect: f64,
}

impl ViewFrame {
    /// Where the view looks from, and the world direction of a position in it ((0, 0) upper left, (1, 1) lower
    /// right), of depth 1 along the view's axis.
    pub fn ray(&self, position: DVec2) -> (DVec3, DVec3) {
        let half_height = (self.yfov / 2.0).tan();
        let x = (2.0 * position.x - 1.0) * self.aspect * half_height;
        let y = (1.0 - 2.0 * position.y) * half_height;
        let m = &self.camera_to_world;
        let direction = m.x_axis.truncate() * x + m.y_axis.truncate() * y - m.z_axis.truncate();
        (m.w_axis.truncate(), direction)
    }

    /// Whether it can be looked through.
    pub fn is_valid(&self) -> bool {
        let angle = self.yfov > 0.0 && self.yfov < std::f64::consts::PI;
        angle && self.aspect > 0.0 && self.aspect.is_finite() && self.camera_to_world.is_finite()
    }
}

/// A stroke as it was painted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordedStroke {
    /// The name of the layer that it was painted on.
    pub layer: String,
    /// What it was painted with.
    pub brush: Brush,
    /// The view that it was painted in.
    pub view: ViewFrame,
    /// x, y and pressure.
    pub points: Vec<[f64; 3]>,
}

/// The file.
#[derive(Serialize, Deserialize)]
struct StrokesFile {
    format: String,
    version: u64,
    strokes: Vec<RecordedStroke>,
}

/// Writes strokes.
pub fn write_strokes(file: &Path, strokes: &[RecordedStroke]) -> Result<(), ProjectError> {
    let content = StrokesFile { format: FORMAT.into(), version: VERSION, strokes: strokes.to_vec() };
    let bytes = serde_json::to_vec(&content).map_err(std::io::Error::other);
    let bytes = bytes.map_err(|source| ProjectError::Write { file: file.to_owned(), source })?;
    write_verified(file, &bytes, |back| match parse(file, back) {
        Ok(read) if read == strokes => Ok(()),
        Ok(_) => Err("its content differs".to_string()),
        Err(error) => Err(error.to_string()),
    })
}

/// Reads strokes.
pub fn read_strokes(file: &Path) -> Result<Vec<RecordedStroke>, ProjectError> {
    parse(file, &read_bytes(file)?)
}

fn parse(file: &Path, bytes: &[u8]) -> Result<Vec<RecordedStroke>, ProjectError> {
    let error = |problem: String| ProjectError::content(file, problem, "record the strokes again");
    let content: StrokesFile = serde_json::from_slice(bytes)
        .map_err(|e| error(format!("holds no strokes that can be understood: {e}")))?;
    if content.format != FORMAT {
        return Err(error(format!("holds no strokes but \"{}\"", content.format)));
    }
    if content.version > VERSION {
        let (file, version, newest) = (file.to_owned(), content.version, VERSION);
        return Err(ProjectError::Newer { file, version, newest });
    }
    for (index, stroke) in content.strokes.iter().enumerate() {
        let place = |what: &str| error(format!("stroke {}: {what}", index + 1));
        if let Some(problem) = stroke.brush.problem() {
            return Err(place(&format!("brush: {problem}")));
        }
        if !stroke.view.is_valid() {
            return Err(place("its view cannot be looked through"));
        }
        if !stroke.points.as_flattened().iter().all(|number| number.is_finite()) {
            return Err(place("it has points that are not finite"));
        }
    }
    Ok(content.strokes)
}
