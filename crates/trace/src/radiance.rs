//! What light leaves surface points: asked by the ray tracer and by the light field, answered by whoever knows the light.

use glam::{DVec2, DVec3, Vec3};
use scene::SurfacePoint;

/// Radiance that leaves the scene: what [`truth`] and the SALF gather.
pub trait Radiance: Sync {
    /// Radiance leaving `point` toward the world position `eye`.
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance;
    /// Linear RGB radiance arriving at the camera from the world direction `direction` where no surface is.
    #[allow(clippy::wrong_self_convention, reason = "light comes from infinity; nothing is converted")]
    fn environment(&self, direction: DVec3) -> Vec3;

    /// The same of one of several points whose mean is wanted: each may be told less well.
    fn outgoing_sample(&self, point: SurfacePoint, eye: DVec3, _slot: SampleSlot) -> OutgoingRadiance {
        self.outgoing(point, eye)
    }

    /// Whether [`Self::received`] tells anything, so that spots are to be asked many at once.
    fn supports_batches(&self) -> bool {
        false
    }

    /// What light spots receive that lie close together in the picture that `eye` sees: told of many at once, since a few of
    /// them tell most. `None` of a spot that has to be asked by itself. One answer a spot, for [`Among::received`] of its points.
    fn incident_batch(&self, points: &[ShadingPoint], _eye: DVec3) -> Vec<Option<IncidentLight>> {
        vec![None; points.len()]
    }

    /// How fast the carried light of a point changes with where the eye is: the width of its narrowest lobe, rad, 0 of a mirror.
    /// `None` where nothing is carried.
    fn carried_lobe_width(&self, _point: SurfacePoint) -> Option<f64> {
        None
    }

    /// How fast the own light of a point changes with where the eye is, as [`Self::carried_width`] tells of what is carried. `None` where
    /// the same leaves toward all of an aperture.
    fn own_lobe_width(&self, _point: SurfacePoint) -> Option<f64> {
        None
    }

    /// Whether what leaves may differ between neighbouring points that are closer together than a pixel, as it does where there are
    /// textures.
    fn varies_within_pixel(&self, _point: SurfacePoint) -> bool {
        true
    }

    /// All of [`Self::leaving`].
    fn total_outgoing(&self, point: SurfacePoint, eye: DVec3) -> Vec3 {
        self.outgoing(point, eye).total()
    }
}

/// Which of several points it is whose mean is wanted. What is drawn for all of them is spread evenly over all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleSlot {
    /// The same for all of them, another one elsewhere.
    pub seed: u64,
    /// Below `count`.
    pub index: u32,
    /// How many they are.
    pub count: u32,
    /// What light they receive, if that is known.
    pub incident: Option<IncidentLight>,
    /// Whether only what is own is wanted.
    pub own_only: bool,
}

impl SampleSlot {
    /// The only one, of which nothing is known.
    pub fn single(seed: u64) -> Self {
        Self { seed, index: 0, count: 1, incident: None, own_only: false }
    }
}

/// A surface point that stands for a part of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingPoint {
    /// The point.
    pub point: SurfacePoint,
    /// Where it is in the picture, px.
    pub pixel: DVec2,
}

/// Light that a spot receives from all around, as lobes see it that are spread: irradiance/π at a normal **n** is
/// `even` + `flow`·**n**, linear RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IncidentLight {
    /// What does not depend on the normal.
    pub isotropic: Vec3,
    /// Vector irradiance/π (Gershun 1936), by x, y and z of the world.
    pub vector_irradiance: [Vec3; 3],
    /// What rough gloss sends of it toward the eye that is own, over what it would send of light that is 1 from everywhere; none
    /// where every point has to be asked.
    pub gloss: Option<Vec3>,
}

/// The radiance that leaves a point toward another, linear RGB, by what the focus paint does with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutgoingRadiance {
    /// Emitted, scattered diffusely or by rough gloss: it obeys the paint.
    pub own: Vec3,
    /// Mirrored or let through: it keeps the focus of the ordinary lens.
    pub carried: Vec3,
    /// The share of the point's coverage that `carried` has, in [0, 1]; `own` has the rest.
    pub carried_share: f32,
    /// What of `own` and of `carried` single paths found where few do: it may be far off for one point, though right in the mean.
    pub noisy: [Vec3; 2],
}

impl IncidentLight {
    /// This and `factor` times another.
    pub fn plus_scaled(&self, other: &Self, factor: f64) -> Self {
        let factor = factor as f32;
        let vector_irradiance =
            std::array::from_fn(|axis| self.vector_irradiance[axis] + other.vector_irradiance[axis] * factor);
        let gloss = self.gloss.zip(other.gloss).map(|(own, other)| own + other * factor);
        Self { isotropic: self.isotropic + other.isotropic * factor, vector_irradiance, gloss }
    }

    /// Irradiance/π at a normal (unit); below 0 where more is taken away than is there.
    pub fn irradiance_over_pi(&self, normal: DVec3) -> Vec3 {
        let [x, y, z] = self.vector_irradiance;
        let [by_x, by_y, by_z] = normal.as_vec3().to_array();
        self.isotropic + x * by_x + y * by_y + z * by_z
    }
}

impl OutgoingRadiance {
    /// Radiance that obeys the paint, and nothing else.
    pub fn from_own(own: Vec3) -> Self {
        Self { own, ..Self::default() }
    }

    /// Both together.
    pub fn total(&self) -> Vec3 {
        self.own + self.carried
    }
}
