//! A batch of picture points.

use super::super::Transport;
use crate::irradiance::Irradiance;
use crate::irradiance::place::Place;
use crate::lights::LightSample;
use crate::media::MediumStack;
use glam::DVec3;
use trace::ShadingPoint;

/// Points of a picture, prepared for measurement.
pub(super) struct PointBatch<'a> {
    pub transport: &'a Transport,
    pub irradiance: &'a Irradiance,
    pub points: &'a [ShadingPoint],
    pub eye: DVec3,
    /// Directions of the sky, many more than are sampled for a point.
    pub sky_samples: &'a [LightSample],
    pub places: Vec<Place>,
    pub is_front: Vec<bool>,
    pub inside: Vec<MediumStack>,
}

impl PointBatch<'_> {
    /// The number of light samples of a single point.
    pub fn lights_per_point(&self) -> u32 {
        self.transport.options.light_samples
    }

    /// Unit normal of the triangle of the point with this number, on the front (world).
    pub fn geometric_normal(&self, index: usize) -> DVec3 {
        self.transport.scene().area_normal(self.points[index].point.triangle).normalize_or_zero()
    }
}
