//! From the JSON of a file to the typed document of the `gltf` crate.
//!
//! The crate takes a file as a whole or not at all, and its typed views panic on an index that does not exist or
//! a word that glTF does not know. Here a copy of the JSON is made that it can always take: with the properties
//! that the picture may need, whole numbers written as such, every index inside its collection. What does not fit
//! is left out of the copy, or stands in with a harmless value where the crate requires one, and is noted as a
//! [`Fault`] at its place: whoever needs that place asks [`Faults`] first, and nobody else is bothered.

use crate::attribute_name::AttributeName;
use crate::budget::Budget;
use crate::error::Fault;
use crate::json_object::integer;
use crate::schema::{Kind, ROOT, Spec};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Properties that no picture depends on, so that they are not copied.
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

/// Properties whose default does as well.
const DEFAULTED: [&str; 6] = ["alphaMode", "generator", "magFilter", "name", "wrapS", "wrapT"];

/// What is wrong with a document, by JSON pointer.
#[derive(Debug, Default)]
pub(crate) struct Faults(BTreeMap<String, String>);

impl Faults {
    fn note(&mut self, place: &str, what: String) {
        self.0.entry(place.into()).or_insert(what);
    }

    /// An error if something is wrong exactly at `place`.
    pub fn at(&self, place: &str) -> Result<(), Fault> {
        match self.0.get(place) {
            Some(what) => Err(Fault::Malformed { place: place.into(), what: what.clone() }),
            None => Ok(()),
        }
    }

    /// An error if something is wrong at `place` or below.
    pub fn below(&self, place: &str) -> Result<(), Fault> {
        self.at(place)?;
        let inner = format!("{place}/");
        match self.0.range(inner.clone()..).next() {
            Some((place, _)) if place.starts_with(&inner) => self.at(place),
            _ => Ok(()),
        }
    }
}

/// The typed document and what had to be left out of it. Every index in it exists, unless there is a fault at its
/// place. What it takes beyond twice the size of the JSON comes from `budget`.
pub(crate) fn typed(root: &Value, budget: &Budget) -> Result<(gltf::Document, Faults), Fault> {
    let mut mending = Mending { root, budget, faults: Faults::default(), stop: None };
    let (mended, _) = mending.object(root, &ROOT, "");
    if let Some(stop) = mending.stop {
        return Err(stop);
    }
    let root = serde_json::from_value(Value::Object(mended))
        .map_err(|error| Fault::NotGltf(format!("its JSON is invalid: {error}")))?;
    Ok((gltf::Document::from_json_without_validation(root), mending.faults))
}

/// How many entries a collection of the document has.
pub(crate) fn len(root: &Value, collection: &str) -> usize {
    let list = match collection {
        "lights" => root.pointer("/extensions/KHR_lights_punctual/lights"),
        "variants" => root.pointer("/extensions/KHR_materials_variants/variants"),
        _ => root.get(collection),
    };
    list.and_then(Value::as_array).map_or(0, Vec::len)
}

struct Mending<'a> {
    root: &'a Value,
    budget: &'a Budget,
    faults: Faults,
    /// The budget is used up.
    stop: Option<Fault>,
}

/// What is wrong with a property; nothing if it is noted already, further inside.
type Wrong = Option<String>;

fn wrong<T>(what: impl Into<String>) -> Result<T, Wrong> {
    Err(Some(what.into()))
}

