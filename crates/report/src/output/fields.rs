//! The fields of a serialised record in the order of their declaration.

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::Value;

/// Names and values of a JSON object in their original order, which a `serde_json` map does not preserve.
pub struct OrderedFields(pub Vec<(String, Value)>);

impl<'de> Deserialize<'de> for OrderedFields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(FieldVisitor)
    }
}

struct FieldVisitor;

impl<'de> Visitor<'de> for FieldVisitor {
    type Value = OrderedFields;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<OrderedFields, A::Error> {
        let mut fields = Vec::new();
        while let Some(field) = map.next_entry()? {
            fields.push(field);
        }
        Ok(OrderedFields(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_kept() {
        let OrderedFields(fields) = serde_json::from_str(r#"{"b": 1, "a": "x", "c": null}"#).unwrap();
        assert_eq!(fields.iter().map(|(name, _)| name.as_str()).collect::<String>(), "bac");
        assert!(serde_json::from_str::<OrderedFields>("[1]").is_err());
    }
}
