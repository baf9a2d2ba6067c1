//! The report's files.

use crate::findings::equal_errors;
use crate::page;
use crate::record::{Record, Series};
use crate::run::Report;
use crate::store::{to_json, write_whole};
use crate::tables;
use serde_json::{Map, Value, json};
use session::SessionError;
use std::path::{Path, PathBuf};

/// Writes all files of the report into `folder`. Returns them.
pub fn write_report(report: &Report, folder: &Path) -> Result<Vec<PathBuf>, SessionError> {
    let records: Vec<&Record> = report.measured.iter().map(|measured| &measured.record).collect();
    let about = json!({
        "machine": report.machine,
        "scenes": report.scenes,
        "measurements": records.len(),
    });
    let files = [
        ("report.html", page::html(report)?.into_bytes()),
        ("report.md", markdown(report).into_bytes()),
        ("report.json", to_json(&records)?),
        ("report.csv", csv(&records)?),
        ("about.json", to_json(&about)?),
    ];
    let mut written = Vec::new();
    for (name, bytes) in files {
        let file = folder.join(name);
        write_whole(&file, &bytes)?;
        written.push(file);
    }
    Ok(written)
}

/// The records as comma-separated values: a column a key of the JSON, in its order.
fn csv(records: &[&Record]) -> Result<Vec<u8>, SessionError> {
    let fault =
        |what: &dyn std::fmt::Display| SessionError::Internal(format!("the table cannot be written: {what}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (k, record) in records.iter().enumerate() {
        let fields: Map<String, Value> = match serde_json::to_value(record).map_err(|e| fault(&e))? {
            Value::Object(fields) => fields,
            _ => return Err(fault(&"a record is not an object")),
        };
        if k == 0 {
            writer.write_record(fields.keys()).map_err(|e| fault(&e))?;
        }
        let text = |value: &Value| match value {
            Value::String(text) => text.clone(),
            Value::Null => String::new(),
            other => other.to_string(),
        };
        writer.write_record(fields.values().map(text)).map_err(|e| fault(&e))?;
    }
    writer.into_inner().map_err(|e| fault(&e))
}

/// The tables as Markdown.
fn markdown(report: &Report) -> String {
    let records = || report.measured.iter().map(|measured| &measured.record);
    let mut text =
        format!("# Focus Brush: speed against error\n\n{}\n", page::machine_sentence(&report.machine));
    let mut section = |title: &str, body: String| text.push_str(&format!("\n## {title}\n\n{body}"));
    section("Scenes and references", tables::scenes(&report.scenes).to_markdown());
    let equal = equal_errors(records());
    section(
        "At equal error",
        format!("{}\n{}\n", tables::equal_errors(&equal).to_markdown(), page::EQUAL_ERROR_NOTE),
    );
    for scene in &report.scenes {
        let modelled = &scene.modelled;
        section(
            &format!("What was modelled: {}", scene.name),
            format!("{}\n{}\n", tables::modelled(modelled).to_markdown(), page::saving_sentence(modelled)),
        );
    }
    for series in Series::ALL {
        let table = tables::records(records().filter(|record| record.series == series));
        if !table.rows.is_empty() {
            section(page::series_title(series), table.to_markdown());
        }
    }
    text
}
