//! From the JSON of a file to the typed document of the `gltf` crate.
//!
//! The crate accepts a file as a whole or not at all, and its typed views panic on an index that does not exist or a
//! keyword that glTF does not define. Here a repaired copy of the JSON is made that it always accepts: with the
//! properties that the picture may need, whole numbers written as such, every index inside its collection. Anything
//! else is left out of the copy, or replaced by a harmless placeholder if the crate requires a value, and recorded as
//! a [`Fault`] at its place: code that needs this place checks [`Faults`] first, and all other code is unaffected.

use crate::error::Fault;
use crate::gltf::budget::Budget;
use crate::gltf::container::attribute_name::AttributeName;
use crate::gltf::container::json_object::as_whole_number;
use crate::gltf::schema::{PropertyKind, ROOT, Spec};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Properties that no picture depends on; they are not copied.
const UNUSED: [&str; 22] = [
    "animations",
    "copyright",
    "glossinessFactor",
    "max",
    "metallicRoughnessTexture",
    "mimeType",
    "min",
    "minFilter",
    "minVersion",
    "normalTexture",
    "occlusionTexture",
    "orthographic",
    "skeleton",
    "specularColorFactor",
    "specularColorTexture",
    "specularGlossinessTexture",
    "specularTexture",
    "target",
    "xmag",
    "ymag",
    "zfar",
    "znear",
];

/// Properties that may fall back to their default.
const DEFAULTS_ALLOWED: [&str; 6] = ["alphaMode", "generator", "magFilter", "name", "wrapS", "wrapT"];

/// The faults of a document, by JSON pointer.
#[derive(Debug, Default)]
pub(crate) struct Faults(BTreeMap<String, String>);

impl Faults {
    fn record(&mut self, place: &str, what: String) {
        self.0.entry(place.into()).or_insert(what);
    }

    /// Checks that there is no fault exactly at `place`, a JSON pointer.
    ///
    /// # Errors
    /// The fault.
    pub fn check_at(&self, place: &str) -> Result<(), Fault> {
        match self.0.get(place) {
            Some(what) => Err(Fault::Malformed { place: place.into(), what: what.clone() }),
            None => Ok(()),
        }
    }

    /// Checks that there is no fault at `place`, a JSON pointer, or below.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_below(&self, place: &str) -> Result<(), Fault> {
        self.check_at(place)?;
        let inner = format!("{place}/");
        match self.0.range(inner.clone()..).next() {
            Some((place, _)) if place.starts_with(&inner) => self.check_at(place),
            _ => Ok(()),
        }
    }
}

/// The typed document, and the faults that were left out of it. Every index in it exists, unless there is a fault at
/// its place. Memory beyond twice the size of the JSON is taken from `budget`.
pub(crate) fn repair_document(root: &Value, budget: &Budget) -> Result<(gltf::Document, Faults), Fault> {
    let mut repair = Repair { root, budget, faults: Faults::default(), stop: None };
    let (repaired, _) = repair.object(root, &ROOT, "");
    if let Some(stop) = repair.stop {
        return Err(stop);
    }
    let root = serde_json::from_value(Value::Object(repaired))
        .map_err(|error| Fault::NotGltf(format!("its JSON is invalid: {error}")))?;
    Ok((gltf::Document::from_json_without_validation(root), repair.faults))
}

/// Number of entries of a collection of the document.
pub(crate) fn len(root: &Value, collection: &str) -> usize {
    let list = match collection {
        "lights" => root.pointer("/extensions/KHR_lights_punctual/lights"),
        "variants" => root.pointer("/extensions/KHR_materials_variants/variants"),
        _ => root.get(collection),
    };
    list.and_then(Value::as_array).map_or(0, Vec::len)
}

struct Repair<'a> {
    root: &'a Value,
    budget: &'a Budget,
    faults: Faults,
    /// Set when the budget is used up.
    stop: Option<Fault>,
}

/// What is wrong with a property; `None` if it is already recorded further inside.
type DefectMessage = Option<String>;

