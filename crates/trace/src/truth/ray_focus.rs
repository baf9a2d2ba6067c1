//! Focusing ray by ray: the general model of which painting is a special case.

use scene::SurfacePoint;

/// How one ray is focused: refracted with a focal length f, then followed for a transmission distance T.
///
/// The general image formation F = T(t)∘R(f)∘T(z) lets both be any function of the ray. Here a ray is its
/// point of origin (whose depth is z) and its aperture point, and after T it is projected onto the sensor
/// along its chief ray, as painted light is (see [`lens::Optics::kappa_of_ray`]). With one f and T for all
/// rays of a point this is what painting does; with T or f changing over the aperture it is a lens with
/// aberrations of its own at every point: astigmatism, spherical aberration, coded focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayOptics {
    /// 1/f, 1/length; 0 does not refract.
    pub inverse_focal_length: f64,
    /// T, length.
    pub transmission_distance: f64,
}

/// Experimental: a focal length and a transmission distance for every ray, in place of a painted focus.
pub trait RayFocus: Sync {
    /// The optics of the ray from `point` (`None`: the background) through the aperture point `u`, given in
    /// [−1, 1]². Both numbers must be finite and within [`Self::bounds`].
    fn optics(&self, point: Option<SurfacePoint>, u: glam::DVec2) -> RayOptics;
    /// The least and the greatest of each number. What lands outside of the picture within these bounds is
    /// never traced.
    fn bounds(&self) -> [RayOptics; 2];
}
