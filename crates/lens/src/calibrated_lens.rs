//! The calibrated lens of a real camera: the mapping between directions and pixels of its photographs.
//!
//! A direction is projected to a plane ([`Projection`]), displaced there by the lens's distortion ([`Distortion`]),
//! and scaled and shifted to pixels. Polynomials fold back at some distance: beyond it two directions would share a
//! pixel, and the calibration is meaningless. The valid radius is computed on construction; nothing beyond it is
//! projected, and no pixel beyond it has a direction.

mod distortion;
mod projection;

pub use distortion::Distortion;
pub use projection::Projection;

use crate::CameraError;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A calibrated lens. Made by [`Self::new`].
///
/// Pixel coordinates: x right, y down, (0, 0) the upper left corner of the upper left pixel, whose middle is (0.5, 0.5).
///
/// ```text
/// (x, y) = distorted(projected(direction))        in focal lengths
/// pixel = (fx·x + b·y + cx, fy·y + cy)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibratedLens {
    intrinsics: Intrinsics,
    projection: Projection,
    distortion: Distortion,
    /// Ideal points farther from the middle are not projected.
    valid_radius: f64,
}

/// Scale and position of the picture plane, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Width and height of the photographs that they refer to.
    pub size_px: [u32; 2],
    /// fx and fy, > 0.
    pub focal_px: [f64; 2],
    /// b: horizontal offset per focal length downward; 0 unless pixels are skewed.
    pub skew_px: f64,
    /// (cx, cy): the principal point.
    pub principal_px: [f64; 2],
}

impl CalibratedLens {
    /// A lens with these parameters; lengths of `intrinsics` are in px.
    ///
    /// # Errors
    /// A parameter is out of range: sizes and focal lengths must be above 0, everything finite.
    pub fn new(
        intrinsics: Intrinsics,
        projection: Projection,
        distortion: Distortion,
    ) -> Result<Self, CameraError> {
        let require = |ok: bool, field, must| if ok { Ok(()) } else { Err(CameraError { field, must }) };
        let Intrinsics { size_px, focal_px, skew_px, principal_px } = intrinsics;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        require(size_px.iter().all(|side| *side > 0), "picture size", "at least 1 × 1 px")?;
        require(focal_px.into_iter().all(positive), "focal length", "above 0 and finite")?;
        require(skew_px.is_finite(), "skew", "finite")?;
        require(principal_px.iter().all(|at| at.is_finite()), "principal point", "finite")?;
        require(distortion.is_finite(), "distortion", "finite")?;
        match projection {
            Projection::FieldOfView { omega } => {
                require((0.0..PI).contains(&omega), "omega", "an angle in [0, π) rad")?;
            }
            Projection::Division { k: term } | Projection::MeasuredRadial { r: term } => {
                require(term.is_finite(), "distortion", "finite")?;
            }
            Projection::EnhancedUnified { alpha, beta } => {
                require((0.0..=1.0).contains(&alpha), "alpha", "0 to 1")?;
                require(positive(beta), "beta", "above 0 and finite")?;
            }
            Projection::Perspective | Projection::Equidistant | Projection::Equirectangular => {}
        }
        let valid_radius = valid_radius(&projection, &distortion);
        Ok(Self { intrinsics, projection, distortion, valid_radius })
    }

    /// An ideal perspective lens with this focal length in px, for pictures of `size_px` (width, height), its axis in
    /// their middle.
    ///
    /// # Errors
    /// A parameter is out of range.
    pub fn pinhole(size_px: [u32; 2], focal_px: f64) -> Result<Self, CameraError> {
        let principal_px = size_px.map(|side| 0.5 * f64::from(side));
        let intrinsics = Intrinsics { size_px, focal_px: [focal_px; 2], skew_px: 0.0, principal_px };
        Self::new(intrinsics, Projection::Perspective, Distortion::default())
    }

