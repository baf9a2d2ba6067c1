//! KHR_materials_variants: the variants of a file, and the material of a primitive in the chosen one.
//!
//! A file names its variants, and every primitive maps some of them to materials. If the chosen one is not mapped, or
//! none is chosen, the primitive has its own material. Other variants are not read: their defects are reported as
//! warnings (`lint`), and their textures take no memory.

use crate::error::Fault;
use crate::gltf::container::json_object::{Object, as_whole_number};
use crate::gltf::document::Document;

pub(crate) const EXTENSION: &str = "KHR_materials_variants";

/// The variants of a file and the chosen one.
pub(crate) struct Variants {
    /// Their names, in the order of the file, all different.
    pub names: Vec<String>,
    /// Index of the chosen one in `names`.
    selected: Option<usize>,
}

impl Variants {
    /// Reads the names of the variants; `choice` is the name of the chosen one, `None` for the default materials.
    ///
    /// # Errors
    /// The extension is malformed, or there is no variant of this name.
    pub fn read(document: &Document<'_>, choice: Option<&str>) -> Result<Self, Fault> {
        let names = variant_names(document);
        let chosen = match choice {
            None => None,
            Some(choice) => Some(names.iter().position(|name| name == choice).ok_or_else(|| {
                Fault::NoVariant { name: choice.into(), available: describe_available(&names) }
            })?),
        };
        Ok(Self { names, selected: chosen })
    }

    /// The name of the chosen variant; `None` for the default materials.
    pub fn selected_name(&self) -> Option<&str> {
        self.names.get(self.selected?).map(String::as_str)
    }

    /// The material, by its index in the file, that the chosen variant assigns to the primitive at `place`; `None` if
    /// it has its own.
    ///
    /// # Errors
    /// The mappings of the primitive are malformed.
    pub fn material(&self, document: &Document<'_>, place: &str) -> Result<Option<usize>, Fault> {
        let Some(selected) = self.selected else { return Ok(None) };
        let place = format!("{place}/extensions/{EXTENSION}/mappings");
        let Some(mappings) = document.root_value().pointer(&place).and_then(|list| list.as_array()) else {
            return Ok(None);
        };
        document.budget.take_work(mappings.len() as u64, &place)?;
        for (i, mapping) in mappings.iter().enumerate() {
            let variants = mapping.get("variants").and_then(|list| list.as_array());
            let maps_selected = variants.is_some_and(|list| {
                list.iter().any(|variant| as_whole_number(variant) == Some(selected as u64))
            });
            if !maps_selected {
                continue;
            }
            let mapping = Object::new(mapping, format!("{place}/{i}"))?;
            let Some(material) = mapping.index("material")? else {
                return Err(mapping.malformed("material", "is missing"));
            };
            document.entry("materials", material, &format!("{}/material", mapping.place))?;
            return Ok(Some(material));
        }
        Ok(None)
    }
}

/// The names: as in the file, else `variant N`. A duplicate gets its number appended.
fn variant_names(document: &Document<'_>) -> Vec<String> {
    let root = document.root_value().pointer(&format!("/extensions/{EXTENSION}/variants"));
    let list = root.and_then(|list| list.as_array()).map_or(&[][..], Vec::as_slice);
    let mut names = Vec::with_capacity(list.len());
    let mut taken = std::collections::HashSet::new();
    for (i, variant) in list.iter().enumerate() {
        let declared_name =
            variant.get("name").and_then(|name| name.as_str()).filter(|name| !name.is_empty());
        let mut name = declared_name.map_or_else(|| format!("variant {i}"), String::from);
        if taken.contains(&name) {
            document.warn(format!(
                "/extensions/{EXTENSION}/variants/{i}/name: {name:?} is already taken; this variant is called \"{name} ({i})\""
            ));
        }
        while !taken.insert(name.clone()) {
            name = format!("{name} ({i})");
        }
        names.push(name);
    }
    names
}

/// The available names, for a message.
fn describe_available(names: &[String]) -> String {
    /// Further names are only counted.
    const MAX_LISTED: usize = 30;
    if names.is_empty() {
        return format!("the file has no variants: no {EXTENSION}");
    }
    let listed: Vec<String> = names.iter().take(MAX_LISTED).map(|name| format!("{name:?}")).collect();
    let more = names.len().saturating_sub(MAX_LISTED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("there are {}{more}", listed.join(", "))
}
