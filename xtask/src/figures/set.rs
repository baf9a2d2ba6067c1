//! A set of figures: the table and the plot that answer one question, or a text with figures of other sets.

use super::plot::{Mark, Plot, Row};
use super::record::Record;
use super::table;
use super::table_set::{PlotSettings, TableSet};
use crate::chore::Failure;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// What stands between one pair of marks.
pub enum Set {
    /// Records in rows and columns.
    Table(TableSet),
    /// Lines of Markdown; `{SET:ID}` stands for that record's value and unit.
    Text(Vec<String>),
}

/// All sets of all files, by name.
pub struct Sets(BTreeMap<String, Set>);

impl Sets {
    /// Reads every JSON file of a folder.
    ///
    /// # Errors
    /// When a file cannot be read or does not have the form; the message names file, set and record.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let unreadable = |e: std::io::Error| Failure::new(format!("{}: {e}", folder.display()));
        let mut sets = Self(BTreeMap::new());
        let entries = std::fs::read_dir(folder).map_err(unreadable)?;
        let mut files: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        files.retain(|file| file.extension().is_some_and(|e| e == "json"));
        files.sort();
        for file in files {
            let text = std::fs::read_to_string(&file).map_err(unreadable)?;
            let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            sets.add(&stem, &text)
                .map_err(|problem| Failure::new(format!("{}: {problem}", file.display())))?;
        }
        Ok(sets)
    }

    /// Adds the sets of one file's text.
    fn add(&mut self, file: &str, text: &str) -> Result<(), String> {
        let json: Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
        for (name, value) in json.as_object().ok_or("must be an object of sets")? {
            let set = Set::from_json(format!("{file}/{name}"), value)
                .map_err(|problem| format!("{name}: {problem}"))?;
            if self.0.insert(name.clone(), set).is_some() {
                return Err(format!("{name}: a set of this name exists already"));
            }
        }
        Ok(())
    }

    /// # Errors
    /// The text is not JSON of this form.
    #[cfg(test)]
    pub fn from_text(file: &str, text: &str) -> Result<Self, String> {
        let mut sets = Self(BTreeMap::new());
        sets.add(file, text)?;
        Ok(sets)
    }

    pub fn iter(&self) -> impl Iterator<Item = (&String, &Set)> {
        self.0.iter()
    }

    pub fn get(&self, name: &str) -> Option<&Set> {
        self.0.get(name)
    }

    /// A text with the values that its `{SET:ID}` stand for.
    ///
    /// # Errors
    /// When there is no such record.
    pub fn fill(&self, template: &str) -> Result<String, String> {
        let mut text = String::new();
        let mut rest = template;
        while let Some((before, after)) = rest.split_once('{') {
            let (reference, after) =
                after.split_once('}').ok_or_else(|| format!("{template:?}: a brace is not closed"))?;
            let (name, id) =
                reference.split_once(':').ok_or_else(|| format!("{reference}: must be SET:ID"))?;
            let record = match self.get(name) {
                Some(Set::Table(set)) => set.records.iter().find(|record| record.id == id),
                _ => None,
            };
            let record = record.ok_or_else(|| format!("{reference}: there is no such record"))?;
            text += before;
            text += &record.text();
            rest = after;
        }
        Ok(text + rest)
    }
}

impl Set {
    fn from_json(path: String, value: &Value) -> Result<Self, String> {
        let fields = value.as_object().ok_or("must be an object")?;
        if let Some(lines) = fields.get("text") {
            let lines = lines.as_array().ok_or("\"text\" must be a list of lines")?;
            let lines: Option<Vec<_>> = lines.iter().map(|line| line.as_str().map(str::to_owned)).collect();
            return Ok(Self::Text(lines.ok_or("\"text\" must be a list of lines")?));
        }
        let records = fields.get("records").and_then(Value::as_array).ok_or("\"records\" must be a list")?;
        let records = records.iter().map(Record::from_json).collect::<Result<Vec<_>, _>>()?;
        let columns = fields.get("columns").and_then(Value::as_array).ok_or("\"columns\" must be a list")?;
        let pair = |column: &Value| {
            let [key, title] = &column.as_array()?[..] else { return None };
            Some((key.as_str()?.to_owned(), title.as_str()?.to_owned()))
        };
        let columns: Option<Vec<_>> = columns.iter().map(pair).collect();
        let columns = columns.ok_or("\"columns\" must hold pairs of key and title")?;
        let rows_title = fields.get("rows").and_then(Value::as_str).unwrap_or("scene").to_owned();
        let plot = fields.get("plot").map(PlotSettings::from_json).transpose()?;
        let set = TableSet { path, rows_title, columns, records, plot };
        set.check()?;
        Ok(Self::Table(set))
    }

    /// What stands on the page.
    ///
    /// # Errors
    /// When the text names a record that does not exist.
    pub fn markdown(&self, sets: &Sets, plots: &str) -> Result<String, String> {
        match self {
            Self::Text(lines) => {
                let lines = lines.iter().map(|line| sets.fill(line)).collect::<Result<Vec<_>, _>>()?;
                Ok(lines.join("\n"))
            }
            Self::Table(set) => {
                let table = table::markdown(set);
                Ok(match &set.plot {
                    Some(plot) => format!("{table}\n\n![{}]({plots}/{}.svg)", plot.title, set.path),
                    None => table,
                })
            }
        }
    }

    /// Its plot, if it has one: where it lies among plots, and the SVG.
    pub fn plot(&self) -> Option<(String, String)> {
        let Self::Table(set) = self else { return None };
        let settings = set.plot.as_ref()?;
        let series = |key: &String| {
            let column = set.columns.iter().find(|(column, _)| column == key);
            column.map_or(key.clone(), |(_, title)| title.clone())
        };
        let rows = set.rows().into_iter().map(|(title, records)| {
            let marks = settings.columns.iter().enumerate().filter_map(|(series, key)| {
                let record = records.iter().find(|record| record.column() == key)?;
                Some(Mark { series, quantity: record.quantity.clone() })
            });
            Row { title: title.to_owned(), marks: marks.collect() }
        });
        let plotted = |record: &&Record| settings.columns.iter().any(|key| key == record.column());
        let unit = set.records.iter().find(plotted).map_or(String::new(), |record| record.unit.clone());
        let plot = Plot {
            title: settings.title.clone(),
            series: settings.columns.iter().map(series).collect(),
            rows: rows.filter(|row: &Row| !row.marks.is_empty()).collect(),
            axis: settings.axis,
            unit,
        };
        Some((format!("{}.svg", set.path), plot.svg()))
    }
}
