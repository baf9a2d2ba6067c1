//! Files that say how Gaussian splats are shown, and the splats of a project: which file, where it stands, what of it is hidden.
//!
//! ```json
//! {"file": "scan.spz", "translation": [x, y, z], "rotation": [x, y, z, w], "scale": 1, "crop": {"min": [x, y, z], "max": [x, y, z]},
//!  "min_opacity": 0, "max_size": null, "max_distance": null, "hidden": [[first, end], …]}
//! ```
//!
//! All may be missing. Without a file it is about the splats in the scene's own. A path is relative to the folder of the file that names it.

use crate::ProjectError;
use crate::json::{Field, Fields, Json};
use crate::named_file::named_file;
use crate::scene_path::ScenePath;
use glam::{DQuat, DVec3, DVec4};
use scene::{PlacedCloud, SplatCleanup, SplatEdit, SplatTransform};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const FIELDS: [&str; 9] =
    ["file", "translation", "rotation", "scale", "crop", "min_opacity", "max_size", "max_distance", "hidden"];

/// Gaussian splats as a file or a project names them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplatsFile {
    /// The file that is added to a scene of meshes; `None`: the splats of the scene's own file.
    pub file: Option<PathBuf>,
    /// Where they stand, and what of them is hidden.
    pub edit: SplatEdit,
}

impl SplatsFile {
    /// Reads such a file.
    ///
    /// # Errors
    /// The file cannot be read, a field is unknown, or a value is out of range.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        let json = Json::read(file)?;
        Self::from_fields(&Field::root(file, &json).object()?, &|name| named_file(file, name))
    }

    /// Splats as they stand in a scene; `None` if they are those of its file, unedited.
    pub fn of_scene(splats: &PlacedCloud) -> Option<Self> {
        let shown = Self { file: splats.file.clone(), edit: splats.edit.clone() };
        (shown != Self::default()).then_some(shown)
    }

    /// The splats stored in a project at `file`.
    pub(crate) fn from_value(file: &Path, value: &Value) -> Result<Self, ProjectError> {
        let json = Json::parse(file, &value.to_string())?;
        // A project's scan may lie anywhere, as its scene may.
        let folder = file.parent().unwrap_or(Path::new(""));
        let found = |name: &str| {
            let path = ScenePath { path: name.into(), path_bytes: None };
            Ok(path.resolve(file).unwrap_or_else(|| folder.join(name)))
        };
        Self::from_fields(&Field::root(file, &json).object()?, &found)
    }

    fn from_fields(
        fields: &Fields<'_>,
        find_file: &dyn Fn(&str) -> Result<PathBuf, ProjectError>,
    ) -> Result<Self, ProjectError> {
        fields.allow_only(&FIELDS)?;
        let given = |name| fields.get(name).filter(|field| *field.value != Json::Null);
        let mut transform = SplatTransform::default();
        if let Some(field) = given("translation") {
            transform.translation = finite(&field)?;
        }
        if let Some(field) = given("rotation") {
            let quaternion = DVec4::from_array(field.numbers()?);
            let unit = quaternion.try_normalize().filter(|unit| unit.is_finite());
            let unit = unit.ok_or_else(|| field.error("is no rotation", "give a quaternion x, y, z, w"))?;
            transform.rotation = DQuat::from_vec4(unit);
        }
        if let Some(field) = given("scale") {
            transform.scale = positive(&field)?;
        }
        let crop = match given("crop") {
            None => None,
            Some(field) => {
                let corners = field.object()?;
                corners.allow_only(&["min", "max"])?;
                let corner = |name: &'static str| match corners.get(name) {
                    Some(corner) => finite(&corner),
                    None => Err(field.error(format!("has no {name}"), "give min and max: [x, y, z] each")),
                };
                let (low, high) = (corner("min")?, corner("max")?);
                if !low.cmple(high).all() {
                    return Err(field.error("has a min above its max", "give the lower corner as min"));
                }
                Some((low, high))
            }
        };
        let mut cleanup = SplatCleanup::default();
        if let Some(field) = given("min_opacity") {
            cleanup.min_opacity = field.number()?;
            if !(0.0..=1.0).contains(&cleanup.min_opacity) {
                return Err(field.error("is not an opacity", "give a number from 0 to 1"));
            }
        }
        cleanup.max_size = given("max_size").map(|field| positive(&field)).transpose()?;
        cleanup.max_distance = given("max_distance").map(|field| positive(&field)).transpose()?;
        let mut hidden = Vec::new();
        if let Some(field) = given("hidden") {
            for range in field.list()? {
                let [first, end] = range.numbers::<2>()?;
                let is_number = |x: f64| x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
                let follows =
                    hidden.last().is_none_or(|before: &std::ops::Range<u32>| f64::from(before.end) < first);
                if !(is_number(first) && is_number(end) && first < end && follows) {
                    let cure = "give [first, end] in ascending order, whole numbers, with a gap between two";
                    return Err(range.error("is no range of splats", cure));
                }
                hidden.push(first as u32..end as u32);
            }
        }
        let file = match given("file") {
            Some(field) => Some(find_file(field.text()?)?),
            None => None,
        };
        Ok(Self { file, edit: SplatEdit { transform, crop, cleanup, hidden: Arc::new(hidden) } })
    }

    /// As JSON; the path becomes relative to `from`, the file that will contain it.
    pub fn to_json(&self, from: &Path) -> Value {
        let SplatEdit { transform, crop, cleanup, hidden } = &self.edit;
        let mut json = json!({
            "translation": transform.translation.to_array(),
            "rotation": transform.rotation.to_array(),
            "scale": transform.scale,
            "min_opacity": cleanup.min_opacity,
            "max_size": cleanup.max_size,
            "max_distance": cleanup.max_distance,
            "hidden": hidden.iter().map(|range| [range.start, range.end]).collect::<Vec<_>>(),
        });
        if let Some(file) = &self.file {
            json["file"] = json!(ScenePath::new(file, from).path);
        }
        if let Some((low, high)) = crop {
            json["crop"] = json!({"min": low.to_array(), "max": high.to_array()});
        }
        json
    }
}

