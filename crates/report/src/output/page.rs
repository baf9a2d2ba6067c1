//! The page of the report: one self-contained HTML file.

mod pictures;
pub mod plots;

use super::markup::escaped;
use super::plot::{Chart, bytes, seconds, significant};
use super::tables;
use crate::findings::equal_errors;
use crate::measurement::machine::Machine;
use crate::measurement::record::{Record, Series};
use crate::plan::cost_note;
use crate::report::{Measured, Report};
use crate::studies::left_out_photographs::{Photographs, SparseLightField};
use crate::studies::light_field_views::Views;
use crate::summary::{ModelledScene, SceneSummary};
use hard_cases::Outcome;
use render::DENSE_SAMPLE_BYTES;
use session::SessionError;

const STYLE: &str = include_str!("page/style.css");

/// Explains the comparison at equal error.
pub const EQUAL_ERROR_NOTE: &str = "The splat at its default tolerance, and the time after which the ray tracer reaches the same root mean \
square error, interpolated on its measured curve (*: extrapolated beyond the measurements). The error of the \
reference itself is subtracted first. A factor below 1 means slower. “Refocus” is the cost of another focus, focus distance or f-stop once the light field \
is baked.";

/// Explains the live preview.
pub const LIVE_NOTE: &str = "What the window shows after a change, in wall-clock seconds, and its error against the final exact \
picture; smaller pictures are enlarged as in the window. The scene's light is computed beforehand; nothing is baked for the new view.";

/// The report as an HTML page.
///
/// # Errors
/// A picture cannot be read.
pub fn html(report: &Report) -> Result<String, SessionError> {
    let records: Vec<&Record> = report.measured.iter().map(|measured| &measured.record).collect();
    let equal = equal_errors(records.iter().copied());
    let mut body = format!(
        "<h1>Focus Brush: speed against error</h1>\n<p class=\"byline\">{}</p>\n{}",
        escaped(&machine_sentence(&report.machine)),
        if report.scenes.is_empty() { String::new() } else { method(report) }
    );
    if !equal.is_empty() {
        let table = tables::equal_errors(&equal).to_html();
        body += &format!("<h2>At equal error</h2>\n{table}<p class=\"caption\">{EQUAL_ERROR_NOTE}</p>\n");
    }
    for scene in &report.scenes {
        body += &scene_section(scene, &report.measured)?;
    }
    if let Some(hard) = &report.hard {
        body += &hard_section(hard);
    }
    if !records.is_empty() {
        body += "<h2>All measurements</h2>\n";
    }
    for series in Series::ALL {
        let table = tables::records(records.iter().copied().filter(|record| record.series == series));
        if !table.rows.is_empty() {
            let (title, table) = (series_title(series), table.to_html());
            body += &format!("<h3>{title}</h3>\n<div class=\"dense\">{table}</div>\n");
        }
    }
    Ok(document("Focus Brush: speed against error", &body))
}

/// A complete HTML document.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style></head>\n<body>\n{body}</body></html>\n"
    )
}

/// The section on what was measured, and how.
fn method(report: &Report) -> String {
    format!(
        "<h2>What was measured</h2>\n\
         <p>Every renderer draws the same pictures, which are compared with references by ray tracing of the same model. \
         Errors are those of the conserved radiance (the exposure “conserve”), linear: RMSE, PSNR and FLIP of values clipped to \
         [0, 1], relMSE = mean of (a − b)²/(b² + 0.01) and the signed mean error (a − b)/b of unclipped ones. FLIP is that of \
         Andersson et al. 2020 at 67 pixels a degree. At a tolerance of 0 px the light field has 3 × 3 cells a pixel. Times are \
         wall-clock times, excluding the ray hierarchy of the scene; those under a quarter of a second are medians of up to five. \
         “Memory” is what a renderer keeps for the next picture: the samples of the light field, the hierarchy over the triangles, or \
         a pinhole picture with its defocus; “peak” is the increase of the process's memory at its peak (0 B: memory allocated before was \
         sufficient). A reference is the mean of two pictures with independent scrambles; their difference gives its own error.</p>\n\
         {}<p class=\"caption\">Circles of confusion: 50th / 90th / 99th percentile of the diameter over the pixels with a surface. PSNR of a \
         reference: its own, estimated; a measured PSNR near it or above only means that the picture is at least as good.</p>\n",
        tables::scenes(&report.scenes).to_html()
    )
}