    /// A panorama of all directions ([`Projection::Equirectangular`]), straight ahead in its middle.
    ///
    /// # Errors
    /// A side of the picture is 0.
    pub fn panorama(size_px: [u32; 2]) -> Result<Self, CameraError> {
        let [width, height] = size_px.map(f64::from);
        let focal_px = [width / (2.0 * PI), height / PI];
        let intrinsics =
            Intrinsics { size_px, focal_px, skew_px: 0.0, principal_px: [0.5 * width, 0.5 * height] };
        Self::new(intrinsics, Projection::Equirectangular, Distortion::default())
    }

    /// Scale and position of its picture.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// Its ideal projection, before distortion.
    pub fn projection(&self) -> &Projection {
        &self.projection
    }

    /// Its deviation from the ideal projection.
    pub fn distortion(&self) -> &Distortion {
        &self.distortion
    }

    /// The valid radius: maximum distance of an ideal point from the axis, in focal lengths (for
    /// [`Projection::Equidistant`] an angle, rad); infinite if nothing folds back.
    pub fn valid_radius(&self) -> f64 {
        self.valid_radius
    }

    /// Width and height of its photographs, px.
    pub fn size_px(&self) -> [u32; 2] {
        self.intrinsics.size_px
    }

    /// Whether a pixel position, (0, 0) the picture's upper left corner, lies in the picture.
    pub fn is_in_picture(&self, pixel: DVec2) -> bool {
        let [width, height] = self.size_px().map(f64::from);
        pixel.cmpge(DVec2::ZERO).all() && pixel.x < width && pixel.y < height
    }

    /// The pixel position of a point or direction in camera space (x right, y up, z forward; any length), inside or
    /// outside the picture. `None` behind the lens and beyond the valid radius.
    pub fn project(&self, direction: DVec3) -> Option<DVec2> {
        let ideal = self.projection.plane_from_direction(direction)?;
        if self.distortion.is_none() {
            return Some(self.pixel_from_plane(ideal));
        }
        let is_valid = ideal.length_squared() <= self.valid_radius * self.valid_radius
            && (self.distortion.is_radial() || self.distortion.jacobian(ideal).determinant() > 0.0);
        is_valid.then(|| self.pixel_from_plane(self.distortion.distorted(ideal)))
    }

    /// The unit direction in camera space of a pixel position. Inverse of [`Self::project`]; `None` for a position
    /// that no direction is projected to.
    pub fn unproject(&self, pixel: DVec2) -> Option<DVec3> {
        let Intrinsics { focal_px: [fx, fy], skew_px, principal_px, .. } = self.intrinsics;
        let offset = pixel - DVec2::from(principal_px);
        let y = offset.y / fy;
        let distorted = DVec2::new((offset.x - skew_px * y) / fx, y);
        if !distorted.is_finite() {
            return None;
        }
        self.projection.direction_from_plane(self.undistorted(distorted)?)
    }

    /// The same lens for photographs scaled to `size_px` (width, height): its lengths in px scale along.
    ///
    /// # Errors
    /// A side of the picture is 0.
    pub fn resized(&self, size_px: [u32; 2]) -> Result<Self, CameraError> {
        let [across, down] = [0, 1].map(|axis| f64::from(size_px[axis]) / f64::from(self.size_px()[axis]));
        let Intrinsics { focal_px: [fx, fy], skew_px, principal_px: [cx, cy], .. } = self.intrinsics;
        let intrinsics = Intrinsics {
            size_px,
            focal_px: [fx * across, fy * down],
            skew_px: skew_px * across,
            principal_px: [cx * across, cy * down],
        };
        Self::new(intrinsics, self.projection, self.distortion)
    }

    fn pixel_from_plane(&self, point: DVec2) -> DVec2 {
        let Intrinsics { focal_px: [fx, fy], skew_px, principal_px, .. } = self.intrinsics;
        DVec2::new(fx * point.x + skew_px * point.y, fy * point.y) + DVec2::from(principal_px)
    }

