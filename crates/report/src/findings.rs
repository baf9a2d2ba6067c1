//! Conclusions from the measurements: time at equal error, and convergence of the ray tracer.

use crate::measurement::contender::Contender;
use crate::measurement::record::{Record, Series};

/// The splat at its default tolerance against the ray tracer, for one scene and focus.
#[derive(Clone, Debug, PartialEq)]
pub struct EqualError {
    /// The scene.
    pub scene: String,
    /// The focus.
    pub focus: String,
    /// The splat's measurement.
    pub splat: Record,
    /// Seconds after which the ray tracer reaches the splat's error.
    pub truth_seconds: f64,
    /// Whether that lies beyond the measurements and was extrapolated.
    pub is_extrapolated: bool,
    /// Slope of log RMSE over log samples of the ray tracer: −1/2 for independent samples.
    pub truth_slope: f64,
}

/// A point of a convergence curve: time and root mean square error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Seconds.
    pub seconds: f64,
    /// Error.
    pub rmse: f64,
}

/// The error of a measurement without the independent error of its reference; 0 if the reference's error
/// accounts for all of it.
pub fn own_rmse(record: &Record) -> f64 {
    (record.rmse.powi(2) - record.reference_rmse.powi(2)).max(0.0).sqrt()
}

/// The comparison at equal error for every scene and focus of the knob series.
pub fn equal_errors<'a>(records: impl Iterator<Item = &'a Record>) -> Vec<EqualError> {
    let knobs: Vec<&Record> = records.filter(|record| record.series == Series::Knob).collect();
    let usual = Contender::default_splat();
    let splats = knobs.iter().filter(|r| r.renderer == usual.renderer() && r.value == usual.knob_value());
    splats
        .filter_map(|splat| {
            let truths: Vec<&&Record> = knobs
                .iter()
                .filter(|r| r.renderer == "truth" && (&r.scene, &r.focus) == (&splat.scene, &splat.focus))
                .collect();
            let point = |r: &&&Record| CurvePoint { seconds: r.seconds, rmse: own_rmse(r) };
            let curve: Vec<_> = truths.iter().map(point).filter(|point| point.rmse > 0.0).collect();
            let (truth_seconds, is_extrapolated) = seconds_at(&curve, own_rmse(splat))?;
            let samples: Vec<_> = truths.iter().map(|r| (r.value, own_rmse(r))).collect();
            Some(EqualError {
                scene: splat.scene.clone(),
                focus: splat.focus.clone(),
                splat: (*splat).clone(),
                truth_seconds,
                is_extrapolated,
                truth_slope: log_slope(&samples),
            })
        })
        .collect()
}

/// The time at which a curve of falling error reaches `rmse`, and whether it is extrapolated: interpolated
/// between points, or extrapolated by the power law fitted to all of them. `None` if there are fewer than two
/// points or `rmse` is not positive.
pub fn seconds_at(curve: &[CurvePoint], rmse: f64) -> Option<(f64, bool)> {
    if curve.len() < 2 || rmse.is_nan() || rmse <= 0.0 {
        return None;
    }
    let crossing = curve.windows(2).find(|pair| pair[0].rmse >= rmse && rmse >= pair[1].rmse);
    if let Some([a, b]) = crossing.and_then(|pair| pair.first_chunk()) {
        if a.rmse == b.rmse {
            return Some((a.seconds.min(b.seconds), false));
        }
        let share = (a.rmse / rmse).ln() / (a.rmse / b.rmse).ln();
        return Some(((a.seconds.ln() + share * (b.seconds / a.seconds).ln()).exp(), false));
    }
    let slope = log_slope(&curve.iter().map(|point| (point.seconds, point.rmse)).collect::<Vec<_>>());
    let nearest = if rmse > curve[0].rmse { curve.first() } else { curve.last() }?;
    let seconds = nearest.seconds * (rmse / nearest.rmse).powf(1.0 / slope);
    (slope < 0.0 && seconds.is_finite()).then_some((seconds, true))
}

/// Slope of the least-squares line through the logarithms of the points; points that are not positive are
/// ignored. NaN for fewer than two.
pub fn log_slope(points: &[(f64, f64)]) -> f64 {
    let positive = points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0);
    let logs: Vec<_> = positive.map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mean_x, mean_y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (xy, xx) = logs
        .iter()
        .fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mean_x) * (y - mean_y), xx + (x - mean_x).powi(2)));
    xy / xx
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(seconds: f64) -> CurvePoint {
        CurvePoint { seconds, rmse: 0.1 * seconds.powf(-0.5) }
    }

    #[test]
    fn times_at_equal_error_follow_the_law() {
        let curve = [law(0.1), law(1.0), law(10.0)];
        let (between, extrapolated) = seconds_at(&curve, law(3.0).rmse).unwrap();
        assert!((between - 3.0).abs() < 1e-9 && !extrapolated, "{between}");
        let (beyond, extrapolated) = seconds_at(&curve, law(1000.0).rmse).unwrap();
        assert!((beyond - 1000.0).abs() < 1e-6 && extrapolated, "{beyond}");
        let (before, extrapolated) = seconds_at(&curve, law(0.01).rmse).unwrap();
        assert!((before - 0.01).abs() < 1e-9 && extrapolated, "{before}");
        assert_eq!(seconds_at(&curve[..1], 0.1), None);
        assert_eq!(seconds_at(&curve, 0.0), None);
        // An error that does not fall never reaches a smaller one.
        let flat = [law(1.0), CurvePoint { seconds: 2.0, rmse: 0.2 }];
        assert_eq!(seconds_at(&flat, 0.05), None);
    }

    #[test]
    fn slopes() {
        let points: Vec<_> = [4.0, 16.0, 64.0].iter().map(|&n: &f64| (n, n.powf(-0.75))).collect();
        assert!((log_slope(&points) + 0.75).abs() < 1e-12);
        assert!(log_slope(&[(1.0, 1.0)]).is_nan());
        assert!(log_slope(&[(1.0, 1.0), (2.0, 0.0)]).is_nan());
    }
}