fn scene_section(scene: &SceneSummary, measured: &[Measured]) -> Result<String, SessionError> {
    let own: Vec<&Measured> = measured.iter().filter(|m| m.record.scene == scene.name).collect();
    let of_series = |series| own.iter().filter(move |m| m.record.series == series).copied();
    let distance = scene.focus_distance.map_or_else(|| "infinity".into(), significant);
    let mut html = format!(
        "<h2>{}</h2>\n<p>{} in {}, {}; aperture radius {}, focused at {distance} (scene units). Lens: {}. \
         Hierarchy: {}.</p>\n",
        escaped(&scene.name),
        count_phrase(scene.triangles, "triangle"),
        count_phrase(scene.parts, "part"),
        count_phrase(scene.lights, "light"),
        significant(scene.aperture_radius),
        escaped(&scene.lens),
        bytes(scene.hierarchy_bytes as f64),
    );
    let mut charts = Vec::new();
    for focus in &scene.focuses {
        let sweep: Vec<&Record> =
            of_series(Series::Knob).map(|m| &m.record).filter(|r| r.focus == focus.name).collect();
        charts.push(plots::time_against_error(&sweep));
        charts.push(plots::memory_against_error(&sweep));
    }
    for series in Series::ALL {
        let records: Vec<&Record> = of_series(series).map(|m| &m.record).collect();
        charts.extend(plots::cost(series, &records));
    }
    html += "<div class=\"charts\">\n";
    charts.iter().for_each(|chart| html += &figure(chart));
    html += &format!(
        "</div>\n<p class=\"caption\">Labels at the ends of lines: the value of the renderer's knob. {}</p>\n",
        cost_note()
    );
    for focus in &scene.focuses {
        let shown: Vec<&Measured> =
            of_series(Series::Knob).filter(|m| m.record.focus == focus.name).collect();
        html += &format!(
            "<h3>{}, {}</h3>\n<p>{}.</p>\n{}<p class=\"caption\">Below each picture its FLIP error: 0 <span \
             class=\"ramp\"></span> 1.</p>\n",
            escaped(&scene.name),
            escaped(&focus.name),
            escaped(&capitalized(&focus.what)),
            pictures::figures(scene, focus, &shown)?
        );
    }
    if !scene.live.is_empty() {
        html += &format!(
            "<h3>The live preview</h3>\n{}{}<p class=\"caption\">{LIVE_NOTE}</p>\n",
            tables::live(&scene.live).to_html(),
            figure(&plots::live(&scene.live))
        );
    }
    if let Some(photographs) = &scene.photographs {
        html += &format!(
            "<h3>Photographs that were left out</h3>\n{}<p class=\"caption\">{}</p>\n{}",
            tables::photographs(photographs).to_html(),
            escaped(&photographs_sentence(photographs)),
            pictures::left_out(photographs)?
        );
    }
    if let Some(views) = &scene.views {
        html += &format!(
            "<h3>Views of the light field</h3>\n{}<p class=\"caption\">{}</p>\n",
            views
                .disparity
                .as_ref()
                .map_or_else(String::new, |disparity| tables::disparity(disparity).to_html()),
            escaped(&views_sentence(views))
        );
    }
    if let Some(light) = &scene.light {
        html += &format!("<h3>Light at once and refined</h3>\n<p>{}</p>\n", escaped(&light.sentence()));
    }
    html += &format!(
        "<h3>What was modelled</h3>\n{}<p class=\"caption\">{}</p>\n",
        tables::modelled(&scene.modelled).to_html(),
        escaped(&saving_sentence(&scene.modelled))
    );
    Ok(html)
}

/// Describes the photographs that were left out.
pub fn photographs_sentence(photographs: &Photographs) -> String {
    let Photographs { count, seconds: took, peak_bytes, sparse, .. } = photographs;
    let mut text = format!(
        "Some of {count} photographs are left out and reconstructed from the others: from their light, from its view-independent \
         part, and from a texture made of one photograph per texel. Measured where the surface is visible in others, with a gain per channel \
         fitted to the light. Computing the light took {}",
        seconds(*took)
    );
    if let Some(peak) = peak_bytes {
        text += &format!(" and {}", bytes(*peak as f64));
    }
    text += ".";
    if let Some(sparse) = sparse {
        text += &format!(" {}", sparse_sentence("photographs", sparse));
    }
    text
}

