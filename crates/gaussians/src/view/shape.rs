//! The shape of a splat in camera space, whitened.
//!
//! The covariance S of a splat grows by the low-pass g = 0.3 (z/f)² across its chief ray r:
//!
//! ```text
//! S′ = M Mᵀ + g (I − r rᵀ) = N Nᵀ,   N = [M | √g e₁ | √g e₂],   M = A R diag(s)
//! ```
//!
//! with e₁, e₂ and r orthonormal. N = L Q by orthogonalising the three rows of N, and so S′⁻¹ = WᵀW with W = L⁻¹, a lower triangle. Neither
//! S nor its inverse is ever formed: scales may differ by a factor of 10⁴, their squares by 10⁸.

use crate::cloud::Splat;
use glam::{DMat3, DQuat, DVec3};

/// Variance of the low-pass through which a cloud is trained, px².
pub const LOW_PASS_PX2: f64 = 0.3;

/// The thinnest axis of a splat, as a share of its longest: thinner ones look the same.
pub(super) const MIN_AXIS: f64 = 1e-4;

/// Responses below it do not count, as in training.
pub(crate) const MIN_ALPHA: f64 = 1.0 / 255.0;

/// How far splats grow across their chief rays, and what of their opacity is left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Growth {
    /// The focal length of the picture, px.
    pub focal_px: f64,
    /// Whether the cloud was trained with its low-pass compensated in opacity.
    pub is_antialiased: bool,
    /// A further variance, px², compensated in opacity: other programs' blur. 0: none.
    pub dilation_px2: f64,
}

/// A splat before a camera.
#[derive(Clone, Copy)]
pub(crate) struct CameraShape {
    /// Camera space.
    pub mean: DVec3,
    /// W, row by row.
    whitening: [f64; 6],
    /// The response at the mean; the loss of the low-pass is in it for clouds that were trained so.
    pub opacity: f64,
    /// The squared distance, in standard deviations, at which the response is [`MIN_ALPHA`].
    pub cutoff: f64,
}

impl CameraShape {
    /// The shape of `splat`, whose mean is at `mean` in camera space; `None` if its response is nowhere great enough, or the aperture's centre
    /// is inside it.
    ///
    /// `camera_from_file` is the linear map of vectors.
    pub fn new(splat: &Splat, mean: DVec3, camera_from_file: &DMat3, growth: Growth) -> Option<Self> {
        let Growth { focal_px, is_antialiased, dilation_px2 } = growth;
        let px2 = (mean.z / focal_px).powi(2);
        let (trained, low_pass) = (LOW_PASS_PX2 * px2, (LOW_PASS_PX2 + dilation_px2) * px2);
        let scale = splat.log_scale.as_dvec3().exp();
        let scale = scale.max(DVec3::splat(MIN_AXIS * scale.max_element().max(low_pass.sqrt())));
        let rotation =
            DMat3::from_quat(DQuat::from_array(splat.rotation.to_array().map(f64::from)).normalize());
        let m = *camera_from_file * rotation * DMat3::from_diagonal(scale);
        let (e1, e2) = mean.normalize().any_orthonormal_pair();
        let (spread1, spread2) = (low_pass.sqrt() * e1, low_pass.sqrt() * e2);
        let rows = [0, 1, 2].map(|k| {
            let row = m.row(k);
            [row.x, row.y, row.z, spread1[k], spread2[k]]
        });
        let mut opacity = f64::from(splat.opacity);
        if is_antialiased || dilation_px2 > 0.0 {
            // The squared area of the projected ellipse as it grows: |a × b|², with a and b the extents along e₁ and e₂.
            let (a, b) = (m.transpose() * e1, m.transpose() * e2);
            let area = a.cross(b).length_squared();
            let grown = |by: f64| area + by * (a.length_squared() + b.length_squared()) + by * by;
            let before = if is_antialiased { area } else { grown(trained) };
            opacity *= (before / grown(low_pass)).sqrt();
        }
        let cutoff = 2.0 * (opacity / MIN_ALPHA).ln();
        let shape = Self { mean, whitening: inverse_triangle(rows), opacity, cutoff };
        let is_finite = shape.whitening.iter().all(|w| w.is_finite()) && mean.is_finite();
        let is_outside = shape.whitened(mean).length_squared() > cutoff;
        (cutoff > 0.0 && is_finite && is_outside).then_some(shape)
    }

