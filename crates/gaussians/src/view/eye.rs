//! One aperture point: the splats as its rays meet them.
//!
//! A ray from U in direction D (D.z = 1, so that its parameter is the depth) meets a Gaussian of mean m and inverse covariance WᵀW most where its
//! response is greatest:
//!
//! ```text
//! p = W (m − U)      q = W D
//! z = p·q / q·q      d² = |p × q|² / q·q      α = min(0.99, o e^(−d²/2))
//! ```
//!
//! | symbol | meaning |
//! | --- | --- |
//! | z | depth of the greatest response |
//! | d | distance of the ray from the mean, in standard deviations |
//! | o | the splat's opacity |
//! | α | share of the light behind it that it stops; below 1/255 none |
//!
//! d² is that of mᵀPm − (DᵀPm)²/DᵀPD without its cancellation. In order of the means' depth, w = α Π (1 − α) over those before.

use super::shape::MIN_ALPHA;
use super::{GaussianView, MAX_ALPHA};
use crate::cloud::{ColorSpace, srgb_to_linear};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// A ray of which so little is left that what follows does not count.
pub(super) const MIN_TRANSMITTANCE: f64 = 1e-4;

/// A splat that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The splat, an index into the view.
    pub splat: u32,
    /// Share of the light behind it that it stops.
    pub alpha: f64,
    /// Share of the ray that it sends: its α times what those before let through.
    pub weight: f64,
    /// Depth of its greatest response.
    pub depth: f64,
}

/// The view from an aperture point.
pub struct Eye<'v> {
    view: &'v GaussianView<'v>,
    point: DVec2,
    /// W (m − U) of each splat.
    whitened_means: Vec<DVec3>,
}

impl<'v> Eye<'v> {
    /// The eye at the aperture point `u`, scene units from the aperture's centre.
    pub fn new(view: &'v GaussianView<'v>, u: DVec2) -> Self {
        let whitened = |splat: &super::ViewSplat| splat.shape.whitened(splat.shape.mean - u.extend(0.0));
        Self { view, point: u, whitened_means: view.splats().par_iter().map(whitened).collect() }
    }

    /// The aperture point, scene units from the aperture's centre.
    pub fn point(&self) -> DVec2 {
        self.point
    }

    /// The view.
    pub fn view(&self) -> &'v GaussianView<'v> {
        self.view
    }

    /// The splats that the ray in `direction` (camera space, z = 1) meets until nearly nothing of it is left, in order of the depth of their means.
    /// Tests every splat: for single rays.
    pub fn hits(&self, direction: DVec3) -> Vec<Hit> {
        self.trace(direction, MIN_TRANSMITTANCE)
    }

    /// The same, however little is left of the ray.
    pub fn all_hits(&self, direction: DVec3) -> Vec<Hit> {
        self.trace(direction, 0.0)
    }

    fn trace(&self, direction: DVec3, min_transmittance: f64) -> Vec<Hit> {
        let (mut hits, mut transmittance) = (Vec::new(), 1.0);
        for (splat, p) in (0..).zip(&self.whitened_means) {
            let shape = &self.view.splats()[splat as usize].shape;
            let q = shape.whitened(direction);
            let (qq, pq) = (q.length_squared(), p.dot(q));
            // d² > cutoff, without the division; and what is behind the aperture is not met.
            let distance = p.cross(q).length_squared();
            if distance > shape.cutoff * qq || pq <= 0.0 {
                continue;
            }
            let alpha = (shape.opacity * (-0.5 * distance / qq).exp()).min(MAX_ALPHA);
            if alpha < MIN_ALPHA {
                continue;
            }
            hits.push(Hit { splat, alpha, weight: alpha * transmittance, depth: pq / qq });
            transmittance *= 1.0 - alpha;
            if transmittance < min_transmittance {
                break;
            }
        }
        hits
    }

    /// W (m − U) of a splat.
    pub(super) fn whitened_mean(&self, splat: u32) -> DVec3 {
        self.whitened_means[splat as usize]
    }

    /// The gradient of 1/z of the splat's greatest response over the direction's x and y:
    ///
    /// ```text
    /// 1/z = q·q / p·q      ∂(1/z) = (2 q·w − (1/z) p·w) / p·q,   w the column of W
    /// ```
    pub fn inverse_depth_gradient(&self, splat: u32, direction: DVec3) -> DVec2 {
        let shape = &self.view.splats()[splat as usize].shape;
        let p = self.whitened_means[splat as usize];
        let q = shape.whitened(direction);
        let pq = p.dot(q);
        let inverse_depth = q.length_squared() / pq;
        let along = |axis: DVec3| {
            let w = shape.whitened(axis);
            (2.0 * q.dot(w) - inverse_depth * p.dot(w)) / pq
        };
        DVec2::new(along(DVec3::X), along(DVec3::Y))
    }

    /// The colour of a splat as it is blended: that of its file.
    pub fn color(&self, splat: u32) -> Vec3 {
        let splat = &self.view.splats()[splat as usize];
        let direction = (splat.shape.mean - self.point.extend(0.0)).normalize();
        let direction = self.view.file_direction(direction).normalize();
        self.view.cloud().color(splat.index as usize, direction.as_vec3())
    }

    /// The linear light of a colour as it is blended.
    pub fn decoded(&self, color: Vec3) -> Vec3 {
        match self.view.cloud().traits().color_space {
            ColorSpace::Srgb => color.map(srgb_to_linear),
            ColorSpace::Linear => color,
        }
    }
}
