//! One figure, and where it comes from.

use super::quantity::Quantity;
use serde_json::Value;

/// The fields of a record that must be there, and those that may be.
const REQUIRED: [&str; 8] = ["id", "scene", "command", "machine", "commit", "date", "value", "unit"];
const OPTIONAL: [&str; 2] = ["bound", "note"];

/// A figure. Its id is `ROW/COLUMN`; records of the same row stand in one line of the table, which is titled by their scene.
#[derive(Debug, Clone)]
pub struct Record {
    pub id: String,
    pub scene: String,
    /// What was run: commands of ours joined by ` && `, or a script of this repository.
    pub command: String,
    pub machine: String,
    /// The version that was measured or, where that was not noted, the commit that wrote the figure down.
    pub commit: String,
    /// The day of the measurement, YYYY-MM-DD.
    pub date: String,
    pub quantity: Quantity,
    /// Empty for a pure number.
    pub unit: String,
    pub note: Option<String>,
}

impl Record {
    /// Reads a record.
    ///
    /// # Errors
    /// When a field is missing, unknown or malformed.
    pub fn from_json(value: &Value) -> Result<Self, String> {
        let fields = value.as_object().ok_or("a record must be an object")?;
        let id = fields.get("id").and_then(Value::as_str).ok_or("a record has no \"id\"")?;
        let wrong = |what: String| format!("{id}: {what}");
        if let Some(unknown) =
            fields.keys().find(|key| !REQUIRED.contains(&&***key) && !OPTIONAL.contains(&&***key))
        {
            return Err(wrong(format!("unknown field {unknown:?}")));
        }
        let text = |key: &str| {
            let value = fields.get(key).and_then(Value::as_str);
            value.map(str::to_owned).ok_or_else(|| wrong(format!("\"{key}\" must be a text")))
        };
        let value = fields.get("value").ok_or_else(|| wrong("\"value\" is missing".into()))?;
        let quantity = Quantity::from_json(value, fields.get("bound")).map_err(wrong)?;
        let note = fields.contains_key("note").then(|| text("note")).transpose()?;
        let record = Self {
            id: id.to_owned(),
            scene: text("scene")?,
            command: text("command")?,
            machine: text("machine")?,
            commit: text("commit")?,
            date: text("date")?,
            quantity,
            unit: text("unit")?,
            note,
        };
        let is_commit = record.commit.len() >= 7 && record.commit.chars().all(|c| c.is_ascii_hexdigit());
        if !is_commit {
            return Err(wrong("\"commit\" must be at least seven hexadecimal digits".into()));
        }
        let is_day = |date: &str| {
            date.len() == 10
                && date
                    .char_indices()
                    .all(|(k, c)| if k == 4 || k == 7 { c == '-' } else { c.is_ascii_digit() })
        };
        if !is_day(&record.date) {
            return Err(wrong("\"date\" must have the form YYYY-MM-DD".into()));
        }
        if id.rsplit_once('/').is_none_or(|(row, column)| row.is_empty() || column.is_empty()) {
            return Err(wrong("\"id\" must have the form ROW/COLUMN".into()));
        }
        Ok(record)
    }

    /// Which row of the table it stands in.
    pub fn row(&self) -> &str {
        self.id.rsplit_once('/').map_or("", |(row, _)| row)
    }

    /// Which column of the table it stands in.
    pub fn column(&self) -> &str {
        self.id.rsplit_once('/').map_or("", |(_, column)| column)
    }

    /// The value with its unit.
    pub fn text(&self) -> String {
        format!("{} {}", self.quantity.text(), self.unit).trim_end().to_owned()
    }
}
