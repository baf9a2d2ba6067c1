//! The target of an animation channel, as a place in the document.

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use serde_json::{Map, Number, Value};

/// A place in the document whose value a channel animates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Target {
    /// JSON pointer.
    pub pointer: String,
    kind: ValueKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ValueKind {
    /// A list of numbers, of this length or of any.
    List(Option<usize>),
    /// Four numbers that form a rotation.
    Rotation,
    /// A number.
    Number,
    /// A boolean: true if the number is not 0.
    Bool,
    /// A property of a material: a number, or a list of any length.
    MaterialProperty,
}

/// Maximum depth of a pointer; no property lies deeper.
const MAX_STEPS: usize = 8;

impl Target {
    /// The target of `channel`; `None` if it does not affect the picture.
    ///
    /// # Errors
    /// The target is malformed or does not exist.
    pub fn from_channel(document: &Document<'_>, channel: &Object<'_>) -> Result<Option<Self>, Fault> {
        let Some(target) = channel.object("target")? else { return Ok(None) };
        let path = target.text("path")?.unwrap_or_default();
        let pointer = if path == "pointer" {
            match target.extension("KHR_animation_pointer")?.map(|it| it.text("pointer")).transpose()? {
                Some(Some(pointer)) => pointer.to_string(),
                _ => return Err(target.malformed("extensions/KHR_animation_pointer", "has no pointer")),
            }
        } else {
            let Some(node) = target.index("node")? else { return Ok(None) };
            format!("/nodes/{node}/{path}")
        };
        let Some(kind) = value_kind(&pointer) else {
            document.warn(format!("{}: {pointer:?} is not animated", target.place));
            return Ok(None);
        };
        let mut steps = pointer.split('/').skip(1);
        if let (Some(collection), Some(index)) = (steps.next(), steps.next())
            && collection != "extensions"
            && index.parse().is_ok_and(|index: usize| index >= document.len(collection))
        {
            return Err(target.malformed("node", format!("refers to {pointer}, which does not exist")));
        }
        Ok(Some(Self { pointer, kind }))
    }

    /// Whether its four numbers form a rotation.
    pub fn is_rotation(&self) -> bool {
        self.kind == ValueKind::Rotation
    }

    /// Whether it is a property of a material.
    pub fn is_material_property(&self) -> bool {
        self.kind == ValueKind::MaterialProperty
    }

    /// The number of values that the target takes; `None` if any number.
    pub fn number_count(&self) -> Option<usize> {
        match self.kind {
            ValueKind::List(count) => count,
            ValueKind::Rotation => Some(4),
            ValueKind::Number | ValueKind::Bool => Some(1),
            ValueKind::MaterialProperty => None,
        }
    }

    /// Writes finite numbers to the target. False if its path leads through something that has no properties.
    pub fn write(&self, root: &mut Value, numbers: Vec<f64>) -> bool {
        let numbers: Vec<Value> =
            numbers.into_iter().filter_map(Number::from_f64).map(Value::Number).collect();
        let is_list = match self.kind {
            ValueKind::List(_) | ValueKind::Rotation => true,
            ValueKind::Number | ValueKind::Bool => false,
            ValueKind::MaterialProperty => numbers.len() > 1,
        };
        let value = match (is_list, numbers.first()) {
            (true, _) => Value::Array(numbers),
            (false, Some(number)) if self.kind == ValueKind::Bool => {
                Value::Bool(number.as_f64() != Some(0.0))
            }
            (false, Some(number)) => number.clone(),
            (false, None) => return false,
        };
        set_at_pointer(root, &self.pointer, value)
    }
}

/// The kind of value at a pointer, if it can be animated.
fn value_kind(pointer: &str) -> Option<ValueKind> {
    let steps: Vec<&str> = pointer.split('/').skip(1).take(MAX_STEPS + 1).collect();
    if steps.len() > MAX_STEPS {
        return None;
    }
    let is_index = |step: &str| step.parse::<u32>().is_ok();
    let (collection, rest) = steps.split_first()?;
    if *collection == "extensions" {
        return match rest {
            ["KHR_lights_punctual", "lights", index, "color"] if is_index(index) => {
                Some(ValueKind::List(Some(3)))
            }
            ["KHR_lights_punctual", "lights", index, "intensity" | "range"] if is_index(index) => {
                Some(ValueKind::Number)
            }
            ["KHR_lights_punctual", "lights", index, "spot", "innerConeAngle" | "outerConeAngle"]
                if is_index(index) =>
            {
                Some(ValueKind::Number)
            }
            _ => None,
        };
    }
    let (index, property) = rest.split_first()?;
    if !is_index(index) {
        return None;
    }
    match (*collection, property) {
        ("nodes", ["translation" | "scale"]) => Some(ValueKind::List(Some(3))),
        ("nodes", ["rotation"]) => Some(ValueKind::Rotation),
        ("nodes" | "meshes", ["weights"]) => Some(ValueKind::List(None)),
        ("nodes" | "meshes", ["weights", weight]) if is_index(weight) => Some(ValueKind::Number),
        ("nodes", ["extensions", "KHR_node_visibility", "visible"]) => Some(ValueKind::Bool),
        ("cameras", ["perspective", "yfov" | "aspectRatio"]) => Some(ValueKind::Number),
        ("materials", [_, ..]) => Some(ValueKind::MaterialProperty),
        _ => None,
    }
}

/// Sets the value at a pointer. Missing objects on the path are created, missing list entries are not.
fn set_at_pointer(root: &mut Value, pointer: &str, value: Value) -> bool {
    let mut here = root;
    for step in pointer.split('/').skip(1) {
        let name = step.replace("~1", "/").replace("~0", "~");
        if here.is_null() {
            *here = Value::Object(Map::new());
        }
        here = match here {
            Value::Object(map) => map.entry(name).or_insert(Value::Null),
            Value::Array(list) => match name.parse().ok().and_then(|index: usize| list.get_mut(index)) {
                Some(entry) => entry,
                None => return false,
            },
            _ => return false,
        };
    }
    *here = value;
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_come_to_their_place_and_no_other() {
        let mut root = json!({"nodes": [{"weights": [0.0, 0.5]}, {}]});
        let target = |pointer: &str| Target { pointer: pointer.into(), kind: value_kind(pointer).unwrap() };
        assert!(target("/nodes/0/weights/1").write(&mut root, vec![0.25]));
        assert!(target("/nodes/1/extensions/KHR_node_visibility/visible").write(&mut root, vec![0.0]));
        assert!(target("/nodes/1/translation").write(&mut root, vec![1.0, 2.0, 3.0]));
        assert!(!target("/nodes/0/weights/2").write(&mut root, vec![0.25]));
        let hidden = json!({"KHR_node_visibility": {"visible": false}});
        let expected = json!({"nodes": [{"weights": [0.0, 0.25]}, {"extensions": hidden, "translation": [1.0, 2.0, 3.0]}]});
        assert_eq!(root, expected);
    }

    #[test]
    fn what_is_no_property_of_the_picture_is_left_alone() {
        for pointer in [
            "/buffers/0/byteLength",
            "/nodes/0/children",
            "/nodes/x/scale",
            "",
            "/nodes",
            "/accessors/0/count",
        ] {
            assert_eq!(value_kind(pointer), None, "{pointer}");
        }
        assert_eq!(value_kind(&format!("/materials/0{}", "/a".repeat(9))), None);
    }
}
