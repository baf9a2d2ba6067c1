//! Focus by name, as scripts and render farms give it.

use crate::{Focus, FocusError, FocusImage, FocusSource};
use lens::FocusOffset;
use scene::{Material, Scene, Wrap};
use std::sync::Arc;

/// One entry of a recipe.
#[derive(Clone, Debug, PartialEq)]
pub enum RecipeEntry {
    /// One value.
    Value(FocusOffset),
    /// A map in the first UV set.
    Map(Arc<FocusImage>),
}

/// The focus of a scene by the names of its materials and nodes. Nodes take precedence over materials, materials over
/// the default; of two entries of one kind the later one counts.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusRecipe {
    /// For everything that no other entry names.
    pub default: RecipeEntry,
    /// For the background; `None` takes the default's value (the standard lens if that is a map).
    pub background: Option<RecipeEntry>,
    /// By material name.
    pub materials: Vec<(String, RecipeEntry)>,
    /// By node name.
    pub nodes: Vec<(String, RecipeEntry)>,
}

impl Default for FocusRecipe {
    /// The standard lens everywhere.
    fn default() -> Self {
        Self {
            default: RecipeEntry::Value(FocusOffset::STANDARD),
            background: None,
            materials: Vec::new(),
            nodes: Vec::new(),
        }
    }
}

impl FocusRecipe {
    /// A recipe that gives everything the same focus.
    pub fn constant(value: FocusOffset) -> Self {
        Self { default: RecipeEntry::Value(value), ..Self::default() }
    }

    /// The focus of every part of `scene` and of its background.
    ///
    /// # Errors
    /// A name that does not occur in the scene, a map on a part without texture coordinates or on the background, a
    /// value that is not valid.
    pub fn evaluate(&self, scene: &Arc<Scene>) -> Result<Focus, FocusError> {
        let material_names = || scene.materials.iter().map(|m| m.name.as_str());
        let node_names = || scene.nodes.iter().map(|n| n.name.as_str());
        require_names("material", &self.materials, material_names)?;
        require_names("node", &self.nodes, node_names)?;

        let source_of_part = |part: &scene::Part| {
            let material = &scene.materials[part.material as usize];
            let node = &scene.nodes[part.node as usize].name;
            let by_node = self.nodes.iter().rev().find(|(name, _)| name == node);
            let by_material = || self.materials.iter().rev().find(|(name, _)| *name == material.name);
            let (entry, label) = match (by_node, by_material()) {
                (Some((name, entry)), _) => (entry, format!("nodes \"{name}\"")),
                (None, Some((name, entry))) => (entry, format!("materials \"{name}\"")),
                (None, None) => (&self.default, "default".to_string()),
            };
            match entry {
                RecipeEntry::Value(value) if value.is_valid() => Ok(FocusSource::Constant(*value)),
                RecipeEntry::Value(_) => Err(FocusError::BadValue { entry: label }),
                RecipeEntry::Map(image) if part.has_uv[0] => {
                    Ok(FocusSource::Uv { image: image.clone(), wrap: material_wrap(material) })
                }
                RecipeEntry::Map(_) => Err(FocusError::NoTextureCoordinates {
                    entry: label,
                    part: format!("node \"{node}\" with material \"{}\"", material.name),
                }),
            }
        };
        let parts = scene.parts.iter().map(source_of_part).collect::<Result<_, _>>()?;
        Ok(Focus { scene: scene.clone(), parts, background: self.background_value()? })
    }

    fn background_value(&self) -> Result<FocusOffset, FocusError> {
        match (&self.background, &self.default) {
            (Some(RecipeEntry::Map(_)), _) => Err(FocusError::BackgroundMap),
            (Some(RecipeEntry::Value(value)), _) | (None, RecipeEntry::Value(value)) if value.is_valid() => {
                Ok(*value)
            }
            (None, RecipeEntry::Map(_)) => Ok(FocusOffset::STANDARD),
            _ => Err(FocusError::BadValue { entry: "background".to_string() }),
        }
    }
}

/// The wrap mode of the texture that gives the material its colour: the base colour, or emission if the base is
/// black. Without a texture it repeats.
fn material_wrap(material: &Material) -> [Wrap; 2] {
    let black = material.base_color.truncate() == glam::Vec3::ZERO;
    let (first, second) = (material.base_color_texture, material.emissive_texture);
    let texture = if black { second.or(first) } else { first.or(second) };
    texture.map_or_else(Default::default, |texture| texture.wrap)
}

/// An error for the first entry whose name does not occur in the scene.
fn require_names<'a, Names: Iterator<Item = &'a str>>(
    kind: &'static str,
    entries: &[(String, RecipeEntry)],
    names: impl Fn() -> Names,
) -> Result<(), FocusError> {
    match entries.iter().find(|(name, _)| !names().any(|n| n == name)) {
        None => Ok(()),
        Some((name, _)) => Err(FocusError::UnknownName {
            kind,
            name: name.clone(),
            hint: suggest_names(kind, name, names()),
        }),
    }
}

/// The names most similar to a mistyped one or, if none is similar, some of the existing names.
fn suggest_names<'a>(kind: &str, unknown_name: &str, names: impl Iterator<Item = &'a str>) -> String {
    /// Maximum number of names listed.
    const LISTED: usize = 5;
    let lower = unknown_name.to_lowercase();
    let mut ranked: Vec<(usize, &str)> = names
        .map(|name| {
            let candidate = name.to_lowercase();
            let contains = candidate.contains(&lower) || lower.contains(&candidate);
            (if contains { 1 } else { edit_distance(&lower, &candidate) }, name)
        })
        .collect();
    ranked.sort();
    ranked.dedup();
    if ranked.is_empty() {
        return format!("the scene has no {kind}");
    }
    let largest_typo = 1 + unknown_name.chars().count() / 3;
    let near = ranked.iter().filter(|(distance, _)| *distance <= largest_typo);
    let near: Vec<_> = near.take(LISTED).map(|(_, name)| format!("\"{name}\"")).collect();
    if !near.is_empty() {
        return format!("did you mean {}?", near.join(" or "));
    }
    ranked.sort_by_key(|(_, name)| *name);
    let listed: Vec<_> = ranked.iter().take(LISTED).map(|(_, name)| format!("\"{name}\"")).collect();
    let more =
        if ranked.len() > LISTED { format!(" and {} more", ranked.len() - LISTED) } else { String::new() };
    format!("there are {}{more}", listed.join(", "))
}

/// Levenshtein distance: the number of insertions, deletions and replacements that turn one word into the other.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
