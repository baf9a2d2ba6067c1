//! The files of the engine's report.

use super::growth::{GROWTHS, points, slope_sentence};
use super::plots::plots;
use super::{Check, EngineRecord, EngineReport};
use crate::output::markup::escaped;
use crate::output::page;
use crate::output::plot::significant;
use crate::output::table::Table;
use crate::store::{to_json, write_files};
use serde_json::json;
use session::SessionError;
use std::path::{Path, PathBuf};

/// Writes the report into `folder`; `copy` is the time of a frame copy, s. Returns the files.
///
/// # Errors
/// A file cannot be written.
pub fn write_engine_report(
    report: &EngineReport,
    copy: f64,
    folder: &Path,
) -> Result<Vec<PathBuf>, SessionError> {
    let about = json!({ "machine": report.machine, "frame_copy_ms": copy * 1e3, "checks": report.checks });
    let files = [
        ("report.json", to_json(&report.records)?),
        ("engine.md", markdown(report, copy).into_bytes()),
        ("engine.html", html(report, copy).into_bytes()),
        ("about.json", to_json(&about)?),
    ];
    write_files(folder, files)
}

const TITLE: &str = "The splat engine: speed and error";

fn method(copy: f64) -> String {
    format!(
        "F = {:.2} ms: copying one RGB float frame with all threads, the median of the run; \
         times are also given in frame copies made alongside them. PSNR against the converged splat of \
         the same light field, on linear values clipped to [0, 1]; outlines: within 6 px of depth discontinuities. \
         Tolerance: the side of a node as a share of a circle of confusion of 16 px. Truth: against ray tracing with many \
         rays, exposure \"conserve\", including the reference's own error; ray tracer: how many times as long it \
         takes to reach the same error. Pictures on a graphics card stay there; a time ends when the picture is complete.",
        copy * 1e3
    )
}

fn markdown(report: &EngineReport, copy: f64) -> String {
    let (machine, method) = (page::machine_sentence(&report.machine), method(copy));
    let mut text = format!("# {TITLE}\n\n{machine} {method}\n\n{}", table(report).to_markdown());
    text += &format!("\n{}\n", slopes(report).join(" "));
    text += "\nWhat must hold:\n\n";
    for check in &report.checks {
        text += &format!("- {}\n", outcome(check));
    }
    text
}

fn html(report: &EngineReport, copy: f64) -> String {
    let (machine, method) = (escaped(&page::machine_sentence(&report.machine)), escaped(&method(copy)));
    let mut body = format!("<h1>{TITLE}</h1>\n<p class=\"byline\">{machine}</p>\n<p>{method}</p>\n");
    plots(&report.records).iter().for_each(|chart| body += &page::figure(chart));
    body += &format!("<p>{}</p>\n", escaped(&slopes(report).join(" ")));
    body +=
        &format!("<h2>All measurements</h2>\n{}\n<h2>What must hold</h2>\n<ul>\n", table(report).to_html());
    for check in &report.checks {
        body += &format!("<li>{}</li>\n", escaped(&outcome(check)));
    }
    page::document(TITLE, &(body + "</ul>\n"))
}

/// How the time of a bake grows, a sentence each.
fn slopes(report: &EngineReport) -> Vec<String> {
    let measured = GROWTHS.into_iter().filter(|growth| !points(*growth, &report.records).is_empty());
    measured.map(|growth| slope_sentence(growth, &report.records)).collect()
}

fn outcome(check: &Check) -> String {
    let mark = if check.holds { "holds" } else { "DOES NOT HOLD" };
    format!("{}, {}: {mark}", check.scene, check.what)
}

fn table(report: &EngineReport) -> Table {
    let titles = [
        "Scene",
        "What",
        "Renderer",
        "On",
        "Size",
        "#Samples",
        "#Against",
        "#Circle, px",
        "#Tolerance",
        "#ms",
        "#F",
        "#Its clock, ms",
        "#PSNR, dB",
        "#Outlines, dB",
        "#Coverage rms",
        "#Truth, dB",
        "#Outlines",
        "#FLIP",
        "#Ray tracer, ×",
        "#MiB",
    ];
    let mut table = Table::new(&titles);
    report.records.iter().for_each(|record| table.push(row(record)));
    table
}

fn row(record: &EngineRecord) -> Vec<String> {
    let decimals =
        |value: Option<f64>, digits: usize| value.map_or(String::new(), |v| format!("{v:.digits$}"));
    let truth = record.truth.as_ref();
    let least = if truth.is_some_and(|truth| truth.ray_tracer_takes_longer) { "> " } else { "" };
    let times = record
        .speedup_over_ray_tracer()
        .map_or(String::new(), |times| format!("{least}{}", significant(times)));
    vec![
        record.scene.clone(),
        record.what.clone(),
        record.renderer.clone(),
        record.adapter.clone().unwrap_or_else(|| "processor".into()),
        format!("{} × {}", record.size[0], record.size[1]),
        record.samples.to_string(),
        decimals(record.against, 0),
        format!("{:.0}", record.coc_px),
        record.spp.map_or(decimals(record.tolerance, 3), |spp| format!("{spp} rays")),
        format!("{:.1}", record.ms_median),
        format!("{:.1}", record.frame_copies),
        decimals(record.card_ms, 2),
        decimals(record.psnr, 1),
        decimals(record.band_psnr, 1),
        decimals(record.band_coverage_rms, 4),
        decimals(truth.map(|truth| truth.psnr), 1),
        decimals(truth.and_then(|truth| truth.band_psnr), 1),
        decimals(truth.map(|truth| truth.flip), 4),
        times,
        format!("{:.1}", record.bytes as f64 / f64::from(1 << 20)),
    ]
}
