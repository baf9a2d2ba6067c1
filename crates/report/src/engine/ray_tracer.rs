//! The time after which the ray tracer reaches the splat's error against the ground truth.

use crate::findings::{CurvePoint, seconds_at};
use crate::measurement::band::OutlineBand;
use crate::measurement::contender::{Contender, Shot};
use crate::measurement::reference::{ReferenceError, conserved_picture, trace_reference};
use lens::Picture;
use light::Steps;
use project::{LinearPicture, compare};
use serde::Serialize;
use session::SessionError;

/// Measured numbers of rays per pixel, in addition to those of the reference.
const SPPS: [u32; 4] = [1, 4, 16, 64];

/// Cost and error of a picture of the ray tracer.
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    /// Rays a pixel.
    pub spp: u32,
    /// Time and RMSE against the reference, on values clipped to [0, 1].
    pub point: CurvePoint,
}

/// The ray tracer on one scene and focus, with the ground truth.
#[derive(Clone, Debug)]
pub struct RayTracer {
    reference: LinearPicture,
    /// Its pictures, by increasing number of rays.
    pub curve: Vec<Traced>,
}

/// A picture against the ground truth, and the ray tracer at equal error in the same run. The reference's own
/// error is included in both.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstTruth {
    /// Against the reference, on linear values clipped to [0, 1], exposure "conserve", dB.
    pub psnr: f64,
    /// The same within 6 px of outlines, dB; `None` without outlines.
    pub band_psnr: Option<f64>,
    /// Mean FLIP.
    pub flip: f64,
    /// Time after which the ray tracer reaches this error, ms.
    pub ray_tracer_ms: f64,
    /// Whether it takes longer than that: the picture is closer than a second reference would be.
    pub ray_tracer_takes_longer: bool,
}

impl RayTracer {
    /// Traces the reference and the ray tracer's pictures with fewer rays.
    ///
    /// # Errors
    /// Tracing is cancelled.
    pub fn measure(shot: Shot<'_>, reference_spp: u32, steps: &dyn Steps) -> Result<Self, SessionError> {
        let (reference, error) = trace_reference(shot, reference_spp, steps)?;
        let mut curve = Vec::new();
        for samples_per_pixel in SPPS.into_iter().filter(|&spp| 2 * spp < error.spp) {
            let drawn = Contender::Truth { samples_per_pixel }.draw(shot, steps)?;
            let rmse = compare(&conserved_picture(&drawn.picture), &reference)?.rmse;
            let point = CurvePoint { seconds: drawn.picture_seconds, rmse };
            curve.push(Traced { spp: samples_per_pixel, point });
        }
        curve.extend(points_from_reference(&error));
        Ok(Self { reference, curve })
    }

    /// The error of a picture of the same scene and focus against the ray tracer's.
    ///
    /// # Errors
    /// The pictures cannot be compared.
    pub fn against(&self, picture: &Picture, band: &OutlineBand) -> Result<AgainstTruth, SessionError> {
        let picture = conserved_picture(picture);
        let errors = compare(&picture, &self.reference)?;
        let equal_error = time_to_error(&self.curve, errors.rmse);
        Ok(AgainstTruth {
            psnr: errors.psnr,
            band_psnr: band.psnr(&picture.rgb, &self.reference.rgb),
            flip: errors.flip,
            ray_tracer_ms: equal_error.seconds * 1e3,
            ray_tracer_takes_longer: equal_error.takes_longer,
        })
    }
}

/// Points of the curve derived from the reference. If its error is r, each half of it has the error √2 r, which
/// would measure as √(2 + 1) r against another reference; a picture like the reference itself would measure as
/// √(1 + 1) r.
fn points_from_reference(reference: &ReferenceError) -> [Traced; 2] {
    let point = |spp, share: f64, squares: f64| {
        let seconds = reference.seconds * share;
        Traced { spp, point: CurvePoint { seconds, rmse: reference.rmse * squares.sqrt() } }
    };
    [point(reference.spp / 2, 0.5, 3.0), point(reference.spp, 1.0, 2.0)]
}

/// The time at which an error is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimeToError {
    seconds: f64,
    /// Whether that lies beyond the end of the curve.
    takes_longer: bool,
}

/// The time at which a curve, by increasing number of rays, reaches `rmse`; clamped to the times of its first
/// and last picture.
fn time_to_error(curve: &[Traced], rmse: f64) -> TimeToError {
    let points: Vec<_> = curve.iter().map(|traced| traced.point).collect();
    let seconds = |point: Option<&CurvePoint>| point.map_or(f64::NAN, |point| point.seconds);
    match seconds_at(&points, rmse) {
        Some((seconds, false)) => TimeToError { seconds, takes_longer: false },
        _ if points.first().is_some_and(|first| rmse > first.rmse) => {
            TimeToError { seconds: seconds(points.first()), takes_longer: false }
        }
        _ => TimeToError { seconds: seconds(points.last()), takes_longer: true },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_pictures_the_error_falls_by_a_power_law() {
        // Independent rays: half the error takes four times as long.
        let curve = [1u32, 16, 256].map(|spp| Traced {
            spp,
            point: CurvePoint { seconds: spp.into(), rmse: f64::from(spp).powf(-0.5) },
        });
        let at = |rmse| time_to_error(&curve, rmse);
        for (rmse, seconds) in [(0.5, 4.0), (0.125, 64.0), (1.0 / 16.0, 256.0)] {
            assert!((at(rmse).seconds - seconds).abs() < 1e-9 && !at(rmse).takes_longer, "{rmse}");
        }
        assert_eq!(at(2.0), TimeToError { seconds: 1.0, takes_longer: false });
        assert_eq!(at(0.01), TimeToError { seconds: 256.0, takes_longer: true });
        assert_eq!(at(0.0), TimeToError { seconds: 256.0, takes_longer: true });
        assert!(time_to_error(&[], 0.1).seconds.is_nan());
    }

    #[test]
    fn the_reference_counts_as_a_picture_seen_from_another_reference() {
        let error = ReferenceError { spp: 64, seconds: 8.0, rmse: 0.01, psnr: 40.0 };
        let [half, whole] = points_from_reference(&error);
        assert_eq!((half.spp, half.point.seconds, whole.spp, whole.point.seconds), (32, 4.0, 64, 8.0));
        // Its error and the other reference's, squared and added.
        let squares = [half, whole].map(|traced| traced.point.rmse.powi(2));
        assert!((squares[0] - 3e-4).abs() < 1e-12 && (squares[1] - 2e-4).abs() < 1e-12);
    }
}
