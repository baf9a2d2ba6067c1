//! Keyframes of the lens in a file of their own, for scripts, in the form that they have in a project.
//!
//! ```text
//! {"focus": [{"seconds": 0, "value": {"distance": 3.0}, "ease": "smooth"},
//!            {"seconds": 1, "value": {"point": {"triangle": 17, "barycentric": [0.2, 0.3]}}}],
//!  "f_number": [{"seconds": 0, "value": 2.8}],
//!  "character": [{"seconds": 0, "value": {"edges": -0.5}}]}
//! ```

use crate::ProjectError;
use crate::disk::{read_text, write_bytes};
use focus::{FocusTarget, KeyedCharacter, Keys, LensMotion};
use serde::Deserialize;
use std::path::Path;

/// The file. Unknown fields are errors.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KeysFile {
    #[serde(default)]
    focus: Keys<FocusTarget>,
    #[serde(default)]
    f_number: Keys<f64>,
    #[serde(default)]
    character: Keys<KeyedCharacter>,
}

/// Reads keyframes of the lens: times in s, focus, f-number, character.
///
/// # Errors
/// The file cannot be read, has another form, or has invalid keys.
pub fn read_keys(file: &Path) -> Result<LensMotion, ProjectError> {
    let cure = "see docs/guide/sequences.md for its form";
    let KeysFile { focus, f_number, character } =
        serde_json::from_str(&read_text(file)?).map_err(|error| {
            ProjectError::content(file, format!("is not a valid file of lens keys: {error}"), cure)
        })?;
    let motion = LensMotion { focus, f_number, character };
    match motion.is_valid() {
        true => Ok(motion),
        false => Err(ProjectError::content(
            file,
            "has keys that cannot be used",
            "times must be finite and ascend, distances and f-numbers be above 0, points lie in their triangles, \
             characters be those of lens files",
        )),
    }
}

/// Writes keyframes of the lens as JSON.
///
/// # Errors
/// The file cannot be written.
pub fn write_keys(file: &Path, motion: &LensMotion) -> Result<(), ProjectError> {
    let error = |source| ProjectError::Write { file: file.to_owned(), source };
    let text = serde_json::to_string_pretty(motion).map_err(|source| error(std::io::Error::other(source)))?;
    write_bytes(file, (text + "\n").as_bytes())
}