impl Mending<'_> {
    /// An object, and whether it has all that it cannot do without.
    fn object(&mut self, value: &Value, spec: &Spec, place: &str) -> (Map<String, Value>, bool) {
        /// What stands in for an object takes more than the number or text that the file has in its place.
        const STAND_IN: u64 = 3000;
        let none = Map::new();
        let map = value.as_object().unwrap_or_else(|| {
            self.faults.note(place, "is not an object".into());
            self.stop = self.stop.take().or(self.budget.memory(STAND_IN, "what is wrong with it").err());
            &none
        });
        let (mut mended, mut whole) = (Map::new(), true);
        let required = spec.required.iter().map(|property| (true, property));
        for (required, (key, kind)) in required.chain(spec.optional.iter().map(|property| (false, property)))
        {
            let value = map.get(*key).filter(|value| !value.is_null());
            let result = match value {
                _ if !required && UNUSED.contains(key) => continue,
                Some(value) => self.property(value, kind, &format!("{place}/{key}")),
                None if !required && !spec.filled.contains(key) => continue,
                // A list that is missing is as good as an empty one.
                None if !required || matches!(kind, Kind::List(_)) => Err(None),
                None => wrong("is missing"),
            };
            let value = match result {
                Ok(value) => Some(value),
                Err(what) => {
                    if let Some(what) = what.filter(|_| !UNUSED.contains(key) && !DEFAULTED.contains(key)) {
                        self.faults.note(&format!("{place}/{key}"), what);
                    }
                    whole &= !(required && matches!(kind, Kind::Index(_) | Kind::Object(_)));
                    (required || spec.filled.contains(key)).then(|| stand_in(kind))
                }
            };
            if let Some(value) = value {
                mended.insert((*key).into(), value);
            }
        }
        if let Some(extensions) = map.get("extensions").filter(|value| !value.is_null()) {
            let extensions = self.extensions(extensions, spec, &format!("{place}/extensions"));
            mended.insert("extensions".into(), Value::Object(extensions));
        }
        (mended, whole)
    }

    /// The extensions that are known here.
    fn extensions(&mut self, value: &Value, spec: &Spec, place: &str) -> Map<String, Value> {
        let mut mended = Map::new();
        let Some(map) = value.as_object() else {
            self.faults.note(place, "is not an object".into());
            return mended;
        };
        for (name, spec) in spec.extensions {
            if let Some(value) = map.get(*name).filter(|value| !value.is_null())
                && let (extension, true) = self.object(value, spec, &format!("{place}/{name}"))
            {
                mended.insert((*name).into(), Value::Object(extension));
            }
        }
        mended
    }

    fn property(&mut self, value: &Value, kind: &Kind, place: &str) -> Result<Value, Wrong> {
        match kind {
            Kind::Flag if !value.is_boolean() => wrong("is not true or false"),
            Kind::Text if !value.is_string() => wrong("is not a text"),
            Kind::Number(..) | Kind::Above(_) if !value.is_number() => wrong("is not a number"),
            Kind::Flag | Kind::Text | Kind::Number(..) | Kind::Above(_) => Ok(value.clone()),
            Kind::Integer(_, most) => match integer(value) {
                Some(number) if number > *most => wrong(format!("{number} is too large")),
                number => whole_number(number),
            },
            Kind::MultipleOf4(..) => whole_number(integer(value)),
            Kind::Code(codes) => match integer(value) {
                Some(code) if !codes.contains(&code) => wrong(format!("{code} is unknown")),
                code => whole_number(code),
            },
            Kind::Word(words) => match value.as_str() {
                Some(word) if words.contains(&word) => Ok(value.clone()),
                Some(word) => wrong(format!("{:?} is unknown", word.chars().take(40).collect::<String>())),
                None => wrong("is not a text"),
            },
            Kind::Numbers(least, most, ..) => match value.as_array() {
                Some(list) if !list.iter().all(Value::is_number) => wrong("is not an array of numbers"),
                Some(list) if *most < usize::MAX && !(*least..=*most).contains(&list.len()) => {
                    wrong(format!("is not an array of {least} numbers"))
                }
                Some(_) => Ok(value.clone()),
                None => wrong("is not an array of numbers"),
            },
            Kind::Index(collection) => self.index(value, collection),
            Kind::Indices(collection) => {
                let item = |mending: &mut Self, item: &Value, place: &str| {
                    mending.index(item, collection).map_err(|what| mending.note(place, what)).ok()
                };
                self.list(value, place, item)
            }
            Kind::Texts => self.list(value, place, |_, text, _| text.is_string().then(|| text.clone())),
            Kind::Object(spec) => match self.object(value, spec, place) {
                (object, true) => Ok(Value::Object(object)),
                (_, false) => Err(None),
            },
            Kind::List(spec) => self.list(value, place, |mending, item, place| {
                Some(Value::Object(mending.object(item, spec, place).0))
            }),
            Kind::Accessors => self.accessors(value, place, |_| true),
            Kind::Attributes => self.accessors(value, place, |name| AttributeName::of(name).is_some()),
            Kind::Targets => self.list(value, place, |mending, target, place| {
                let known = |name: &str| AttributeName::of(name).is_some();
                let mended = mending.accessors(target, place, known);
                Some(mended.unwrap_or_else(|what| {
                    mending.note(place, what);
                    json!({})
                }))
            }),
        }
    }

    fn note(&mut self, place: &str, what: Wrong) {
        if let Some(what) = what {
            self.faults.note(place, what);
        }
    }

    fn index(&self, value: &Value, collection: &str) -> Result<Value, Wrong> {
        match integer(value) {
            Some(index) if index >= len(self.root, collection) as u64 => {
                wrong(format!("refers to {collection}[{index}], which does not exist"))
            }
            index => whole_number(index),
        }
    }

    /// A list without the entries for which `item` has nothing.
    fn list(
        &mut self,
        value: &Value,
        place: &str,
        item: impl Fn(&mut Self, &Value, &str) -> Option<Value>,
    ) -> Result<Value, Wrong> {
        let Some(list) = value.as_array() else { return wrong("is not an array") };
        let items = list.iter().enumerate();
        let mended = items.filter_map(|(i, value)| match self.stop {
            None => item(self, value, &format!("{place}/{i}")),
            Some(_) => None,
        });
        Ok(mended.collect())
    }

    /// Accessors by name, as far as the name is known.
    fn accessors(
        &mut self,
        value: &Value,
        place: &str,
        known: impl Fn(&str) -> bool,
    ) -> Result<Value, Wrong> {
        let Some(map) = value.as_object() else { return wrong("is not an object") };
        let mut mended = Map::new();
        for (name, value) in map.iter().filter(|(name, value)| known(name) && !value.is_null()) {
            match self.index(value, "accessors") {
                Ok(index) => drop(mended.insert(name.clone(), index)),
                Err(what) => self.note(&format!("{place}/{name}"), what),
            }
        }
        Ok(Value::Object(mended))
    }
}

