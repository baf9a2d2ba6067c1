//! The plots of a scene.

use crate::measurement::contender::Contender;
use crate::measurement::record::{Record, Series};
use crate::output::plot::{
    Axis, Chart, Kind, Point, Rule, Series as Line, bytes, plain, seconds, significant,
};
use crate::studies::live_preview::ShownPicture;

/// The renderers in the order of their colours, which are the same in every plot.
const STYLES: [&str; 6] = ["splat", "truth", "blur", "layers", "views", "scatter"];

/// The renderers that `records` has, in the order of their colours, then by name.
fn renderers(records: &[&Record]) -> Vec<String> {
    let mut names: Vec<String> = records.iter().map(|record| record.renderer.clone()).collect();
    names.sort_by_key(|name| (style(name), name.clone()));
    names.dedup();
    names
}

fn style(renderer: &str) -> usize {
    STYLES.iter().position(|name| *name == renderer).unwrap_or(STYLES.len())
}

/// The value of the knob, as a label of marks.
fn knob_text(record: &Record) -> String {
    let value = significant(record.value);
    match record.knob.as_str() {
        "" => String::new(),
        "tolerance_px" => format!("{value} px"),
        "views_a_side" => format!("{value}²"),
        "rays_a_sample" => format!("{value} rays"),
        knob => format!("{value} {knob}"),
    }
}

fn line(
    name: String,
    renderer: &str,
    is_dashed: bool,
    records: &[&Record],
    point: impl Fn(&Record) -> Point,
) -> Line {
    let own = records.iter().filter(|record| record.renderer == renderer);
    Line { name, style: style(renderer), is_dashed, points: own.map(|record| point(record)).collect() }
}

/// Lines of time; renderers that bake have two, with and without the bake.
fn time_lines(records: &[&Record], point: impl Fn(&Record, f64) -> Point) -> Vec<Line> {
    let mut lines = Vec::new();
    for renderer in renderers(records) {
        let is_baked = records.iter().any(|r| r.renderer == renderer && r.bake_seconds.is_some());
        let whole = |record: &Record| point(record, record.seconds);
        if is_baked {
            let again = |record: &Record| point(record, record.picture_seconds);
            lines.push(line(format!("{renderer}: bake + picture"), &renderer, false, records, whole));
            lines.push(line(format!("{renderer}: refocus"), &renderer, true, records, again));
        } else {
            let name = format!("{renderer}: {}", Contender::description(&renderer));
            lines.push(line(name, &renderer, false, records, whole));
        }
    }
    lines
}

/// Log time against log error, for records of one scene and focus.
pub fn time_against_error(records: &[&Record]) -> Chart {
    let point = |record: &Record, seconds| Point { x: seconds, y: record.rmse, label: knob_text(record) };
    Chart {
        title: format!("{}: time against error", records.first().map_or("", |r| r.focus.as_str())),
        x: time_axis(),
        y: error_axis(),
        series: time_lines(records, point),
        rules: reference_rule(records),
    }
}

/// Log memory against log error, for records of one scene and focus.
pub fn memory_against_error(records: &[&Record]) -> Chart {
    let lines = renderers(records).into_iter().map(|renderer| {
        let point =
            |record: &Record| Point { x: record.bytes as f64, y: record.rmse, label: knob_text(record) };
        line(renderer.clone(), &renderer, false, records, point)
    });
    Chart {
        title: format!("{}: memory against error", records.first().map_or("", |r| r.focus.as_str())),
        x: Axis { label: "kept for the next picture (bytes)".into(), kind: Kind::Log, number: bytes },
        y: error_axis(),
        series: lines.collect(),
        rules: reference_rule(records),
    }
}

/// Error against time of the live preview, a line per change; the last picture has no error and is left out.
pub fn live(pictures: &[ShownPicture]) -> Chart {
    let mut names: Vec<&str> = pictures.iter().map(|picture| picture.after.as_str()).collect();
    names.dedup();
    let line = |(style, name): (usize, &str)| {
        let own = pictures.iter().filter(|picture| picture.after == name && picture.psnr < 200.0);
        let point = |picture: &ShownPicture| Point {
            x: picture.seconds,
            y: numerics::mean_square_of_psnr(picture.psnr).sqrt(),
            label: picture.what.clone(),
        };
        Line { name: name.into(), style, is_dashed: false, points: own.map(point).collect() }
    };
    Chart {
        title: "the live preview: error against time".into(),
        x: time_axis(),
        y: error_axis(),
        series: names.into_iter().enumerate().map(line).collect(),
        rules: Vec::new(),
    }
}

/// Cost against the quantity that a series varies, for records of one scene and series.
pub fn cost(series: Series, records: &[&Record]) -> Option<Chart> {
    let (title, label, kind, at): (_, _, _, fn(&Record) -> f64) = match series {
        Series::Knob => return None,
        Series::Aperture => (
            "cost against circle of confusion",
            "circle of confusion of 99 % of the picture (px)",
            Kind::Linear,
            |record| record.coc_px,
        ),
        Series::PictureSize => ("cost against picture size", "pixels", Kind::Log, |record| {
            f64::from(record.width) * f64::from(record.height)
        }),
        Series::SceneSize => {
            ("cost against scene size", "triangles, of the same surfaces", Kind::Log, |record| {
                record.triangles as f64
            })
        }
    };
    let point = |record: &Record, y| Point { x: at(record), y, label: String::new() };
    Some(Chart {
        title: title.into(),
        x: Axis { label: label.into(), kind, number: plain },
        y: Axis { label: "time (log)".into(), kind: Kind::Log, number: seconds },
        series: time_lines(records, point),
        rules: Vec::new(),
    })
}

/// The axis of times.
pub fn time_axis() -> Axis {
    Axis { label: "time (log)".into(), kind: Kind::Log, number: seconds }
}

/// The axis of root mean square errors.
pub fn error_axis() -> Axis {
    Axis { label: "RMSE, linear, clipped to [0, 1] (log)".into(), kind: Kind::Log, number: plain }
}

fn reference_rule(records: &[&Record]) -> Vec<Rule> {
    let error = records.iter().map(|record| record.reference_rmse).find(|&rmse| rmse > 0.0);
    error.map(|y| Rule { y, label: "error of the reference itself".into() }).into_iter().collect()
}
