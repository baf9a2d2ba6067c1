//! The tables of the report, used for both Markdown and HTML.

use super::plot::{bytes, seconds, significant, with_minus};
use super::table::Table;
use crate::findings::EqualError;
use crate::measurement::record::Record;
use crate::studies::left_out_photographs::{Photographs, ReconstructedPhotograph};
use crate::studies::light_field_views::Disparity;
use crate::studies::live_preview::ShownPicture;
use crate::summary::{ModelledScene, SceneSummary};
use hard_cases::Outcome;

/// A table of the scenes and their references.
pub fn scenes(scenes: &[SceneSummary]) -> Table {
    let mut table = Table::new(&[
        "scene",
        "#triangles",
        "#size, px",
        "#aperture radius",
        "focus",
        "#circles of confusion, px",
        "#reference, spp",
        "#its PSNR, dB",
        "#its time",
    ]);
    for scene in scenes {
        for focus in &scene.focuses {
            let [half, most, all] = focus.reference.circles_px.map(significant);
            let error = focus.reference.error;
            table.push([
                scene.name.clone(),
                scene.triangles.to_string(),
                format!("{} × {}", scene.size[0], scene.size[1]),
                significant(scene.aperture_radius),
                focus.name.clone(),
                format!("{half} / {most} / {all}"),
                error.spp.to_string(),
                format!("{:.1}", error.psnr),
                seconds(error.seconds),
            ]);
        }
    }
    table
}

/// A table of the time that renderers take to equal errors.
pub fn equal_errors(comparisons: &[EqualError]) -> Table {
    let mut table = Table::new(&[
        "scene",
        "focus",
        "#splat, PSNR dB",
        "#bake + picture",
        "#refocus",
        "#ray tracing, equal error",
        "#bake + picture: faster by",
        "#refocus: faster by",
        "#slope of ray tracing",
    ]);
    for comparison in comparisons {
        let splat = &comparison.splat;
        let mark = if comparison.is_extrapolated { " *" } else { "" };
        let factor = |seconds: f64| format!("{} ×", significant(comparison.truth_seconds / seconds));
        table.push([
            comparison.scene.clone(),
            comparison.focus.clone(),
            format!("{:.1}", splat.psnr),
            seconds(splat.seconds),
            seconds(splat.picture_seconds),
            format!("{}{mark}", seconds(comparison.truth_seconds)),
            factor(splat.seconds),
            factor(splat.picture_seconds),
            with_minus(format!("{:.2}", comparison.truth_slope)),
        ]);
    }
    table
}

/// A table of what is modelled of a scene.
pub fn modelled(scene: &ModelledScene) -> Table {
    let mut table = Table::new(&["kind", "#texels", "#samples", "#bytes", "#bytes a sample", "what"]);
    let text = |value: Option<usize>| value.map_or_else(|| "–".into(), |n| n.to_string());
    for row in scene.modelled.rows() {
        let each = match (row.bytes, row.samples) {
            (Some(bytes), Some(samples)) if samples > 0 => significant(bytes as f64 / samples as f64),
            _ => "–".into(),
        };
        let size = row.bytes.map_or_else(|| "–".into(), |count| bytes(count as f64));
        table.push([row.kind.into(), text(row.texels), text(row.samples), size, each, row.what.into()]);
    }
    table
}

/// A table of the pictures of the live preview.
pub fn live(pictures: &[ShownPicture]) -> Table {
    let mut table = Table::new(&["after", "picture", "#size", "#seconds", "#PSNR, dB"]);
    for ShownPicture { after, what, size: [width, height], seconds, psnr } in pictures {
        let size = format!("{width} × {height}");
        table.push([after.clone(), what.clone(), size, significant(*seconds), format!("{psnr:.1}")]);
    }
    table
}

/// The reconstructions of left-out photographs, one by one and over all photographs.
pub fn photographs(photographs: &Photographs) -> Table {
    let mut table = Table::new(&["photograph", "told by", "#seen", "#PSNR, dB", "#FLIP"]);
    for ReconstructedPhotograph { photograph, method, visible_share, psnr, flip } in
        &photographs.reconstructions
    {
        let visible_percent = format!("{:.1} %", visible_share * 100.0);
        table.push([
            photograph.clone(),
            method.clone(),
            visible_percent,
            format!("{psnr:.2}"),
            format!("{flip:.4}"),
        ]);
    }
    // All photographs have the same methods.
    let first = photographs.reconstructions.first().map(|reconstruction| &reconstruction.photograph);
    for reconstruction in photographs.reconstructions.iter().filter(|other| Some(&other.photograph) == first)
    {
        let psnr = format!("{:.2}", photographs.overall_psnr(&reconstruction.method));
        table.push(["all".into(), reconstruction.method.clone(), String::new(), psnr, String::new()]);
    }
    table
}

/// Error of the disparities estimated from views against the supplied ones.
pub fn disparity(error: &Disparity) -> Table {
    let mut table = Table::new(&["disparities", "#off by > 0.07", "#by > 0.03", "#mean square × 100"]);
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let mean_square = format!("{:.3}", 100.0 * error.mean_square);
    table.push(["found in the views".into(), percent(error.bad_007), percent(error.bad_003), mean_square]);
    table
}

/// A table of the hard cases: expected results, ours, and the wrong ones.
pub fn hard_cases(outcomes: &[Outcome]) -> Table {
    let mut table = Table::new(&["case", "expected", "found", "pass", "control fails"]);
    let yes_or_no = |yes: bool| if yes { "yes" } else { "NO" }.to_string();
    for Outcome { case, expected, measured, pass, control_fails } in outcomes {
        let cells =
            [case.clone(), expected.clone(), measured.clone(), yes_or_no(*pass), yes_or_no(*control_fails)];
        table.push(cells);
    }
    table
}

/// A table of measurements, one in a row.
pub fn records<'a>(records: impl Iterator<Item = &'a Record>) -> Table {
    let mut table = Table::new(&[
        "scene",
        "focus",
        "renderer",
        "knob",
        "#px",
        "#CoC, px",
        "#triangles",
        "#time",
        "#of it bake",
        "#memory",
        "#peak",
        "#RMSE",
        "#relMSE",
        "#PSNR, dB",
        "#outlines, dB",
        "#FLIP",
        "#mean error",
    ]);
    for r in records {
        let knob =
            if r.knob.is_empty() { "–".into() } else { format!("{} {}", r.knob, significant(r.value)) };
        table.push([
            r.scene.clone(),
            r.focus.clone(),
            r.renderer.clone(),
            knob,
            format!("{} × {}", r.width, r.height),
            significant(r.coc_px),
            r.triangles.to_string(),
            seconds(r.seconds),
            r.bake_seconds.map_or_else(|| "–".into(), seconds),
            bytes(r.bytes as f64),
            r.peak_bytes.map_or_else(|| "–".into(), |count| bytes(count as f64)),
            significant(r.rmse),
            significant(r.relmse),
            format!("{:.2}", r.psnr),
            r.band_psnr.map_or_else(|| "–".into(), |psnr| format!("{psnr:.2}")),
            format!("{:.4}", r.flip),
            with_minus(format!("{:+.3} %", r.mean_error * 100.0)),
        ]);
    }
    table
}
