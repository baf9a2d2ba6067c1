//! The radiance that leaves surface points: queried by the ray tracer and by the light field, provided by a light model.

use glam::{DVec2, DVec3, Vec3};
use scene::SurfacePoint;

/// Radiance that leaves the scene: the input of [`crate::truth`] and of the SALF.
pub trait Radiance: Sync {
    /// Radiance that leaves `point` toward the world position `eye`.
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance;
    /// Radiance (linear RGB) that arrives at the camera from the world direction `direction`, where the ray hits no surface.
    fn environment(&self, direction: DVec3) -> Vec3;

    /// The same as [`Self::outgoing`] for one of several points of which only the mean is used: each may be noisier than a single one.
    fn outgoing_sample(&self, point: SurfacePoint, eye: DVec3, _slot: SampleSlot) -> OutgoingRadiance {
        self.outgoing(point, eye)
    }

    /// Whether [`Self::incident_batch`] returns light, so that points should be passed many at a time.
    fn supports_batches(&self) -> bool {
        false
    }

    /// The light that arrives at points which lie close together in the picture seen from `eye`, interpolated from few of them. One
    /// element per point, to be passed on in [`SampleSlot::incident`]; `None` for a point that has to be computed by itself.
    fn incident_batch(&self, points: &[ShadingPoint], _eye: DVec3) -> Vec<Option<IncidentLight>> {
        vec![None; points.len()]
    }

    /// The width (rad) of the narrowest lobe of a point's carried light, which bounds how fast that light changes with the eye's
    /// position: 0 for a mirror. `None` where nothing is carried.
    fn carried_lobe_width(&self, _point: SurfacePoint) -> Option<f64> {
        None
    }

    /// The width (rad) of the narrowest lobe of a point's own light, as in [`Self::carried_lobe_width`]. `None` where the same
    /// radiance leaves toward all of an aperture.
    fn own_lobe_width(&self, _point: SurfacePoint) -> Option<f64> {
        None
    }

    /// Whether outgoing radiance may differ between points less than a pixel apart, as it does on textured surfaces.
    fn varies_within_pixel(&self, _point: SurfacePoint) -> bool {
        true
    }

    /// The sum of the parts of [`Self::outgoing`].
    fn total_outgoing(&self, point: SurfacePoint, eye: DVec3) -> Vec3 {
        self.outgoing(point, eye).total()
    }
}

/// The position of one point in a group of which only the mean is used. Random choices are stratified over the group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleSlot {
    /// The same for the whole group, different for other groups.
    pub seed: u64,
    /// Index in the group, below `count`.
    pub index: u32,
    /// Size of the group.
    pub count: u32,
    /// The light that arrives at the group, if it has been computed.
    pub incident: Option<IncidentLight>,
    /// Whether only own light is needed.
    pub own_only: bool,
}

impl SampleSlot {
    /// A group of one point, without incident light computed before; `seed` selects its random numbers.
    pub fn single(seed: u64) -> Self {
        Self { seed, index: 0, count: 1, incident: None, own_only: false }
    }
}

/// A surface point that represents a part of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingPoint {
    /// The point.
    pub point: SurfacePoint,
    /// Its position in the picture, px.
    pub pixel: DVec2,
}

/// Light that arrives at a point from all directions, as wide lobes respond to it: irradiance/π at a unit normal **n** is
/// `isotropic` + `vector_irradiance`·**n**, linear RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IncidentLight {
    /// The part that does not depend on the normal.
    pub isotropic: Vec3,
    /// Vector irradiance/π (Gershun 1936), by x, y and z of the world.
    pub vector_irradiance: [Vec3; 3],
    /// The own light that rough gloss sends toward the eye, relative to what it would send under uniform light of radiance 1.
    /// `None` where every point has to be computed by itself.
    pub gloss: Option<Vec3>,
}

/// The radiance that leaves a point toward another, linear RGB, split by how the focus paint treats it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutgoingRadiance {
    /// Emitted light, and light scattered diffusely or by rough gloss: it obeys the paint.
    pub own: Vec3,
    /// Mirrored or transmitted light: it keeps the focus of the ordinary lens.
    pub carried: Vec3,
    /// The share of the point's coverage that belongs to `carried`, in [0, 1]; `own` has the rest.
    pub carried_share: f32,
    /// The parts of `own` and of `carried` that rare paths contribute: unbiased in the mean, but with a high variance at one point.
    pub noisy: [Vec3; 2],
}

impl IncidentLight {
    /// This light plus `factor` times another, linear RGB.
    pub fn plus_scaled(&self, other: &Self, factor: f64) -> Self {
        let factor = factor as f32;
        let vector_irradiance =
            std::array::from_fn(|axis| self.vector_irradiance[axis] + other.vector_irradiance[axis] * factor);
        let gloss = self.gloss.zip(other.gloss).map(|(own, other)| own + other * factor);
        Self { isotropic: self.isotropic + other.isotropic * factor, vector_irradiance, gloss }
    }

    /// Irradiance/π at a unit normal; negative where more light has been subtracted than there was.
    pub fn irradiance_over_pi(&self, normal: DVec3) -> Vec3 {
        let [x, y, z] = self.vector_irradiance;
        let [by_x, by_y, by_z] = normal.as_vec3().to_array();
        self.isotropic + x * by_x + y * by_y + z * by_z
    }
}

impl OutgoingRadiance {
    /// Radiance, linear RGB, all of which obeys the paint.
    pub fn from_own(own: Vec3) -> Self {
        Self { own, ..Self::default() }
    }

    /// The sum of own and carried radiance, linear RGB.
    pub fn total(&self) -> Vec3 {
        self.own + self.carried
    }
}
