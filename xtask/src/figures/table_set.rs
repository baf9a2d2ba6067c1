//! Records that make one table, and what of it is plotted.

use super::plot::Axis;
use super::record::Record;
use serde_json::Value;

/// Records, the columns they stand in, and what of it is plotted.
pub struct TableSet {
    /// Its name, with that of its file: `FILE/NAME`.
    pub path: String,
    /// What the first column holds.
    pub rows_title: String,
    /// Keys and titles, in the order of the table.
    pub columns: Vec<(String, String)>,
    pub records: Vec<Record>,
    pub plot: Option<PlotSettings>,
}

/// Which columns are plotted, and how.
pub struct PlotSettings {
    pub title: String,
    pub columns: Vec<String>,
    pub axis: Axis,
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

    /// # Errors
    /// When an id exists twice, a record does not fit into the table, or the plot's units differ.
    pub fn check(&self) -> Result<(), String> {
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
    /// # Errors
    /// When it has another form.
    pub fn from_json(value: &Value) -> Result<Self, String> {
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