fn defect<T>(what: impl Into<String>) -> Result<T, DefectMessage> {
    Err(Some(what.into()))
}

impl Repair<'_> {
    /// Repairs an object; returns whether it has all that it requires.
    fn object(&mut self, value: &Value, spec: &Spec, place: &str) -> (Map<String, Value>, bool) {
        /// The placeholder of an object takes more than the number or text that the file has instead.
        const PLACEHOLDER_BYTES: u64 = 3000;
        let none = Map::new();
        let map = value.as_object().unwrap_or_else(|| {
            self.faults.record(place, "is not an object".into());
            self.stop = self
                .stop
                .take()
                .or(self.budget.take_memory(PLACEHOLDER_BYTES, "what is wrong with it").err());
            &none
        });
        let (mut repaired, mut is_complete) = (Map::new(), true);
        let required = spec.required.iter().map(|property| (true, property));
        for (required, (key, kind)) in required.chain(spec.optional.iter().map(|property| (false, property)))
        {
            let value = map.get(*key).filter(|value| !value.is_null());
            let result = match value {
                _ if !required && UNUSED.contains(key) => continue,
                Some(value) => self.property(value, kind, &format!("{place}/{key}")),
                None if !required && !spec.filled.contains(key) => continue,
                // A missing list is as good as an empty one.
                None if !required || matches!(kind, PropertyKind::List(_)) => Err(None),
                None => defect("is missing"),
            };
            let value = match result {
                Ok(value) => Some(value),
                Err(what) => {
                    if let Some(what) =
                        what.filter(|_| !UNUSED.contains(key) && !DEFAULTS_ALLOWED.contains(key))
                    {
                        self.faults.record(&format!("{place}/{key}"), what);
                    }
                    is_complete &=
                        !(required && matches!(kind, PropertyKind::Index(_) | PropertyKind::Object(_)));
                    (required || spec.filled.contains(key)).then(|| placeholder(kind))
                }
            };
            if let Some(value) = value {
                repaired.insert((*key).into(), value);
            }
        }
        if let Some(extensions) = map.get("extensions").filter(|value| !value.is_null()) {
            let extensions = self.extensions(extensions, spec, &format!("{place}/extensions"));
            repaired.insert("extensions".into(), Value::Object(extensions));
        }
        (repaired, is_complete)
    }

    /// The supported extensions of an object.
    fn extensions(&mut self, value: &Value, spec: &Spec, place: &str) -> Map<String, Value> {
        let mut repaired = Map::new();
        let Some(map) = value.as_object() else {
            self.faults.record(place, "is not an object".into());
            return repaired;
        };
        for (name, spec) in spec.extensions {
            if let Some(value) = map.get(*name).filter(|value| !value.is_null())
                && let (extension, true) = self.object(value, spec, &format!("{place}/{name}"))
            {
                repaired.insert((*name).into(), Value::Object(extension));
            }
        }
        repaired
    }

    fn property(&mut self, value: &Value, kind: &PropertyKind, place: &str) -> Result<Value, DefectMessage> {
        match kind {
            PropertyKind::Flag if !value.is_boolean() => defect("is not true or false"),
            PropertyKind::Text if !value.is_string() => defect("is not a text"),
            PropertyKind::Number(..) | PropertyKind::Above(_) if !value.is_number() => {
                defect("is not a number")
            }
            PropertyKind::Flag | PropertyKind::Text | PropertyKind::Number(..) | PropertyKind::Above(_) => {
                Ok(value.clone())
            }
            PropertyKind::Integer(_, most) => match as_whole_number(value) {
                Some(number) if number > *most => defect(format!("{number} is too large")),
                number => whole_number(number),
            },
            PropertyKind::MultipleOf4(..) => whole_number(as_whole_number(value)),
            PropertyKind::Code(codes) => match as_whole_number(value) {
                Some(code) if !codes.contains(&code) => defect(format!("{code} is unknown")),
                code => whole_number(code),
            },
            PropertyKind::Word(words) => match value.as_str() {
                Some(word) if words.contains(&word) => Ok(value.clone()),
                Some(word) => defect(format!("{:?} is unknown", word.chars().take(40).collect::<String>())),
                None => defect("is not a text"),
            },
            PropertyKind::Numbers(least, most, ..) => match value.as_array() {
                Some(list) if !list.iter().all(Value::is_number) => defect("is not an array of numbers"),
                Some(list) if *most < usize::MAX && !(*least..=*most).contains(&list.len()) => {
                    defect(format!("is not an array of {least} numbers"))
                }
                Some(_) => Ok(value.clone()),
                None => defect("is not an array of numbers"),
            },
            PropertyKind::Index(collection) => self.index(value, collection),
            PropertyKind::Indices(collection) => {
                let item = |repair: &mut Self, item: &Value, place: &str| {
                    repair.index(item, collection).map_err(|what| repair.record(place, what)).ok()
                };
                self.list(value, place, item)
            }
            PropertyKind::Texts => {
                self.list(value, place, |_, text, _| text.is_string().then(|| text.clone()))
            }
            PropertyKind::Object(spec) => match self.object(value, spec, place) {
                (object, true) => Ok(Value::Object(object)),
                (_, false) => Err(None),
            },
            PropertyKind::List(spec) => self.list(value, place, |repair, item, place| {
                Some(Value::Object(repair.object(item, spec, place).0))
            }),
            PropertyKind::Accessors => self.accessors(value, place, |_| true),
            PropertyKind::Attributes => {
                self.accessors(value, place, |name| AttributeName::parse(name).is_some())
            }
            PropertyKind::Targets => self.list(value, place, |repair, target, place| {
                let is_attribute = |name: &str| AttributeName::parse(name).is_some();
                let repaired = repair.accessors(target, place, is_attribute);
                Some(repaired.unwrap_or_else(|what| {
                    repair.record(place, what);
                    json!({})
                }))
            }),
        }
    }

    fn record(&mut self, place: &str, what: DefectMessage) {
        if let Some(what) = what {
            self.faults.record(place, what);
        }
    }

    fn index(&self, value: &Value, collection: &str) -> Result<Value, DefectMessage> {
        match as_whole_number(value) {
            Some(index) if index >= len(self.root, collection) as u64 => {
                defect(format!("refers to {collection}[{index}], which does not exist"))
            }
            index => whole_number(index),
        }
    }

    /// A list without the entries for which `item` returns `None`.
    fn list(
        &mut self,
        value: &Value,
        place: &str,
        item: impl Fn(&mut Self, &Value, &str) -> Option<Value>,
    ) -> Result<Value, DefectMessage> {
        let Some(list) = value.as_array() else { return defect("is not an array") };
        let items = list.iter().enumerate();
        let repaired = items.filter_map(|(i, value)| match self.stop {
            None => item(self, value, &format!("{place}/{i}")),
            Some(_) => None,
        });
        Ok(repaired.collect())
    }

    /// Accessors by name, for the accepted names.
    fn accessors(
        &mut self,
        value: &Value,
        place: &str,
        is_accepted: impl Fn(&str) -> bool,
    ) -> Result<Value, DefectMessage> {
        let Some(map) = value.as_object() else { return defect("is not an object") };
        let mut repaired = Map::new();
        for (name, value) in map.iter().filter(|(name, value)| is_accepted(name) && !value.is_null()) {
            match self.index(value, "accessors") {
                Ok(index) => drop(repaired.insert(name.clone(), index)),
                Err(what) => self.record(&format!("{place}/{name}"), what),
            }
        }
        Ok(Value::Object(repaired))
    }
}

