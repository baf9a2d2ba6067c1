//! The engine's figures as files.

use crate::engine::{EngineRecord, EngineReport};
use crate::store::{to_json, write_files};
use crate::table::Table;
use serde_json::json;
use session::SessionError;
use std::path::{Path, PathBuf};

/// Writes them into `folder`. Returns the files.
pub fn write(report: &EngineReport, copy: f64, folder: &Path) -> Result<Vec<PathBuf>, SessionError> {
    let about = json!({ "machine": report.machine, "frame_copy_ms": copy * 1e3, "checks": report.checks });
    let files = [
        ("report.json", to_json(&report.records)?),
        ("engine.md", markdown(report, copy).into_bytes()),
        ("about.json", to_json(&about)?),
    ];
    write_files(folder, files)
}

fn markdown(report: &EngineReport, copy: f64) -> String {
    let machine = &report.machine;
    let mut text = format!(
        "# The splat engine: speed and error\n\n{}, {} threads, {}, {}. F = {:.2} ms: copying one RGB float frame with all threads in \
         the same run. PSNR against the converged splat of the same light field, on linear values clipped to [0, 1]; outlines: \
         within 6 px of depth discontinuities. Tolerance: the side of a node as a share of a circle of confusion of 16 px.\n\n",
        machine.processor,
        machine.threads,
        machine.system,
        machine.date,
        copy * 1e3,
    );
    let titles = [
        "Scene",
        "What",
        "Renderer",
        "Size",
        "#Samples",
        "#Circle, px",
        "#Tolerance",
        "#ms",
        "#F",
        "#PSNR, dB",
        "#Outlines, dB",
        "#Coverage rms",
        "#MiB",
    ];
    let mut table = Table::new(&titles);
    report.records.iter().for_each(|record| table.push(row(record)));
    text += &table.to_markdown();
    text += "\nWhat must hold:\n\n";
    for check in &report.checks {
        let mark = if check.holds { "holds" } else { "DOES NOT HOLD" };
        text += &format!("- {}, {}: {mark}\n", check.scene, check.what);
    }
    text
}

fn row(record: &EngineRecord) -> Vec<String> {
    let decimals =
        |value: Option<f64>, digits: usize| value.map_or(String::new(), |v| format!("{v:.digits$}"));
    vec![
        record.scene.clone(),
        record.what.clone(),
        record.renderer.clone(),
        format!("{} × {}", record.size[0], record.size[1]),
        record.samples.to_string(),
        format!("{:.0}", record.coc_px),
        decimals(record.tolerance, 3),
        format!("{:.1}", record.ms_median),
        format!("{:.1}", record.frame_copies),
        decimals(record.psnr, 1),
        decimals(record.band_psnr, 1),
        decimals(record.band_coverage_rms, 4),
        format!("{:.1}", record.bytes as f64 / f64::from(1 << 20)),
    ]
}
