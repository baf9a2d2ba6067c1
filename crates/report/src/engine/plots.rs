//! Plots of the engine's measurements.

use super::EngineRecord;
use super::growth::{self, GROWTHS, Growth};
use crate::output::page::plots::{error_axis, time_axis};
use crate::output::plot::{Axis, Chart, Kind, Point, Series, plain, seconds};

/// From this PSNR on a picture counts as converged and is not plotted, dB.
const EXACT_PSNR: f64 = 150.0;

/// Error against tolerance, time against error, time against circle of confusion; and for each scene and
/// focus, the splat and the ray tracer against the ground truth.
pub fn plots(records: &[EngineRecord]) -> Vec<Chart> {
    let tolerance = |record: &EngineRecord| record.tolerance.filter(|&tolerance| tolerance > 0.0);
    let mut charts = vec![
        Chart {
            title: "error against tolerance".into(),
            x: Axis { label: "tolerance (log)".into(), kind: Kind::Log, number: plain },
            y: error_axis(),
            series: tolerance_lines(records, |record| {
                Some((tolerance(record)?, rmse_from_psnr(record.psnr)?))
            }),
            rules: Vec::new(),
        },
        Chart {
            title: "time of a full splat against error".into(),
            x: time_axis(),
            y: error_axis(),
            series: tolerance_lines(records, |record| {
                Some((record.ms_median / 1e3, rmse_from_psnr(record.psnr)?))
            }),
            rules: Vec::new(),
        },
        Chart {
            title: "time of a full splat against circle of confusion".into(),
            x: Axis { label: "circle of confusion (px)".into(), kind: Kind::Linear, number: plain },
            y: Axis { label: "time".into(), kind: Kind::Linear, number: seconds },
            series: circle_lines(records),
            rules: Vec::new(),
        },
    ];
    charts.extend(GROWTHS.into_iter().filter_map(|growth| growth_chart(growth, records)));
    let traced = records.iter().filter(|record| record.renderer == "truth");
    let mut names: Vec<String> = traced.map(line_name).collect();
    names.dedup();
    charts.extend(names.into_iter().map(|name| ground_truth_chart(name, records)));
    charts
}

/// The time of a bake against what it grows with; `None` if that was not measured.
fn growth_chart(growth: Growth, records: &[EngineRecord]) -> Option<Chart> {
    let point = |(x, y): (f64, f64)| Point { x, y, label: plain(x) };
    let points: Vec<Point> = growth::points(growth, records).into_iter().map(point).collect();
    let series = Series { name: "bake".into(), style: 0, is_dashed: false, points };
    (!series.points.is_empty()).then(|| Chart {
        title: format!("time of a bake against {}", growth.with),
        x: Axis { label: format!("{} (log)", growth.with), kind: Kind::Log, number: plain },
        y: time_axis(),
        series: vec![series],
        rules: Vec::new(),
    })
}

/// Time against error of the splat and the ray tracer, for a scene and focus.
fn ground_truth_chart(title: String, records: &[EngineRecord]) -> Chart {
    let line = |what: &str, style, is_dashed| {
        let own = records.iter().filter(|record| line_name(record) == title && record.what.starts_with(what));
        let point = |record: &EngineRecord| {
            let psnr = record.truth.as_ref().map(|truth| truth.psnr).or(record.psnr);
            let spp = record.spp.map(|spp| format!("{spp} rays"));
            let label = spp.or(record.tolerance.map(plain)).unwrap_or_default();
            Some(Point { x: record.ms_median / 1e3, y: rmse_from_psnr(psnr)?, label })
        };
        Series { name: what.replace('_', " "), style, is_dashed, points: own.filter_map(point).collect() }
    };
    let series = vec![
        line("bake and first picture", 0, false),
        line("full_splat", 0, true),
        line("ray tracer", 1, false),
    ];
    Chart {
        title: format!("{title}: time against error, the ground truth's"),
        x: time_axis(),
        y: error_axis(),
        series,
        rules: Vec::new(),
    }
}

/// RMSE from a PSNR on a range of 1; `None` if converged.
fn rmse_from_psnr(psnr: Option<f64>) -> Option<f64> {
    psnr.filter(|&psnr| psnr < EXACT_PSNR).map(|psnr| numerics::mean_square_of_psnr(psnr).sqrt())
}