fn whole_number(number: Option<u64>) -> Result<Value, DefectMessage> {
    number.map_or_else(|| defect("is not a whole number"), |number| Ok(number.into()))
}

/// The placeholder of a property that is missing or wrong.
fn placeholder(kind: &PropertyKind) -> Value {
    match kind {
        PropertyKind::Flag => false.into(),
        PropertyKind::Text => "".into(),
        PropertyKind::Number(..)
        | PropertyKind::Above(_)
        | PropertyKind::Integer(..)
        | PropertyKind::MultipleOf4(..) => 0.into(),
        PropertyKind::Code(codes) => codes[0].into(),
        PropertyKind::Word(words) => words[0].into(),
        // Beyond every collection.
        PropertyKind::Index(_) => u32::MAX.into(),
        PropertyKind::Numbers(..)
        | PropertyKind::Indices(_)
        | PropertyKind::Texts
        | PropertyKind::List(_)
        | PropertyKind::Targets => json!([]),
        PropertyKind::Object(_) | PropertyKind::Accessors | PropertyKind::Attributes => json!({}),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadOptions;

    fn typed(root: &Value) -> Result<(gltf::Document, Faults), Fault> {
        super::repair_document(
            root,
            &Budget::new(&LoadOptions { max_memory: 1 << 20, ..LoadOptions::default() }),
        )
    }

    #[test]
    fn placeholders_are_counted_in_the_budget() {
        let nodes = |count| json!({"asset": {"version": "2.0"}, "nodes": vec![0; count]});
        assert_eq!(typed(&nodes(300)).unwrap().0.nodes().count(), 300);
        assert!(typed(&nodes(400)).is_err_and(|fault| fault.to_string().contains("raise the limit")));
    }

    #[test]
    fn whole_numbers_may_be_floats() {
        let (typed, faults) = typed(&json!({"asset": {"version": "2.0"}, "scene": 0.0, "scenes": [{}],
            "accessors": [{"componentType": 5126.0, "type": "VEC3", "count": 3.0}]}))
        .unwrap();
        assert_eq!(typed.accessors().next().map(|accessor| accessor.count()), Some(3));
        assert_eq!(typed.default_scene().map(|scene| scene.nodes().count()), Some(0));
        assert!(faults.check_below("").is_ok());
    }

    #[test]
    fn faults_stay_where_they_are() {
        let (typed, faults) = typed(&json!({"asset": {"version": "2.0"},
            "nodes": [{"mesh": 4_294_967_296u64, "children": [1, 7]}, {"name": 3, "camera": "x"}, null],
            "bufferViews": [{"byteLength": 4}], "accessors": [{"sparse": {"count": 1}}],
            "materials": [{"alphaMode": "GLASS", "normalTexture": 3, "emissiveTexture": {"index": 0}}],
            "meshes": [{}, {"primitives": [{"attributes": {"TEXCOORD_01": 0, "POSITION": 0}}]}]}))
        .unwrap();
        let node = typed.nodes().next().unwrap();
        assert!(node.mesh().is_none());
        assert_eq!(node.children().map(|child| child.index()).collect::<Vec<_>>(), [1]);
        assert!(typed.materials().next().unwrap().emissive_texture().is_none());
        assert_eq!(typed.meshes().nth(1).unwrap().primitives().next().unwrap().attributes().len(), 1);
        for (place, what) in [
            ("/nodes/0/mesh", "refers to meshes[4294967296], which does not exist"),
            ("/nodes/0/children/1", "refers to nodes[7], which does not exist"),
            ("/nodes/1/camera", "is not a whole number"),
            ("/nodes/2", "is not an object"),
            ("/bufferViews/0/buffer", "is missing"),
            ("/accessors/0/count", "is missing"),
            ("/accessors/0/sparse/values", "is missing"),
            ("/materials/0/emissiveTexture/index", "refers to textures[0], which does not exist"),
        ] {
            assert!(faults.check_at(place).unwrap_err().to_string().contains(what), "{place}: {faults:?}");
        }
        assert!(faults.check_below("/nodes/0").is_err() && faults.check_at("/nodes/0").is_ok());
        for place in ["/materials/0/alphaMode", "/materials/0/normalTexture", "/nodes/1/name", "/meshes"] {
            assert!(faults.check_below(place).is_ok(), "{place}: {faults:?}");
        }
    }
}
