//! JSON written by people: keys keep their order, and every error names file and field.

use crate::ProjectError;
use crate::disk::read_text;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::path::Path;

/// A JSON value. Objects keep the order of their keys, including duplicates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Reads a file of one JSON value.
    ///
    /// # Errors
    /// The file cannot be read, or is not JSON.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        Self::parse(file, &read_text(file)?)
    }

    /// Parses `text`, the content of `file`, which errors name.
    ///
    /// # Errors
    /// It is not JSON.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ProjectError> {
        serde_json::from_str(text).map_err(|error| {
            let key = key_before(text, error.line(), error.column());
            let place = key.map(|key| format!(", in \"{key}\"")).unwrap_or_default();
            let problem = format!("is not JSON: {error}{place}");
            ProjectError::content(
                file,
                problem,
                "correct it there; JSON has no NaN, no comments and no commas at the end",
            )
        })
    }

    fn kind(&self) -> &'static str {
        match self {
            Json::Null => "null",
            Json::Bool(_) => "true or false",
            Json::Number(_) => "a number",
            Json::Text(_) => "a text",
            Json::List(_) => "a list",
            Json::Object(_) => "an object",
        }
    }
}

/// The key of the last `"key":` before a position in the text. A key on several lines is none: a quotation mark is missing.
fn key_before(text: &str, line: usize, column: usize) -> Option<&str> {
    let line_start: usize = text.split_inclusive('\n').take(line.checked_sub(1)?).map(str::len).sum();
    let place = (line_start + column).min(text.len());
    let before = text.get(..place)?;
    let colon = before.rfind("\":").or_else(|| before.rfind("\" :"))?;
    let open = before[..colon].rfind('"')?;
    Some(&before[open + 1..colon]).filter(|key| !key.contains(char::is_control))
}

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct JsonVisitor;
        impl<'de> Visitor<'de> for JsonVisitor {
            type Value = Json;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a JSON value")
            }
            fn visit_unit<E>(self) -> Result<Json, E> {
                Ok(Json::Null)
            }
            fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
                Ok(Json::Bool(value))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
                Ok(Json::Number(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
                Ok(Json::Number(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
                Ok(Json::Number(value))
            }
            fn visit_str<E>(self, value: &str) -> Result<Json, E> {
                Ok(Json::Text(value.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Json, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = list.next_element()? {
                    values.push(value);
                }
                Ok(Json::List(values))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Json, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Json::Object(entries))
            }
        }
        deserializer.deserialize_any(JsonVisitor)
    }
}

/// A value with its file and field.
#[derive(Clone, Copy)]
pub(crate) struct Field<'a> {
    pub file: &'a Path,
    pub value: &'a Json,
    parent: Option<&'a Fields<'a>>,
    name: &'a str,
}

/// The fields of an object.
pub(crate) struct Fields<'a> {
    file: &'a Path,
    path: String,
    entries: &'a [(String, Json)],
}

impl<'a> Field<'a> {
    /// The whole value of a file.
    pub fn root(file: &'a Path, value: &'a Json) -> Self {
        Self { file, value, parent: None, name: "" }
    }

    /// The field's path in the file.
    pub fn path(&self) -> String {
        match self.parent {
            Some(parent) if !parent.path.is_empty() => format!("{}.{}", parent.path, self.name),
            _ => self.name.to_string(),
        }
    }

    /// An error about the field: what is wrong with it, and the cure.
    pub fn error(&self, problem: impl Into<String>, cure: impl Into<String>) -> ProjectError {
        let path = self.path();
        let field = if path.is_empty() { "the whole file".to_string() } else { path };
        ProjectError::Field { file: self.file.to_owned(), field, problem: problem.into(), cure: cure.into() }
    }

    fn type_error(&self, expected: &str) -> ProjectError {
        let shown = match self.value {
            Json::Text(text) => format!("is the text \"{text}\""),
            other => format!("is {}", other.kind()),
        };
        self.error(shown, format!("give {expected}"))
    }

    /// The value as a finite number.
    ///
    /// # Errors
    /// It is something else.
    pub fn number(&self) -> Result<f64, ProjectError> {
        match self.value {
            Json::Number(number) if number.is_finite() => Ok(*number),
            Json::Number(_) => Err(self.error("is not finite", "give a finite number")),
            _ => Err(self.type_error("a number")),
        }
    }