fn whole_number(number: Option<u64>) -> Result<Value, Wrong> {
    number.map_or_else(|| wrong("is not a whole number"), |number| Ok(number.into()))
}

/// What takes the place of a property that is missing or wrong.
fn stand_in(kind: &Kind) -> Value {
    match kind {
        Kind::Flag => false.into(),
        Kind::Text => "".into(),
        Kind::Number(..) | Kind::Above(_) | Kind::Integer(..) | Kind::MultipleOf4(..) => 0.into(),
        Kind::Code(codes) => codes[0].into(),
        Kind::Word(words) => words[0].into(),
        // Beyond every collection.
        Kind::Index(_) => u32::MAX.into(),
        Kind::Numbers(..) | Kind::Indices(_) | Kind::Texts | Kind::List(_) | Kind::Targets => json!([]),
        Kind::Object(_) | Kind::Accessors | Kind::Attributes => json!({}),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadOptions;

    fn typed(root: &Value) -> Result<(gltf::Document, Faults), Fault> {
        super::typed(root, &Budget::new(&LoadOptions { max_memory: 1 << 20, ..LoadOptions::default() }))
    }

    #[test]
    fn stand_ins_are_paid_for() {
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
        assert!(faults.below("").is_ok());
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
            assert!(faults.at(place).unwrap_err().to_string().contains(what), "{place}: {faults:?}");
        }
        assert!(faults.below("/nodes/0").is_err() && faults.at("/nodes/0").is_ok());
        for place in ["/materials/0/alphaMode", "/materials/0/normalTexture", "/nodes/1/name", "/meshes"] {
            assert!(faults.below(place).is_ok(), "{place}: {faults:?}");
        }
    }
}