/// A line for each field and focus over the tolerances, with its points given by `position`.
fn tolerance_lines(
    records: &[EngineRecord],
    position: impl Fn(&EngineRecord) -> Option<(f64, f64)>,
) -> Vec<Series> {
    let mut lines: Vec<Series> = Vec::new();
    let splats =
        records.iter().filter(|record| record.renderer == "splat" && record.what.starts_with("full_splat"));
    for record in splats {
        let Some((x, y)) = position(record) else { continue };
        let name = line_name(record);
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

/// Name of a line: the scene or field, its focus, and the graphics card, if any.
fn line_name(record: &EngineRecord) -> String {
    let focus = record.what.split_once(", ").map(|(_, focus)| focus);
    let parts = [Some(record.scene.as_str()), focus, record.adapter.as_deref()];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Time against the circle of confusion of planes, a line per device.
fn circle_lines(records: &[EngineRecord]) -> Vec<Series> {
    let planes: Vec<_> = records.iter().filter(|record| record.what == "against circle").collect();
    let line = |planes: &[&EngineRecord]| {
        let point = |record: &&EngineRecord| Point {
            x: record.coc_px,
            y: record.ms_median / 1e3,
            label: format!("{} px", plain(record.coc_px)),
        };
        let card = planes[0].adapter.as_ref().map_or(String::new(), |name| format!(", {name}"));
        let name = format!("planes, as one looks at them{card}");
        Series { name, style: 0, is_dashed: false, points: planes.iter().map(point).collect() }
    };
    let lines = planes.chunk_by(|a, b| a.adapter == b.adapter).zip(0..);
    lines.map(|(planes, style)| Series { style, ..line(planes) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::ray_tracer::AgainstTruth;

    fn record(what: &str, tolerance: f64, psnr: f64) -> EngineRecord {
        EngineRecord {
            scene: "wall".into(),
            what: what.into(),
            renderer: "splat".into(),
            backend: "cpu".into(),
            adapter: None,
            threads: 2,
            size: [8, 8],
            samples: 64,
            coc_px: 4.0,
            tolerance: Some(tolerance),
            against: None,
            spp: None,
            ms_median: 2.0,
            card_ms: None,
            frame_copy_ms: 1.0,
            frame_copies: 1.0,
            psnr: Some(psnr),
            band_psnr: None,
            band_coverage_rms: None,
            truth: None,
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
        let [errors, _, circles] = &plots(&records)[..] else { panic!("no ray tracer, no other plots") };
        let names: Vec<_> =
            errors.series.iter().map(|line| (line.name.as_str(), line.points.len())).collect();
        assert_eq!(names, [("wall, unpainted", 2), ("wall, painted", 1)]);
        assert!((errors.series[0].points[1].y - 0.1).abs() < 1e-12);
        assert_eq!(circles.series[0].points.len(), 1);
        let on_card = |record: EngineRecord| EngineRecord { adapter: Some("card".into()), ..record };
        let both = [records.to_vec(), records.map(on_card).to_vec()].concat();
        let [errors, _, circles] = &plots(&both)[..] else { panic!("no other plots") };
        assert_eq!(errors.series.len(), 4);
        assert_eq!(circles.series.iter().map(|line| line.points.len()).collect::<Vec<_>>(), [1, 1]);
    }

    #[test]
    fn the_ray_tracer_stands_beside_what_it_is_compared_with() {
        let truth = |psnr| AgainstTruth {
            psnr,
            band_psnr: None,
            flip: 0.0,
            ray_tracer_ms: 9.0,
            ray_tracer_takes_longer: false,
        };
        let traced = EngineRecord {
            renderer: "truth".into(),
            spp: Some(4),
            ..record("ray tracer, painted", 0.0, 30.0)
        };
        let splat = EngineRecord { truth: Some(truth(20.0)), ..record("full_splat, painted", 0.25, 40.0) };
        let first = EngineRecord { ms_median: 5.0, ..splat.clone() };
        let first = EngineRecord { what: "bake and first picture, painted".into(), ..first };
        let other = EngineRecord { scene: "other".into(), ..splat.clone() };
        let charts = plots(&[traced, splat, first, other]);
        let [_, _, _, chart] = &charts[..] else { panic!("{} charts", charts.len()) };
        let points: Vec<_> =
            chart.series.iter().flat_map(|line| &line.points).map(|p| (p.x * 1e3, p.y)).collect();
        for (actual, expected) in points.iter().zip([(5.0, 0.1), (2.0, 0.1), (2.0, 10f64.powf(-1.5))]) {
            assert!(
                (actual.0 - expected.0).abs() < 1e-9 && (actual.1 - expected.1).abs() < 1e-9,
                "{points:?}"
            );
        }
        assert_eq!(points.len(), 3);
    }
}