    /// The ideal point that is distorted to `target`: Newton's method, starting from the inverse of the radial terms
    /// alone.
    fn undistorted(&self, target: DVec2) -> Option<DVec2> {
        /// Quadratic convergence takes about five; the rest is for lenses near their fold.
        const MAX_STEPS: usize = 40;
        /// In focal lengths: a millionth of a thousandth of a pixel of any existing camera.
        const TOLERANCE: f64 = 1e-14;
        if self.distortion.is_none() {
            return Some(target);
        }
        let radius = target.length();
        let start = match self.undistorted_radius(radius) {
            Some(start) => start,
            None if self.distortion.is_radial() => return None,
            None => self.valid_radius,
        };
        let mut q = if radius > 0.0 { target * (start / radius) } else { DVec2::ZERO };
        if self.distortion.is_radial() {
            return Some(q);
        }
        let mut error = self.distortion.distorted(q) - target;
        for _ in 0..MAX_STEPS {
            if error.length() <= TOLERANCE * (1.0 + radius) {
                break;
            }
            let jacobian = self.distortion.jacobian(q);
            if jacobian.determinant() <= 0.0 {
                return None;
            }
            let step = jacobian.inverse() * error;
            // Halve the step while that leads nearer.
            let nearer = (0..8)
                .map(|halvings| q - step * 0.5f64.powi(halvings))
                .find(|next| (self.distortion.distorted(*next) - target).length() < error.length());
            let Some(next) = nearer else { break };
            q = next;
            error = self.distortion.distorted(q) - target;
        }
        let is_met = error.length() <= 1e3 * TOLERANCE * (1.0 + radius);
        let is_valid = q.length() <= self.valid_radius && self.distortion.jacobian(q).determinant() > 0.0;
        (is_met && is_valid).then_some(q)
    }

    /// The ideal distance from the middle that the radial terms map to `radius`: Newton's method within the bounds of
    /// a bisection, as they increase within the valid radius.
    fn undistorted_radius(&self, radius: f64) -> Option<f64> {
        /// Enough to halve any interval down to two neighbouring numbers.
        const MAX_STEPS: usize = 100;
        // The distorted distance and its derivative.
        let distorted = |r: f64| {
            let [factor, slope] = self.distortion.radial_factor(r * r);
            [r * factor, factor + 2.0 * r * r * slope]
        };
        let [mut low, mut high] = [0.0, self.valid_radius];
        if distorted(high)[0] < radius {
            return None;
        }
        let mut r = radius.clamp(low, high);
        for _ in 0..MAX_STEPS {
            let [value, slope] = distorted(r);
            if value < radius {
                low = r
            } else {
                high = r
            }
            let newton = r - (value - radius) / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - r).abs() <= f64::EPSILON * r {
                return Some(next);
            }
            r = next;
        }
        Some(r)
    }
}