fn finite(field: &Field<'_>) -> Result<DVec3, ProjectError> {
    let point = DVec3::from_array(field.numbers()?);
    let error = || field.error("is not finite", "give three numbers");
    if point.is_finite() { Ok(point) } else { Err(error()) }
}

fn positive(field: &Field<'_>) -> Result<f64, ProjectError> {
    let number = field.number()?;
    let error = || field.error("is not above 0", "give a positive number");
    if number.is_finite() && number > 0.0 { Ok(number) } else { Err(error()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<SplatsFile, ProjectError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("splats.json");
        std::fs::write(&file, text).unwrap();
        SplatsFile::read(&file)
    }

    #[test]
    fn what_is_written_is_read_again() {
        assert_eq!(read("{}").unwrap(), SplatsFile::default());
        let text = r#"{"translation": [1, 2, 3], "rotation": [0, 3, 0, 3], "scale": 0.5,
            "crop": {"min": [0, -1, 0], "max": [1, 1, 2]}, "min_opacity": 0.1, "max_size": 2, "max_distance": 0.25,
            "hidden": [[0, 3], [5, 6]]}"#;
        let splats = read(text).unwrap();
        assert!(splats.edit.is_valid());
        assert!((splats.edit.transform.rotation * DVec3::X).distance(DVec3::NEG_Z) < 1e-12);
        assert_eq!(*splats.edit.hidden, [0..3, 5..6]);
        let project = Path::new("/a/b/p.fbrush");
        let beside = SplatsFile { file: Some("/a/scans/s.ply".into()), ..splats };
        let json = beside.to_json(project);
        assert_eq!(json["file"], "../scans/s.ply");
        let read = SplatsFile::from_value(project, &json).unwrap();
        let (mut near, close) = (read.clone(), |a: DQuat, b: DQuat| (a - b).length() < 1e-15);
        assert!(close(read.edit.transform.rotation, beside.edit.transform.rotation));
        near.edit.transform.rotation = beside.edit.transform.rotation;
        assert_eq!(near, beside);
    }

    #[test]
    fn what_is_wrong_names_its_field() {
        for (text, field) in [
            (r#"{"translation": [1, 2]}"#, "translation"),
            (r#"{"rotation": [0, 0, 0, 0]}"#, "rotation"),
            (r#"{"scale": 0}"#, "scale"),
            (r#"{"scale": 1e999}"#, "scale"),
            (r#"{"crop": {"min": [0, 0, 0]}}"#, "crop"),
            (r#"{"crop": {"min": [0, 0, 1], "max": [1, 1, 0]}}"#, "crop"),
            (r#"{"min_opacity": 2}"#, "min_opacity"),
            (r#"{"max_size": -1}"#, "max_size"),
            (r#"{"max_distance": "far"}"#, "max_distance"),
            (r#"{"hidden": [[3, 3]]}"#, "hidden"),
            (r#"{"hidden": [[3, 5], [5, 6]]}"#, "hidden"),
            (r#"{"hidden": [[0.5, 5]]}"#, "hidden"),
            (r#"{"file": "../scan.ply"}"#, "scan.ply"),
            (r#"{"moved": 1}"#, "moved"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(field), "{text}: {error}");
        }
    }
}
