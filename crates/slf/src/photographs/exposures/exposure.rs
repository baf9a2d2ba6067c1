//! Photometric model of a photograph: gains and vignetting.

use glam::{DVec2, Vec3};
use scene::View;

/// How a photograph renders light.
#[derive(Clone, Copy, Debug, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Exposure {
    /// Gain of red, green and blue, stops; the mean over all photographs is 0 in each channel.
    pub gain_stops: [f64; 3],
    /// k₁ and k₂: falloff added by r² and r⁴, stops.
    pub vignetting_stops: [f64; 2],
}

impl Exposure {
    /// Factor from the photograph's linear values to radiance at a pixel position of the view, by channel.
    pub fn to_radiance(&self, view: &View, pixel: DVec2) -> Vec3 {
        let falloff = self.falloff_stops(view, pixel);
        Vec3::from_array(self.gain_stops.map(|gain| (-(gain + falloff)).exp2() as f32))
    }

    /// Upper bound of [`Self::to_radiance`] over the picture and its channels.
    pub(crate) fn max_to_radiance(&self, view: &View) -> f32 {
        // k₁·r² + k₂·r⁴ over r² in [0, max] is least at an end or where its slope is 0.
        let [k1, k2] = self.vignetting_stops;
        let size = DVec2::from(view.lens.size_px().map(f64::from));
        let corners = [DVec2::ZERO, size, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y)];
        let max_r2 = corners.map(|corner| radius_squared(view, corner)).into_iter().fold(0.0, f64::max);
        let turn = if k2 > 0.0 { (-k1 / (2.0 * k2)).clamp(0.0, max_r2) } else { 0.0 };
        let falloff = [0.0, max_r2, turn].map(|r2| (k1 + k2 * r2) * r2).into_iter().fold(0.0, f64::min);
        let gain = self.gain_stops.into_iter().fold(f64::INFINITY, f64::min);
        (-(gain + falloff)).exp2() as f32
    }

    fn falloff_stops(&self, view: &View, pixel: DVec2) -> f64 {
        let [k1, k2] = self.vignetting_stops;
        let r2 = radius_squared(view, pixel);
        (k1 + k2 * r2) * r2
    }
}

/// r² as defined in the module documentation.
pub(super) fn radius_squared(view: &View, pixel: DVec2) -> f64 {
    let intrinsics = view.lens.intrinsics();
    let half_diagonal = DVec2::from(intrinsics.size_px.map(f64::from)).length() / 2.0;
    (pixel - DVec2::from(intrinsics.principal_px)).length_squared() / (half_diagonal * half_diagonal)
}