    /// The value as a whole number that fits 32 bits.
    ///
    /// # Errors
    /// It is something else.
    pub fn whole_number(&self) -> Result<u32, ProjectError> {
        let number = self.number()?;
        if number.fract() == 0.0 && (0.0..=u32::MAX as f64).contains(&number) {
            Ok(number as u32)
        } else {
            Err(self.error(format!("is {number}"), "give a whole number of 0 or more"))
        }
    }

    /// The value as true or false.
    ///
    /// # Errors
    /// It is something else.
    pub fn boolean(&self) -> Result<bool, ProjectError> {
        match self.value {
            Json::Bool(value) => Ok(*value),
            _ => Err(self.type_error("true or false")),
        }
    }

    /// The values of a list, of any number.
    ///
    /// # Errors
    /// It is something else.
    pub fn list(&self) -> Result<Vec<Field<'a>>, ProjectError> {
        let Json::List(list) = self.value else { return Err(self.type_error("a list")) };
        Ok(list.iter().map(|value| Field { value, ..*self }).collect())
    }

    /// The value as text.
    ///
    /// # Errors
    /// It is something else.
    pub fn text(&self) -> Result<&'a str, ProjectError> {
        match self.value {
            Json::Text(text) => Ok(text),
            _ => Err(self.type_error("a text")),
        }
    }

    /// The value as N finite numbers.
    ///
    /// # Errors
    /// It is something else.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], ProjectError> {
        let wrong_type = || self.type_error(&format!("a list of {N} numbers"));
        let Json::List(list) = self.value else { return Err(wrong_type()) };
        let numbers = list.iter().map(|value| Field { value, ..*self }.number());
        let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
        numbers.try_into().map_err(|numbers: Vec<f64>| {
            self.error(format!("has {} numbers", numbers.len()), format!("give {N} numbers"))
        })
    }

    /// The value as N lists of M finite numbers.
    ///
    /// # Errors
    /// It is something else.
    pub fn rows<const N: usize, const M: usize>(&self) -> Result<[[f64; M]; N], ProjectError> {
        let wrong_type = || self.type_error(&format!("{N} rows of {M} numbers"));
        let Json::List(list) = self.value else { return Err(wrong_type()) };
        let rows = list.iter().map(|value| Field { value, ..*self }.numbers());
        let rows = rows.collect::<Result<Vec<[f64; M]>, _>>()?;
        rows.try_into().map_err(|rows: Vec<[f64; M]>| {
            self.error(format!("has {} rows", rows.len()), format!("give {N} rows of {M} numbers"))
        })
    }

    /// The value as an object.
    ///
    /// # Errors
    /// It is something else.
    pub fn object(&self) -> Result<Fields<'a>, ProjectError> {
        match self.value {
            Json::Object(entries) => Ok(Fields { file: self.file, path: self.path(), entries }),
            _ => Err(self.type_error("an object: {…}")),
        }
    }
}

impl<'a> Fields<'a> {
    /// The field with this name; of duplicates, the last. `None` if there is none.
    pub fn get(&'a self, name: &'a str) -> Option<Field<'a>> {
        let (name, value) = self.entries.iter().rev().find(|(key, _)| key == name)?;
        Some(Field { file: self.file, value, parent: Some(self), name })
    }

    /// All fields, in order.
    pub fn iter(&'a self) -> impl Iterator<Item = (&'a str, Field<'a>)> {
        self.entries.iter().map(move |(name, value)| {
            (name.as_str(), Field { file: self.file, value, parent: Some(self), name })
        })
    }

    /// Checks that all fields are among `allowed`.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn allow_only(&'a self, allowed: &[&str]) -> Result<(), ProjectError> {
        match self.iter().find(|(name, _)| !allowed.contains(name)) {
            None => Ok(()),
            Some((_, field)) => {
                Err(field.error("is not a valid field", format!("valid fields are {}", allowed.join(", "))))
            }
        }
    }

    /// An error about the object itself: what is wrong with it, and the cure.
    pub fn error(&self, problem: impl Into<String>, cure: impl Into<String>) -> ProjectError {
        let field = if self.path.is_empty() { "the whole file".to_string() } else { self.path.clone() };
        ProjectError::Field { file: self.file.to_owned(), field, problem: problem.into(), cure: cure.into() }
    }

    /// The file that they are in.
    pub fn file(&self) -> &Path {
        self.file
    }
}