    /// W v.
    #[inline]
    pub fn whitened(&self, v: DVec3) -> DVec3 {
        let [a, b, c, d, e, f] = self.whitening;
        DVec3::new(a * v.x, b * v.x + c * v.y, d * v.x + e * v.y + f * v.z)
    }

    /// S′ from L = W⁻¹: its elements xx, xy, yy, xz, yz, zz.
    pub fn covariance(&self) -> [f64; 6] {
        let [a, b, c, d, e, f] = self.whitening;
        let (l11, l22, l33) = (1.0 / a, 1.0 / c, 1.0 / f);
        let l21 = -b * l11 * l22;
        let l31 = -(d * l11 + e * l21) * l33;
        let l32 = -e * l22 * l33;
        [
            l11 * l11,
            l21 * l11,
            l21 * l21 + l22 * l22,
            l31 * l11,
            l31 * l21 + l32 * l22,
            l31 * l31 + l32 * l32 + l33 * l33,
        ]
    }
}

/// The inverse of L in N = L Q, Q with orthonormal rows, by Gram and Schmidt (modified): a lower triangle, row by row.
fn inverse_triangle(mut rows: [[f64; 5]; 3]) -> [f64; 6] {
    let dot = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut l = [[0.0; 3]; 3];
    for i in 0..3 {
        l[i][i] = dot(&rows[i], &rows[i]).sqrt();
        rows[i] = rows[i].map(|x| x / l[i][i]);
        for j in i + 1..3 {
            l[j][i] = dot(&rows[j], &rows[i]);
            rows[j] = std::array::from_fn(|k| rows[j][k] - l[j][i] * rows[i][k]);
        }
    }
    let (w11, w22, w33) = (1.0 / l[0][0], 1.0 / l[1][1], 1.0 / l[2][2]);
    let w21 = -l[1][0] * w11 * w22;
    let w31 = -(l[2][0] * w11 + l[2][1] * w21) * w33;
    let w32 = -l[2][1] * w22 * w33;
    [w11, w21, w22, w31, w32, w33]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    fn growth(focal_px: f64) -> Growth {
        Growth { focal_px, is_antialiased: false, dilation_px2: 0.0 }
    }

    fn splat(log_scale: Vec3) -> Splat {
        let rotation = Quat::from_xyzw(0.3, -0.2, 0.7, 0.5).normalize();
        Splat { mean: Vec3::ZERO, rotation, log_scale, opacity: 0.8, base_color: Vec3::ZERO }
    }

    /// W whitens: Wᵀ-coordinates of the axes of the splat have their lengths over the standard deviations, whatever their ratio.
    #[test]
    fn extreme_scales_are_whitened() {
        let mean = DVec3::new(0.4, -0.3, 2.0);
        for ratio in [1.0, 1e-2, 1e-4] {
            let s = splat(Vec3::new(0.05, 0.02, 0.05 * ratio as f32).map(f32::ln));
            // So fine a picture that the low-pass vanishes against the thinnest axis.
            let shape = CameraShape::new(&s, mean, &DMat3::IDENTITY, growth(1e9)).unwrap();
            let rotation = DMat3::from_quat(s.rotation.as_dquat().normalize());
            let scale = s.log_scale.as_dvec3().exp();
            for axis in 0..3 {
                let whitened = shape.whitened(rotation.col(axis) * scale[axis]);
                assert!((whitened.length() - 1.0).abs() < 1e-6, "{ratio} {axis}: {}", whitened.length());
                let other = shape.whitened(rotation.col((axis + 1) % 3) * scale[(axis + 1) % 3]);
                assert!(whitened.dot(other).abs() < 1e-6, "{ratio} {axis}: {}", whitened.dot(other));
            }
        }
    }

    #[test]
    fn the_low_pass_grows_across_the_chief_ray_alone() {
        let (mean, focal_px) = (DVec3::new(0.4, -0.3, 2.0), 100.0);
        let s = splat(Vec3::new(0.05, 0.02, 0.01).map(f32::ln));
        let shape = CameraShape::new(&s, mean, &DMat3::IDENTITY, growth(focal_px)).unwrap();
        let rotation = DMat3::from_quat(s.rotation.as_dquat().normalize());
        let scale = DMat3::from_diagonal(s.log_scale.as_dvec3().exp());
        let before = (rotation * scale) * (rotation * scale).transpose();
        let r = mean.normalize();
        let (e1, _) = r.any_orthonormal_pair();
        let [xx, xy, yy, xz, yz, zz] = shape.covariance();
        let after = DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz));
        let along = |m: DMat3, v: DVec3| v.dot(m * v);
        assert!((along(after, r) / along(before, r) - 1.0).abs() < 1e-9);
        let grown = 0.3 * (2.0 / focal_px) * (2.0 / focal_px);
        assert!((along(after, e1) - along(before, e1) - grown).abs() < 1e-12);
        // W is the inverse of L: WᵀW S′ = I.
        let v = DVec3::new(0.3, 0.5, -0.2);
        assert!((shape.whitened(after * v).length_squared() - along(after, v)).abs() < 1e-9);
    }

    #[test]
    fn compensated_clouds_fade_where_they_are_smaller_than_a_pixel() {
        let (mean, focal_px) = (DVec3::new(0.0, 0.0, 2.0), 100.0);
        let small = splat(Vec3::splat((0.01f32).ln()));
        let plain = CameraShape::new(&small, mean, &DMat3::IDENTITY, growth(focal_px)).unwrap();
        let compensated = Growth { is_antialiased: true, ..growth(focal_px) };
        let faded = CameraShape::new(&small, mean, &DMat3::IDENTITY, compensated).unwrap();
        assert!((plain.opacity - 0.8).abs() < 1e-7);
        // A sphere of ½ px: its area is that of ¼ px², that after the low-pass of 0.55 px².
        assert!((faded.opacity / plain.opacity - 0.25 / 0.55).abs() < 1e-6, "{}", faded.opacity);
    }

    #[test]
    fn what_is_dilated_keeps_its_light() {
        let (mean, focal_px) = (DVec3::new(0.0, 0.0, 2.0), 100.0);
        let small = splat(Vec3::splat((0.01f32).ln()));
        let dilated = Growth { dilation_px2: 4.0, ..growth(focal_px) };
        let plain = CameraShape::new(&small, mean, &DMat3::IDENTITY, growth(focal_px)).unwrap();
        let wide = CameraShape::new(&small, mean, &DMat3::IDENTITY, dilated).unwrap();
        // A sphere of ½ px: 0.55 px² after the low-pass, 4.55 px² after the dilation; so is the area of its outline.
        assert!((wide.opacity / plain.opacity - 0.55 / 4.55).abs() < 1e-6, "{}", wide.opacity);
        let grown = wide.covariance()[0] - plain.covariance()[0];
        assert!((grown - 4.0 * (2.0 / focal_px) * (2.0 / focal_px)).abs() < 1e-9, "{grown}");
    }

    #[test]
    fn what_surrounds_the_aperture_is_left_out() {
        let mean = DVec3::new(0.0, 0.0, 2.0);
        let shape = |size: f32| {
            CameraShape::new(&splat(Vec3::splat(size.ln())), mean, &DMat3::IDENTITY, growth(100.0)).is_some()
        };
        assert!(shape(0.5) && !shape(2.0));
    }
}
