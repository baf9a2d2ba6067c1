//! Which UV set of a mesh the atlas becomes.
//!
//! The second one, `TEXCOORD_1`, or the next that no primitive has and no material reads. glTF numbers sets without
//! gaps: a set missing below becomes the atlas as well, or zeros if a material reads it, which is how a missing set
//! is read.

use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// The lowest set that the atlas may become.
const FIRST_CANDIDATE: u64 = 1;

/// The name of a set among a primitive's attributes.
pub(crate) fn attribute_name(set: u64) -> String {
    format!("TEXCOORD_{set}")
}

/// The set of the atlas for a mesh with these primitives.
pub(crate) fn atlas_set<'a>(primitives: impl Iterator<Item = &'a Value> + Clone, materials: &[Value]) -> u64 {
    let is_free = |set: &u64| {
        primitives.clone().all(|primitive| {
            let attributes = primitive.get("attributes").and_then(Value::as_object);
            let has = attributes.is_some_and(|attributes| attributes.contains_key(&attribute_name(*set)));
            !has && !sets_read(primitive, materials).contains(set)
        })
    };
    (FIRST_CANDIDATE..).find(is_free).unwrap_or(FIRST_CANDIDATE)
}

/// The sets that the textures of a primitive are sampled in: of its material, of its materials in other variants, and
/// of its own extensions.
pub(crate) fn sets_read(primitive: &Value, materials: &[Value]) -> BTreeSet<u64> {
    let mut users = vec![primitive.get("material")];
    let extensions = primitive.get("extensions");
    visit_values(extensions, "", &mut |key, value| {
        if key == "material" {
            users.push(Some(value));
        }
    });
    let index = |value: Option<&Value>| value.and_then(Value::as_u64).map(|index| index as usize);
    let read = users.into_iter().filter_map(|user| materials.get(index(user)?));
    let mut sets = BTreeSet::new();
    for value in read.chain(extensions) {
        visit_values(Some(value), "", &mut |key, value| {
            if key == "texCoord" {
                sets.extend(value.as_u64());
            } else if key.to_ascii_lowercase().ends_with("texture") && value.get("texCoord").is_none() {
                sets.insert(0);
            }
        });
    }
    sets
}

/// Visits every member of every object inside.
fn visit_values<'a>(value: Option<&'a Value>, key: &'a str, visit: &mut impl FnMut(&'a str, &'a Value)) {
    let Some(value) = value else { return };
    visit(key, value);
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(key, value)| visit_values(Some(value), key, visit))
        }
        Value::Array(list) => list.iter().for_each(|value| visit_values(Some(value), "", visit)),
        _ => {}
    }
}

/// Adds the atlas as `set` to the attributes of a primitive, and the missing sets below it.
pub(crate) fn insert_atlas_set(
    attributes: &mut Map<String, Value>,
    set: u64,
    read: &BTreeSet<u64>,
    atlas: usize,
    zeros: impl FnOnce() -> usize,
) {
    attributes.insert(attribute_name(set), atlas.into());
    let is_missing = |set: &u64| !attributes.contains_key(&attribute_name(*set));
    let missing: Vec<u64> = (0..set).filter(is_missing).collect();
    let zeros = missing.iter().any(|set| read.contains(set)).then(zeros);
    for set in missing {
        let accessor = zeros.filter(|_| read.contains(&set)).unwrap_or(atlas);
        attributes.insert(attribute_name(set), accessor.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn primitive(sets: &[u64], material: Option<usize>) -> Value {
        let attributes: Map<_, _> = sets.iter().map(|&set| (attribute_name(set), json!(9))).collect();
        json!({ "attributes": attributes, "material": material })
    }

    #[test]
    fn the_atlas_is_the_first_set_that_nobody_has_or_reads() {
        let materials = [
            json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
            json!({ "normalTexture": { "index": 0, "texCoord": 1 } }),
            json!({ "extensions": { "KHR_x": { "sheenTexture": { "index": 0, "extensions":
                { "KHR_texture_transform": { "texCoord": 2 } } } } } }),
        ];
        let set = |primitives: &[Value]| atlas_set(primitives.iter(), &materials);
        assert_eq!(set(&[primitive(&[], None)]), 1);
        assert_eq!(set(&[primitive(&[0], Some(0))]), 1);
        assert_eq!(set(&[primitive(&[0, 1], Some(0))]), 2);
        assert_eq!(set(&[primitive(&[0], Some(0)), primitive(&[0, 1, 2], None)]), 3);
        assert_eq!(set(&[primitive(&[0], Some(1))]), 2, "set 1 is read, although it is not there");
        assert_eq!(set(&[primitive(&[0, 1], Some(2))]), 3);
        let mut varied = primitive(&[0], Some(0));
        varied["extensions"] = json!({ "KHR_materials_variants": { "mappings": [{ "material": 1 }] } });
        assert_eq!(set(&[varied]), 2);
    }

    #[test]
    fn sets_have_no_gaps_and_what_is_read_stays_zero() {
        let filled = |sets: &[u64], read: &[u64]| {
            let mut attributes = primitive(sets, None)["attributes"].as_object().unwrap().clone();
            insert_atlas_set(&mut attributes, 2, &read.iter().copied().collect(), 5, || 6);
            [0, 1, 2].map(|set| attributes[&attribute_name(set)].as_u64().unwrap())
        };
        assert_eq!(filled(&[0, 1], &[0]), [9, 9, 5]);
        assert_eq!(filled(&[], &[]), [5, 5, 5]);
        assert_eq!(filled(&[0], &[1]), [9, 6, 5]);
    }
}