/// Describes the views of a light field.
pub fn views_sentence(views: &Views) -> String {
    let Views { count, disparity, sparse } = views;
    let mut text = match disparity {
        Some(_) => format!(
            "Disparities estimated from the {count} views alone, against the supplied ones, px per step."
        ),
        None => format!("{count} views; no disparities were supplied to compare with."),
    };
    if let Some(sparse) = sparse {
        text += &format!(" {}", sparse_sentence("views", sparse));
    }
    text
}

/// The depth range in which shifted and added pictures do not ghost.
fn sparse_sentence(pictures: &str, sparse: &SparseLightField) -> String {
    let SparseLightField { depth, spacing, ghost_free: [near, far] } = sparse;
    let depth_text = |depth: &Option<f64>| depth.map_or_else(|| "infinity".into(), significant);
    format!(
        "As a light field whose views are shifted and added, {pictures} {} apart would show an object at {} without \
         ghosting only if focused between {} and {}. The surface light field has no such bound.",
        significant(*spacing),
        significant(*depth),
        depth_text(near),
        depth_text(far),
    )
}

/// A plot as HTML, with a note on marks that cannot be shown.
pub fn figure(chart: &Chart) -> String {
    let caption = match chart.left_out_count() {
        0 => String::new(),
        n => format!("<figcaption>{n} marks at 0 cannot be shown on a logarithmic axis.</figcaption>"),
    };
    format!("<figure>{}{caption}</figure>\n", chart.to_svg())
}

fn hard_section(outcomes: &[Outcome]) -> String {
    let passed = outcomes.iter().filter(|outcome| outcome.pass && outcome.control_fails).count();
    format!(
        "<h2>Hard cases</h2>\n<p>Awkward inputs, each with the expected result and a deliberately wrong computation that the same \
         check must reject: {passed} of {} pass.</p>\n{}\n",
        outcomes.len(),
        tables::hard_cases(outcomes).to_html()
    )
}

/// The title of a series' table.
pub fn series_title(series: Series) -> &'static str {
    match series {
        Series::Knob => "Knobs",
        Series::Aperture => "Apertures",
        Series::PictureSize => "Picture sizes",
        Series::SceneSize => "Scene sizes",
    }
}

/// Version, machine and date in one sentence.
pub fn machine_sentence(machine: &Machine) -> String {
    let memory = machine.memory_bytes.map_or_else(String::new, |count| format!(", {}", bytes(count as f64)));
    format!(
        "Version {}, {}. {}, {} cores, {} threads{memory}, {}.",
        machine.version, machine.date, machine.processor, machine.cores, machine.threads, machine.system
    )
}

/// Describes the memory saved by the compact form, and its error.
pub fn saving_sentence(scene: &ModelledScene) -> String {
    let ModelledScene { modelled, tolerance_px, saving_psnr, saving_flip, finest_bytes } = scene;
    let dense = modelled.dense_bytes() as f64;
    let texels = match modelled.texels {
        Some(texels) if texels.sampled < texels.exist => {
            format!(" Texels are estimated from {} of them.", texels.sampled)
        }
        _ => String::new(),
    };
    format!(
        "Under the standard lens. {} B a visible sample, {} of what the dense form takes ({DENSE_SAMPLE_BYTES} B). At a tolerance of {} px \
         the picture is {saving_psnr:.1} dB (FLIP {saving_flip:.4}) from that of the finest light field, not packed, which takes {}.{texels}",
        significant(modelled.bytes_a_sample()),
        if dense > 0.0 {
            format!("{} %", significant(100.0 * modelled.samples.bytes as f64 / dense))
        } else {
            "none".into()
        },
        significant(*tolerance_px),
        bytes(*finest_bytes as f64),
    )
}

/// A count with its noun in singular or plural.
fn count_phrase(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// The text with a capital first letter.
fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
