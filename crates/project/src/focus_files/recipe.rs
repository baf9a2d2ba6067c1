//! Focus recipes as JSON.
//!
//! ```text
//! {"default": {"t": 1, "anchor": 0}, "background": {…}, "materials": {NAME: {…}}, "nodes": {NAME: {…}}}
//! ```
//!
//! An entry is `{"t": x, "anchor": a, "gloss": g}` (defaults: t 1, anchor and gloss 0) or `{"map": FILE}`, a path
//! relative to the recipe, in the mesh's first UV set.

use crate::disk::extension;
use crate::json::{Field, Fields, Json};
use crate::named_file::named_file;
use crate::{FocusMapFile, ProjectError};
use focus::{FocusRecipe, RecipeEntry};
use lens::FocusOffset;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maps read so far, by path: a recipe may name one many times.
type MapCache = HashMap<PathBuf, RecipeEntry>;

/// Reads a recipe and the maps that it names.
///
/// # Errors
/// A file cannot be read, a field is unknown, or a value is out of range.
pub fn read_recipe(file: &Path) -> Result<FocusRecipe, ProjectError> {
    let json = Json::read(file)?;
    let fields = Field::root(file, &json).object()?;
    fields.allow_only(&["default", "background", "materials", "nodes"])?;
    let mut maps = MapCache::new();
    let default = match fields.get("default") {
        Some(field) => read_entry(&field, &mut maps)?,
        None => RecipeEntry::Value(FocusOffset::STANDARD),
    };
    let background = fields.get("background").map(|field| read_entry(&field, &mut maps)).transpose()?;
    let materials = read_named_entries(&fields, "materials", &mut maps)?;
    let nodes = read_named_entries(&fields, "nodes", &mut maps)?;
    Ok(FocusRecipe { default, background, materials, nodes })
}

fn read_named_entries(
    fields: &Fields<'_>,
    name: &str,
    maps: &mut MapCache,
) -> Result<Vec<(String, RecipeEntry)>, ProjectError> {
    let Some(field) = fields.get(name) else { return Ok(Vec::new()) };
    let object = field.object()?;
    object.iter().map(|(name, field)| Ok((name.to_string(), read_entry(&field, maps)?))).collect()
}

fn read_entry(field: &Field<'_>, maps: &mut MapCache) -> Result<RecipeEntry, ProjectError> {
    let fields = field.object()?;
    fields.allow_only(&["t", "anchor", "gloss", "map"])?;
    let Some(map) = fields.get("map") else {
        let t = fields.get("t").map_or(Ok(1.0), |field| field.number())?;
        let share = |name| {
            let Some(field) = fields.get(name) else { return Ok(0.0) };
            let share = field.number()?;
            match (0.0..=1.0).contains(&share) {
                true => Ok(share),
                false => Err(field.error(format!("is {share}"), "give a number in [0, 1]")),
            }
        };
        return Ok(RecipeEntry::Value(FocusOffset { t, anchor: share("anchor")?, gloss: share("gloss")? }));
    };
    if ["t", "anchor", "gloss"].iter().any(|name| fields.get(name).is_some()) {
        return Err(field.error("has a map and a value", "give either map, or t, anchor and gloss"));
    }
    let path = named_file(fields.file(), map.text()?)?;
    if let Some(entry) = maps.get(&path) {
        return Ok(entry.clone());
    }
    let read = FocusMapFile::read(&path)?;
    if read.atlas_hash.is_some() {
        return Err(map.error(
            format!("{} belongs to an atlas", path.display()),
            "a recipe's maps lie in the mesh's UVs: give this one in place of the recipe",
        ));
    }
    let entry = RecipeEntry::Map(Arc::new(read.image));
    maps.insert(path, entry.clone());
    Ok(entry)
}

/// A focus given by the user: a recipe or a map.
#[derive(Clone, Debug, PartialEq)]
pub enum FocusFile {
    /// A recipe.
    Recipe(FocusRecipe),
    /// A map: over an atlas if it has an atlas hash, else in the mesh's first UV set.
    Map(FocusMapFile),
}

/// Reads a recipe (.json) or a focus map (.exr, .png).
///
/// # Errors
/// The extension is another, or the file cannot be read or used.
pub fn read_focus(file: &Path) -> Result<FocusFile, ProjectError> {
    match extension(file).as_str() {
        "json" => Ok(FocusFile::Recipe(read_recipe(file)?)),
        "exr" | "png" => Ok(FocusFile::Map(FocusMapFile::read(file)?)),
        _ => Err(ProjectError::content(
            file,
            "is not a focus: unknown extension",
            "give a recipe .json, or a focus map .exr or .png",
        )),
    }
}
