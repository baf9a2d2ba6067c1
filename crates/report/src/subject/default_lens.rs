//! A lens for scenes that come without one.

use baselines::FirstHits;
use lens::Camera;
use numerics::quantile;

/// Upper bound of the circle of confusion for most pixels of a scene without a lens, in picture heights: enough
/// blur to compare, with content still visible.
const TYPICAL_CIRCLE: f64 = 0.05;

/// Share of the pixels below that bound.
const TYPICAL_SHARE: f64 = 0.9;

/// Opens the aperture of `camera` as suits the scene, given its first `hits`; the focus distance is unchanged.
/// Returns a sentence that describes the choice. Without any depth range the camera is unchanged.
pub fn open_aperture(camera: &mut Camera, hits: &FirstHits) -> String {
    let optics = camera.optics();
    // Circle of confusion in px per unit of aperture radius.
    let circle_px_per_unit = |&kappa: &f64| 2.0 * kappa.abs() / optics.tan_half_yfov * optics.half_height_px;
    let surfaces = hits.kappa.iter().zip(&hits.depth).filter(|(_, depth)| depth.is_finite());
    let mut circles: Vec<f64> = surfaces.map(|(kappa, _)| circle_px_per_unit(kappa)).collect();
    let wide = quantile(&mut circles, TYPICAL_SHARE).unwrap_or(f64::NAN);
    let radius = TYPICAL_CIRCLE * camera.height as f64 / wide;
    if !(radius.is_finite() && radius > 0.0) {
        return "the file has no lens, and nothing is in sight to choose one by".into();
    }
    camera.aperture_radius = radius;
    let (share, circle) = (TYPICAL_SHARE * 100.0, TYPICAL_CIRCLE * 100.0);
    format!(
        "chosen (the file has none): circles of confusion of at most {circle:.0} % of the picture's height \
         in {share:.0} % of the picture"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_aperture_opens_to_the_typical_circle_of_confusion() {
        let mut camera = Camera { width: 20, height: 10, ..Camera::default() };
        let mut hits = FirstHits::background(20, 10);
        let optics = camera.optics();
        for (k, depth) in hits.depth.iter_mut().enumerate() {
            *depth = 1.0 + k as f32 / 10.0;
            hits.kappa[k] = optics.standard_kappa(1.0 / *depth as f64);
        }
        let sentence = open_aperture(&mut camera, &hits);
        assert!(sentence.contains("chosen"), "{sentence}");
        let optics = camera.optics();
        let mut circles: Vec<f64> = hits.kappa.iter().map(|&k| optics.circle_of_confusion_px(k)).collect();
        assert!((quantile(&mut circles, 0.9).unwrap() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn nothing_in_sight_changes_nothing() {
        let mut camera = Camera::default();
        let sentence = open_aperture(&mut camera, &FirstHits::background(4, 4));
        assert_eq!(camera, Camera::default());
        assert!(sentence.contains("nothing is in sight"));
    }
}
