//! The report's files.

use super::fields::OrderedFields;
use super::page;
use super::tables;
use crate::findings::equal_errors;
use crate::measurement::record::{Record, Series};
use crate::report::Report;
use crate::store::{to_json, write_files};
use serde_json::{Value, json};
use session::SessionError;
use std::path::{Path, PathBuf};

/// Writes all files of the report into `folder`. Returns them.
///
/// # Errors
/// A picture cannot be read, or a file cannot be written.
pub fn write_report(report: &Report, folder: &Path) -> Result<Vec<PathBuf>, SessionError> {
    let records: Vec<&Record> = report.measured.iter().map(|measured| &measured.record).collect();
    let about = json!({
        "machine": report.machine,
        "scenes": report.scenes,
        "measurements": records.len(),
    });
    let mut files = vec![
        ("report.html", page::html(report)?.into_bytes()),
        ("report.md", markdown(report).into_bytes()),
        ("report.json", to_json(&records)?),
        ("report.csv", csv(&records)?),
        ("about.json", to_json(&about)?),
    ];
    if let Some(hard) = &report.hard {
        files.push(("hard.json", to_json(hard)?));
    }
    write_files(folder, files)
}

/// The records as comma-separated values (RFC 4180), with a column per JSON key, in order.
fn csv(records: &[&Record]) -> Result<Vec<u8>, SessionError> {
    let mut text = String::new();
    for (k, record) in records.iter().enumerate() {
        let json = serde_json::to_string(record);
        let fields: Result<OrderedFields, _> = json.and_then(|json| serde_json::from_str(&json));
        let OrderedFields(fields) = fields
            .map_err(|error| SessionError::Internal(format!("a measurement cannot be written: {error}")))?;
        let mut line = |cells: Vec<String>| {
            text.push_str(&cells.join(","));
            text.push_str("\r\n");
        };
        if k == 0 {
            line(fields.iter().map(|(name, _)| name.clone()).collect());
        }
        line(fields.iter().map(|(_, value)| csv_cell(value)).collect());
    }
    Ok(text.into_bytes())
}

/// A JSON value as a cell.
fn csv_cell(value: &Value) -> String {
    match value {
        Value::String(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        other => other.to_string(),
    }
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
    if let Some(hard) = &report.hard {
        section("Hard cases", tables::hard_cases(hard).to_markdown());
    }
    for scene in report.scenes.iter().filter(|scene| !scene.live.is_empty()) {
        section(
            &format!("The live preview: {}", scene.name),
            format!("{}\n{}\n", tables::live(&scene.live).to_markdown(), page::LIVE_NOTE),
        );
    }
    for scene in &report.scenes {
        let Some(photographs) = &scene.photographs else { continue };
        section(
            &format!("Photographs that were left out: {}", scene.name),
            format!(
                "{}\n{}\n",
                tables::photographs(photographs).to_markdown(),
                page::photographs_sentence(photographs)
            ),
        );
    }
    for scene in &report.scenes {
        let Some(views) = &scene.views else { continue };
        let table = views
            .disparity
            .as_ref()
            .map_or_else(String::new, |disparity| tables::disparity(disparity).to_markdown());
        section(
            &format!("Views of the light field: {}", scene.name),
            format!("{table}\n{}\n", page::views_sentence(views)),
        );
    }
    for scene in &report.scenes {
        if let Some(light) = &scene.light {
            section(&format!("Light at once and refined: {}", scene.name), format!("{}\n", light.sentence()));
        }
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
