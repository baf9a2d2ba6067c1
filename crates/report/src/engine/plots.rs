//! The engine's figures as plots.

use crate::engine::EngineRecord;
use crate::page::plots::{error_axis, time_axis};
use crate::plot::{Axis, Chart, Kind, Point, Series, plain, seconds};

/// Pictures that are at least so close, dB, are the converged one: there is no error to draw.
const EXACT: f64 = 150.0;

/// Error against tolerance, time against error, and time against circle of confusion.
pub fn plots(records: &[EngineRecord]) -> [Chart; 3] {
    let tolerance = |record: &EngineRecord| record.tolerance.filter(|&tolerance| tolerance > 0.0);
    [
        Chart {
            title: "error against tolerance".into(),
            x: Axis { label: "tolerance (log)".into(), kind: Kind::Log, number: plain },
            y: error_axis(),
            series: sweeps(records, |record| Some((tolerance(record)?, rmse(record)?))),
            rules: Vec::new(),
        },
        Chart {
            title: "time of a full splat against error".into(),
            x: time_axis(),
            y: error_axis(),
            series: sweeps(records, |record| Some((record.ms_median / 1e3, rmse(record)?))),
            rules: Vec::new(),
        },
        Chart {
            title: "time of a full splat against circle of confusion".into(),
            x: Axis { label: "circle of confusion (px)".into(), kind: Kind::Linear, number: plain },
            y: Axis { label: "time".into(), kind: Kind::Linear, number: seconds },
            series: circles(records).into_iter().collect(),
            rules: Vec::new(),
        },
    ]
}

/// From the PSNR on a range of 1.
fn rmse(record: &EngineRecord) -> Option<f64> {
    record.psnr.filter(|&psnr| psnr < EXACT).map(|psnr| 10f64.powf(-psnr / 20.0))
}

/// A line for each field and focus that was splatted at several tolerances, as `of` places its records.
fn sweeps(records: &[EngineRecord], of: impl Fn(&EngineRecord) -> Option<(f64, f64)>) -> Vec<Series> {
    let mut lines: Vec<Series> = Vec::new();
    for record in records.iter().filter(|record| record.renderer == "splat") {
        let Some((x, y)) = of(record) else { continue };
        let name = match record.what.split_once(", ") {
            Some((_, focus)) => format!("{}, {focus}", record.scene),
            None => record.scene.clone(),
        };
        let label = record.tolerance.map_or(String::new(), plain);
        let point = Point { x, y, label };
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => {
                lines.push(Series { name, style: lines.len(), is_dashed: false, points: vec![point] });
            }
        }
    }
    lines
}

/// Planes of growing circles.
fn circles(records: &[EngineRecord]) -> Option<Series> {
    let planes = records.iter().filter(|record| record.what == "against circle");
    let point = |record: &EngineRecord| Point {
        x: record.coc_px,
        y: record.ms_median / 1e3,
        label: format!("{} px", plain(record.coc_px)),
    };
    let points: Vec<_> = planes.map(point).collect();
    let line = Series { name: "planes, as one looks at them".into(), style: 0, is_dashed: false, points };
    (!line.points.is_empty()).then_some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(what: &str, tolerance: f64, psnr: f64) -> EngineRecord {
        EngineRecord {
            scene: "wall".into(),
            what: what.into(),
            renderer: "splat".into(),
            backend: "cpu".into(),
            threads: 2,
            size: [8, 8],
            samples: 64,
            coc_px: 4.0,
            tolerance: Some(tolerance),
            ms_median: 2.0,
            frame_copies: 1.0,
            psnr: Some(psnr),
            band_psnr: None,
            band_coverage_rms: None,
            bytes: 0,
        }
    }

    #[test]
    fn a_line_for_each_focus_and_no_mark_without_error() {
        let records = [
            record("full_splat, unpainted", 0.25, 40.0),
            record("full_splat, unpainted", 0.5, 20.0),
            record("full_splat, painted", 0.25, 200.0),
            record("full_splat, painted", 0.5, 30.0),
            record("against circle", 0.25, 200.0),
        ];
        let [errors, _, circles] = plots(&records);
        let names: Vec<_> =
            errors.series.iter().map(|line| (line.name.as_str(), line.points.len())).collect();
        assert_eq!(names, [("wall, unpainted", 2), ("wall, painted", 1)]);
        assert!((errors.series[0].points[1].y - 0.1).abs() < 1e-12);
        assert_eq!(circles.series[0].points.len(), 1);
    }
}
