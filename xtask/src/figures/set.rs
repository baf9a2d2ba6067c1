//! A set of figures: the table and the plot that answer one question, or a text with figures of other sets.

use super::plot::{Axis, Mark, Plot, Row};
use super::record::Record;
use super::table;
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

/// Records, the columns they stand in, and what of it is plotted.
pub struct TableSet {
    /// Its name, with that of its file: `FILE/NAME`.
    pub path: String,
    /// What the first column holds.
    pub rows_title: String,
    /// Keys and titles, in the order of the table.
    pub columns: Vec<(String, String)>,
    pub records: Vec<Record>,
    plot: Option<PlotSettings>,
}

struct PlotSettings {
    title: String,
    columns: Vec<String>,
    axis: Axis,
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

impl TableSet {
    /// Rows in the order of their first records: the title, and the records.
    pub fn rows(&self) -> Vec<(&str, Vec<&Record>)> {
        let mut rows: Vec<(&str, &str, Vec<&Record>)> = Vec::new();
        for record in &self.records {
            match rows.iter_mut().find(|(row, _, _)| *row == record.row()) {
                Some((_, _, records)) => records.push(record),
                None => rows.push((record.row(), &record.scene, vec![record])),
            }
        }
        rows.into_iter().map(|(_, title, records)| (title, records)).collect()
    }

    fn check(&self) -> Result<(), String> {
        for (k, record) in self.records.iter().enumerate() {
            if self.records[..k].iter().any(|other| other.id == record.id) {
                return Err(format!("{}: this id exists twice", record.id));
            }
            if !self.columns.iter().any(|(key, _)| key == record.column()) {
                return Err(format!("{}: there is no column {:?}", record.id, record.column()));
            }
            let first = self.records.iter().find(|other| other.row() == record.row());
            if first.is_some_and(|first| first.scene != record.scene) {
                return Err(format!("{}: its row is of another scene", record.id));
            }
        }
        let Some(plot) = &self.plot else { return Ok(()) };
        if let Some(unknown) =
            plot.columns.iter().find(|key| !self.columns.iter().any(|(column, _)| column == *key))
        {
            return Err(format!("plot: there is no column {unknown:?}"));
        }
        let plotted =
            self.records.iter().filter(|record| plot.columns.iter().any(|key| key == record.column()));
        let units: Vec<&str> = plotted.map(|record| &*record.unit).collect();
        match units.iter().find(|unit| **unit != units[0]) {
            Some(other) => Err(format!("plot: units differ: {:?} and {other:?}", units[0])),
            None if units.is_empty() => Err("plot: there is nothing to plot".into()),
            None => Ok(()),
        }
    }
}

impl PlotSettings {
    fn from_json(value: &Value) -> Result<Self, String> {
        let title = value.get("title").and_then(Value::as_str).ok_or("plot: \"title\" must be a text")?;
        let columns =
            value.get("columns").and_then(Value::as_array).ok_or("plot: \"columns\" must be a list")?;
        let columns: Option<Vec<_>> = columns.iter().map(|key| key.as_str().map(str::to_owned)).collect();
        let axis = match value.get("axis").and_then(Value::as_str) {
            Some("log") => Axis::Logarithmic,
            Some("linear") => Axis::Linear,
            _ => return Err("plot: \"axis\" must be \"log\" or \"linear\"".into()),
        };
        Ok(Self { title: title.to_owned(), columns: columns.ok_or("plot: \"columns\" must be texts")?, axis })
    }
}