/// The maximum distance of an ideal point from the middle before the distortion folds back, over some bearings.
fn valid_radius(projection: &Projection, distortion: &Distortion) -> f64 {
    /// The tangent of 89.4°.
    const WIDEST: f64 = 100.0;
    /// Distances grow by this factor from the nearest on; for a rotationally symmetric lens the radius alone decides.
    const FINE: f64 = 1.01;
    /// Of all others.
    const COARSE: f64 = 1.05;
    const NEAREST: f64 = 1e-3;
    if distortion.is_none() {
        return f64::INFINITY;
    }
    let limit = if *projection == Projection::Equidistant { PI } else { WIDEST };
    let (bearings, growth) = if distortion.is_radial() { (1, FINE) } else { (8, COARSE) };
    let fold = |bearing: usize| {
        let toward = DVec2::from_angle(2.0 * PI * bearing as f64 / bearings as f64);
        let is_upright = |r: f64| distortion.jacobian(toward * r).determinant() > 0.0;
        let (mut low, mut high) = (0.0, NEAREST);
        while is_upright(high) {
            if high >= limit {
                return limit;
            }
            (low, high) = (high, (high * growth).min(limit));
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if is_upright(middle) { low = middle } else { high = middle }
        }
        low
    };
    (0..bearings).map(fold).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(projection: Projection, distortion: Distortion) -> CalibratedLens {
        let intrinsics = Intrinsics {
            size_px: [640, 480],
            focal_px: [300.0, 310.0],
            skew_px: 1.5,
            principal_px: [318.0, 243.0],
        };
        CalibratedLens::new(intrinsics, projection, distortion).unwrap()
    }

    #[test]
    fn a_pinhole_is_a_pinhole() {
        let lens = CalibratedLens::pinhole([640, 480], 500.0).unwrap();
        assert_eq!(lens.project(DVec3::new(0.0, 0.0, 2.0)), Some(DVec2::new(320.0, 240.0)));
        // Up in space is up in the picture, whose y runs down.
        assert_eq!(lens.project(DVec3::new(0.2, 0.1, 2.0)), Some(DVec2::new(370.0, 215.0)));
        assert_eq!(lens.project(DVec3::new(0.2, 0.1, -2.0)), None);
        assert_eq!(lens.valid_radius(), f64::INFINITY);
        assert!(lens.is_in_picture(DVec2::ZERO) && !lens.is_in_picture(DVec2::new(640.0, 1.0)));
    }

    #[test]
    fn nothing_is_projected_beyond_the_fold() {
        // r − 0.2r³ rises until r = √(1/0.6).
        let fold = (1.0f64 / 0.6).sqrt();
        let lens = lens(Projection::Perspective, Distortion::radial(&[-0.2]));
        assert!((lens.valid_radius() - fold).abs() < 1e-12, "{}", lens.valid_radius());
        assert!(lens.project(DVec3::new(fold - 1e-6, 0.0, 1.0)).is_some());
        assert_eq!(lens.project(DVec3::new(fold + 1e-6, 0.0, 1.0)), None);
        // The farthest pixel that anything falls on.
        let farthest = 318.0 + 300.0 * (fold - 0.2 * fold.powi(3));
        assert!(lens.unproject(DVec2::new(farthest - 1e-6, 243.0)).is_some());
        assert_eq!(lens.unproject(DVec2::new(farthest + 1e-6, 243.0)), None);
    }

    #[test]
    fn a_fold_of_one_side_leaves_the_other() {
        // x + p₂·3x² folds at x = −1/(6p₂), and only there.
        let distortion = Distortion { tangential: [0.0, 0.25], ..Distortion::default() };
        let lens = lens(Projection::Perspective, distortion);
        let at = |x: f64| lens.project(DVec3::new(x, 0.0, 1.0));
        assert!(at(-0.66).is_some() && at(-0.67).is_none() && at(5.0).is_some());
        let pixel = at(5.0).unwrap();
        let back = lens.unproject(pixel).unwrap();
        assert!((lens.project(back).unwrap() - pixel).length() < 1e-9);
    }

    #[test]
    fn a_resized_lens_sees_the_same() {
        let whole = lens(Projection::Equidistant, Distortion::radial(&[-0.02, 0.01]));
        let half = whole.resized([320, 120]).unwrap();
        let direction = DVec3::new(0.3, -0.2, 1.0);
        let [at_whole, at_half] = [whole, half].map(|lens| lens.project(direction).unwrap());
        assert!((at_half - at_whole * DVec2::new(0.5, 0.25)).length() < 1e-12);
    }

    #[test]
    fn numbers_that_no_lens_has_are_refused() {
        let good = *CalibratedLens::pinhole([640, 480], 500.0).unwrap().intrinsics();
        let field = |intrinsics, projection, distortion| {
            CalibratedLens::new(intrinsics, projection, distortion).unwrap_err().field
        };
        let none = Distortion::default();
        let ideal = Projection::Perspective;
        assert_eq!(field(Intrinsics { size_px: [0, 480], ..good }, ideal, none), "picture size");
        assert_eq!(field(Intrinsics { focal_px: [0.0, 1.0], ..good }, ideal, none), "focal length");
        assert_eq!(
            field(Intrinsics { principal_px: [f64::NAN, 1.0], ..good }, ideal, none),
            "principal point"
        );
        assert_eq!(field(good, ideal, Distortion::radial(&[f64::INFINITY])), "distortion");
        assert_eq!(field(good, Projection::FieldOfView { omega: -0.1 }, none), "omega");
        assert_eq!(field(good, Projection::EnhancedUnified { alpha: 1.5, beta: 1.0 }, none), "alpha");
    }
}
