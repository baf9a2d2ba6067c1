//! How well the aperture that a light field was baked for fits a lens.
//!
//! What of the aperture a sample sees is stored in cells over the baked aperture. A smaller lens uses few of them, and a larger one has them
//! stretched: either shows at once, and not quite as exactly as a light field of its own.

use lens::Camera;
use render::is_compatible;

/// A spare is baked for an aperture this much wider than the lens's, so that opening it by a stop (√2), and racking the focus meanwhile,
/// need no bake. Against a light field of the lens's own aperture (the demo, 480 × 270): 1.19 × is at 49.5 dB, 1.41 × at 47.6, 1.68 × at
/// 45.9, 2 × at 43.7, with 5, 8, 12 and 15 % more bytes.
const SPARE_SCALE: f64 = 1.5;

/// From this share of the baked radius on, a light field is as good as one of the lens's own.
const CLOSE: f64 = 0.9;

/// Outside of these shares of the baked radius, another light field is worth waiting for.
const WORTH_KEEPING: std::ops::RangeInclusive<f64> = 0.66..=1.1;

/// The lens's aperture radius as a share of the one that a light field of the same view was baked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ApertureFit {
    share: f64,
}

impl ApertureFit {
    /// How well a light field baked for `baked` fits `camera`; `None` if it cannot show it at all: it is of another view, or of a pinhole,
    /// which sees nothing of what is hidden.
    pub fn new(baked: &Camera, camera: &Camera) -> Option<Self> {
        let as_wide = Camera { aperture_radius: baked.aperture_radius, ..camera.clone() };
        let is_pinhole = baked.aperture_radius == 0.0;
        let is_shown = is_compatible(baked, &as_wide) && (!is_pinhole || camera.aperture_radius == 0.0);
        let share = if is_pinhole { 1.0 } else { camera.aperture_radius / baked.aperture_radius };
        is_shown.then_some(Self { share })
    }

    /// Whether it was baked for all of the lens's aperture: nothing is stretched.
    pub fn is_covering(self) -> bool {
        self.share <= 1.0
    }

    /// Whether it is as good as a light field of the lens's own aperture.
    pub fn is_close(self) -> bool {
        self.is_covering() && self.share >= CLOSE
    }

    /// Whether another light field is worth waiting for.
    pub fn is_poor(self) -> bool {
        !WORTH_KEEPING.contains(&self.share)
    }

    /// Whether this light field shows the lens better than the other.
    pub fn is_better_than(self, other: Self) -> bool {
        let is_nearer = (self.share - 1.0).abs() < (other.share - 1.0).abs();
        if self.is_covering() == other.is_covering() { is_nearer } else { self.is_covering() }
    }
}

/// The camera that a spare light field for `camera` is baked for; `None` for a pinhole.
pub(crate) fn spare_camera(camera: &Camera) -> Option<Camera> {
    let aperture_radius = camera.aperture_radius * SPARE_SCALE;
    (camera.aperture_radius > 0.0).then(|| Camera { aperture_radius, ..camera.clone() })
}

/// Whether a light field baked for `baked` is still a spare for `camera`: the lens can be opened by a stop.
pub(crate) fn is_spare_for(baked: &Camera, camera: &Camera) -> bool {
    let opened =
        Camera { aperture_radius: camera.aperture_radius * std::f64::consts::SQRT_2, ..camera.clone() };
    is_compatible(baked, &opened)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(aperture_radius: f64) -> Camera {
        Camera { aperture_radius, ..Camera::default() }
    }

    #[test]
    fn the_narrowest_that_covers_the_lens_fits_best() {
        let fit = |baked, radius| ApertureFit::new(&lens(baked), &lens(radius)).unwrap();
        assert!(fit(1.0, 1.0).is_better_than(fit(1.5, 1.0)) && !fit(1.5, 1.0).is_better_than(fit(1.0, 1.0)));
        assert!(fit(1.5, 1.2).is_better_than(fit(1.0, 1.2)), "nothing is stretched");
        assert!(fit(1.5, 2.0).is_better_than(fit(1.0, 2.0)), "less is stretched");
        assert!(fit(1.0, 0.95).is_close() && !fit(1.0, 1.01).is_close() && !fit(1.0, 0.8).is_close());
        assert!(fit(1.0, 0.5).is_poor() && fit(1.0, 1.2).is_poor() && !fit(1.0, 1.05).is_poor());
    }

    #[test]
    fn a_spare_holds_a_stop_more() {
        let spare = spare_camera(&lens(0.2)).unwrap();
        assert!(is_spare_for(&spare, &lens(0.2)) && is_spare_for(&spare, &lens(0.21)));
        assert!(!is_spare_for(&spare, &lens(0.25)));
        assert!(!ApertureFit::new(&spare, &lens(0.2)).unwrap().is_poor());
        assert!(!ApertureFit::new(&spare, &lens(0.2 * 2f64.sqrt())).unwrap().is_poor());
        let aside = Camera { width: 7, ..lens(0.2) };
        assert_eq!(ApertureFit::new(&spare, &aside), None);
    }

    #[test]
    fn a_pinhole_has_no_spare_and_is_none() {
        assert_eq!(spare_camera(&lens(0.0)), None);
        assert_eq!(ApertureFit::new(&lens(0.0), &lens(0.1)), None);
        let pinhole = ApertureFit::new(&lens(0.0), &lens(0.0)).unwrap();
        assert!(pinhole.is_close() && !pinhole.is_poor());
        let closed = ApertureFit::new(&lens(0.1), &lens(0.0)).unwrap();
        assert!(closed.is_covering() && closed.is_poor());
    }
}
