//! Checks every property of the document against the schema.

use crate::gltf::container::json_object::as_whole_number;
use crate::gltf::document::Document;
use crate::gltf::extension;
use crate::gltf::schema::{PropertyKind, ROOT, Spec};
use serde_json::{Map, Value};
use std::collections::HashSet;

/// Warns about every property that is missing, has the wrong type, is out of range or refers to nothing.
pub(super) fn lint(document: &Document<'_>) {
    let property_lint = PropertyLint { document, declared: extension::used(document).collect() };
    property_lint.lint_object(document.root_value(), &ROOT, String::new());
}

struct PropertyLint<'a> {
    document: &'a Document<'a>,
    declared: HashSet<&'a str>,
}

impl PropertyLint<'_> {
    fn warn(&self, place: &str, what: &str) {
        self.document.warn(format!("{place}: {what}"));
    }

    fn lint_object(&self, value: &Value, spec: &Spec, place: String) {
        let Some(map) = value.as_object() else { return self.warn(&place, "is not an object") };
        for (key, kind) in spec.required {
            match map.get(*key) {
                Some(value) => self.lint_property(value, kind, format!("{place}/{key}")),
                None => self.warn(&place, &format!("its {key} is missing")),
            }
        }
        for (key, kind) in spec.optional {
            if let Some(value) = map.get(*key) {
                self.lint_property(value, kind, format!("{place}/{key}"));
            }
        }
        for (key, needed) in spec.needs {
            if map.contains_key(*key) && !map.contains_key(*needed) {
                self.warn(&format!("{place}/{key}"), &format!("needs {needed}, which is missing"));
            }
        }
        if !spec.one_of.is_empty() && spec.one_of.iter().filter(|key| map.contains_key(**key)).count() != 1 {
            self.warn(&place, &format!("must have exactly one of {}", spec.one_of.join(", ")));
        }
        if let Some(extensions) = map.get("extensions") {
            self.lint_extensions(extensions, spec, format!("{place}/extensions"));
        }
    }

    fn lint_extensions(&self, value: &Value, spec: &Spec, place: String) {
        let Some(map) = value.as_object() else { return self.warn(&place, "is not an object") };
        for (name, value) in map {
            let place = format!("{place}/{name}");
            if !self.declared.contains(name.as_str()) {
                self.warn(&place, "is not declared in extensionsUsed");
            }
            match spec.extensions.iter().find(|(candidate, _)| candidate == name) {
                Some((_, spec)) => self.lint_object(value, spec, place),
                None if extension::SUPPORTED.contains(&name.as_str()) && name != "KHR_mesh_quantization" => {
                    self.warn(&place, "this extension has no meaning here");
                }
                None if !value.is_object() => self.warn(&place, "is not an object"),
                None => {}
            }
        }
    }

    fn lint_property(&self, value: &Value, kind: &PropertyKind, place: String) {
        let warn = |what: &str| self.warn(&place, what);
        let in_range = |number: f64, low: f64, high: f64| {
            if !(low..=high).contains(&number) {
                warn(&format!("{number} is not between {low} and {high}"));
            }
        };
        match kind {
            PropertyKind::Flag if !value.is_boolean() => warn("is not true or false"),
            PropertyKind::Text if !value.is_string() => warn("is not a text"),
            PropertyKind::Flag | PropertyKind::Text => {}
            PropertyKind::Number(low, high) => match value.as_f64() {
                Some(number) => in_range(number, *low, *high),
                None => warn("is not a number"),
            },
            PropertyKind::Above(limit) => match value.as_f64() {
                Some(number) if number > *limit => {}
                Some(number) => warn(&format!("{number} is not above {limit}")),
                None => warn("is not a number"),
            },
            PropertyKind::Integer(low, high) | PropertyKind::MultipleOf4(low, high) => {
                match as_whole_number(value) {
                    Some(number) if number < *low || number > *high => {
                        warn(&format!("{number} is not between {low} and {high}"));
                    }
                    Some(number) if matches!(kind, PropertyKind::MultipleOf4(..)) && number % 4 != 0 => {
                        warn(&format!("{number} is not a multiple of 4"));
                    }
                    Some(_) => {}
                    None => warn("is not a whole number"),
                }
            }
            PropertyKind::Code(codes) => match as_whole_number(value) {
                Some(number) if codes.contains(&number) => {}
                _ => warn(&format!("is none of {codes:?}")),
            },
            PropertyKind::Word(words) => match value.as_str() {
                Some(text) if words.contains(&text) => {}
                Some(_) => warn(&format!("is none of {}", words.join(", "))),
                None => warn("is not a text"),
            },
            PropertyKind::Numbers(least, most, low, high) => match value.as_array() {
                Some(list) if list.len() < *least || list.len() > *most => {
                    warn(&format!("has {} numbers instead of {least}", list.len()));
                }
                Some(list) => {
                    for number in list {
                        match number.as_f64() {
                            Some(number) => in_range(number, *low, *high),
                            None => return warn("is not an array of numbers"),
                        }
                    }
                }
                None => warn("is not an array of numbers"),
            },
            PropertyKind::Index(collection) => self.lint_reference(value, collection, &place),
            PropertyKind::Indices(collection) => self.lint_distinct_items(value, &place, |value, place| {
                self.lint_reference(value, collection, place);
            }),
            PropertyKind::Texts => self.lint_distinct_items(value, &place, |value, place| {
                if !value.is_string() {
                    self.warn(place, "is not a text");
                }
            }),
            PropertyKind::Object(spec) => self.lint_object(value, spec, place),
            PropertyKind::List(spec) => {
                self.lint_items(value, &place, |value, place| self.lint_object(value, spec, place))
            }
            PropertyKind::Accessors | PropertyKind::Attributes => self.lint_attributes(value, place),
            PropertyKind::Targets => {
                self.lint_items(value, &place, |value, place| self.lint_attributes(value, place))
            }
        }
    }

    fn lint_reference(&self, value: &Value, collection: &str, place: &str) {
        match as_whole_number(value) {
            Some(index) if index < self.document.len(collection) as u64 => {}
            Some(index) => {
                self.warn(place, &format!("refers to {collection}[{index}], which does not exist"))
            }
            None => self.warn(place, "is not an index"),
        }
    }

    /// A non-empty array.
    fn lint_items(&self, value: &Value, place: &str, check: impl Fn(&Value, String)) {
        match value.as_array() {
            Some(list) if list.is_empty() => self.warn(place, "is empty"),
            Some(list) => list.iter().enumerate().for_each(|(i, value)| check(value, format!("{place}/{i}"))),
            None => self.warn(place, "is not an array"),
        }
    }

    /// A non-empty array of distinct items.
    fn lint_distinct_items(&self, value: &Value, place: &str, check: impl Fn(&Value, &str)) {
        self.lint_items(value, place, |value, place| check(value, &place));
        let mut values: Vec<String> = value.as_array().into_iter().flatten().map(Value::to_string).collect();
        values.sort_unstable();
        if let Some(twice) = values.windows(2).find(|pair| pair[0] == pair[1]) {
            self.warn(place, &format!("has {} more than once", twice[0]));
        }
    }

    fn lint_attributes(&self, value: &Value, place: String) {
        match value.as_object() {
            Some(map) if map.is_empty() => self.warn(&place, "is empty"),
            Some(map) => self.lint_accessors(map, &place),
            None => self.warn(&place, "is not an object"),
        }
    }

    fn lint_accessors(&self, map: &Map<String, Value>, place: &str) {
        for (name, value) in map {
            self.lint_reference(value, "accessors", &format!("{place}/{name}"));
        }
    }
}
