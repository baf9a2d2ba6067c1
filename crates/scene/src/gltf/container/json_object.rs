//! An object of the document with its place, read with checks: an absent property is `None`, one of the wrong type is
//! an error that names the place. Integers may be written as floats, as JSON allows.

use crate::error::Fault;
use serde_json::{Map, Value};

/// A JSON object and the JSON pointer to it.
#[derive(Clone)]
pub(crate) struct Object<'a> {
    map: &'a Map<String, Value>,
    /// JSON pointer.
    pub place: String,
}

impl<'a> Object<'a> {
    /// The object `value` at `place`, a JSON pointer.
    ///
    /// # Errors
    /// The value is not an object.
    pub fn new(value: &'a Value, place: String) -> Result<Self, Fault> {
        match value.as_object() {
            Some(map) => Ok(Self { map, place }),
            None => Err(Fault::Malformed { place, what: "is not an object".into() }),
        }
    }

    /// An error that says what is wrong with the property `key`.
    pub fn malformed(&self, key: &str, what: impl Into<String>) -> Fault {
        Fault::Malformed { place: format!("{}/{key}", self.place), what: what.into() }
    }

    /// The property `key` as it is; `None` if absent or null.
    pub fn get(&self, key: &str) -> Option<&'a Value> {
        self.map.get(key).filter(|value| !value.is_null())
    }

    fn read<T>(
        &self,
        key: &str,
        kind: &str,
        read: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, Fault> {
        match self.get(key) {
            None => Ok(None),
            Some(value) => read(value).map(Some).ok_or_else(|| self.malformed(key, format!("is not {kind}"))),
        }
    }

    /// The property `key` as a whole number ≥ 0; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn whole_number(&self, key: &str) -> Result<Option<u64>, Fault> {
        self.read(key, "a whole number", as_whole_number)
    }

    /// The property `key` as an index; `None` if absent.
    ///
    /// # Errors
    /// It is no whole number ≥ 0.
    pub fn index(&self, key: &str) -> Result<Option<usize>, Fault> {
        Ok(self.whole_number(key)?.map(|i| usize::try_from(i).unwrap_or(usize::MAX)))
    }

    /// The property `key` as a number; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn number(&self, key: &str) -> Result<Option<f64>, Fault> {
        self.read(key, "a number", Value::as_f64)
    }

    /// The property `key` as an array of N numbers; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        self.read(key, &format!("an array of {N} numbers"), |value| {
            let items: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
            items.try_into().ok()
        })
    }

    /// The property `key` as an array of any number of numbers; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn number_list(&self, key: &str) -> Result<Option<Vec<f64>>, Fault> {
        self.read(key, "an array of numbers", |value| value.as_array()?.iter().map(Value::as_f64).collect())
    }

    /// The property `key` as an array of indices; absent is empty.
    ///
    /// # Errors
    /// It is something else.
    pub fn indices(&self, key: &str) -> Result<Vec<usize>, Fault> {
        let index = |value: &Value| as_whole_number(value).map(|i| usize::try_from(i).unwrap_or(usize::MAX));
        let list =
            self.read(key, "an array of indices", |value| value.as_array()?.iter().map(index).collect())?;
        Ok(list.unwrap_or_default())
    }

    /// The property `key` as a text; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, Fault> {
        self.read(key, "a text", Value::as_str)
    }

    /// The property `key` as true or false; absent is false.
    ///
    /// # Errors
    /// It is something else.
    pub fn flag(&self, key: &str) -> Result<bool, Fault> {
        Ok(self.read(key, "true or false", Value::as_bool)?.unwrap_or(false))
    }

    /// The property `key` as an object; `None` if absent.
    ///
    /// # Errors
    /// It is something else.
    pub fn object(&self, key: &str) -> Result<Option<Object<'a>>, Fault> {
        self.get(key).map(|value| Object::new(value, format!("{}/{key}", self.place))).transpose()
    }

    /// The object of the extension `name`; `None` if absent.
    ///
    /// # Errors
    /// It, or the object of all extensions, is something else.
    pub fn extension(&self, name: &str) -> Result<Option<Object<'a>>, Fault> {
        match self.object("extensions")? {
            Some(extensions) => extensions.object(name),
            None => Ok(None),
        }
    }

    /// The property `key` as an array of objects; absent is empty.
    ///
    /// # Errors
    /// It is something else.
    pub fn objects(&self, key: &str) -> Result<Vec<Object<'a>>, Fault> {
        let items = self.list(key)?;
        let object = |(i, value)| Object::new(value, format!("{}/{key}/{i}", self.place));
        items.iter().enumerate().map(object).collect()
    }

    /// The property `key` as an array of anything; absent is empty.
    ///
    /// # Errors
    /// It is something else.
    pub fn list(&self, key: &str) -> Result<&'a [Value], Fault> {
        Ok(self.read(key, "an array", |value| value.as_array().map(Vec::as_slice))?.unwrap_or_default())
    }

    /// Its properties.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, &'a Value)> + use<'a> {
        self.map.iter().map(|(key, value)| (key.as_str(), value))
    }
}

/// A whole number ≥ 0, also if it is written as a float.
pub(crate) fn as_whole_number(value: &Value) -> Option<u64> {
    value.as_u64().or_else(|| {
        let number = value.as_f64()?;
        (number.fract() == 0.0 && (0.0..9.007_199_254_740_992e15).contains(&number)).then_some(number as u64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn integers_may_be_floats_but_not_fractions() {
        for (value, expected) in [
            (json!(3), Some(3)),
            (json!(3.0), Some(3)),
            (json!(3.5), None),
            (json!(-1), None),
            (json!(1e300), None),
            (json!("3"), None),
        ] {
            assert_eq!(as_whole_number(&value), expected, "{value}");
        }
    }

    #[test]
    fn wrong_types_name_the_place() {
        let value = json!({"count": "many"});
        let object = Object::new(&value, "/accessors/2".into()).unwrap();
        assert!(
            object
                .whole_number("count")
                .unwrap_err()
                .to_string()
                .contains("/accessors/2/count: is not a whole number")
        );
        assert_eq!(object.number("absent").unwrap(), None);
    }
}
