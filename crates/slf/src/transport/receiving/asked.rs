//! Spots, and what they are asked with.

use super::super::Transport;
use crate::irradiance::Irradiance;
use crate::irradiance::place::Place;
use crate::lights::LightSample;
use crate::media::MediumStack;
use glam::DVec3;
use trace::ShadingPoint;

/// Some spots of a picture, as rays ask about them.
pub(super) struct PointBatch<'a> {
    pub transport: &'a Transport,
    pub irradiance: &'a Irradiance,
    pub points: &'a [ShadingPoint],
    pub eye: DVec3,
    /// Directions of the sky, many more than are drawn for a spot.
    pub sky_samples: &'a [LightSample],
    pub places: Vec<Place>,
    pub is_front: Vec<bool>,
    pub inside: Vec<MediumStack>,
}

impl PointBatch<'_> {
    /// How many lights are drawn for a point asked alone.
    pub fn lights_per_point(&self) -> u32 {
        self.transport.options.light_samples
    }

    /// The normal of a spot's triangle, on the front.
    pub fn geometric_normal(&self, index: usize) -> DVec3 {
        self.transport.scene().area_normal(self.points[index].point.triangle).normalize_or_zero()
    }
}
