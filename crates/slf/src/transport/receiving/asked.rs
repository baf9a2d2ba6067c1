//! Spots, and what they are asked with.

use super::super::Transport;
use crate::irradiance::Irradiance;
use crate::irradiance::place::Place;
use crate::lights::LightSample;
use crate::media::Inside;
use glam::DVec3;
use trace::Spot;

/// Some spots of a picture, as rays ask about them.
pub(super) struct Asked<'a> {
    pub transport: &'a Transport,
    pub irradiance: &'a Irradiance,
    pub spots: &'a [Spot],
    pub eye: DVec3,
    /// Directions of the sky, many more than are drawn for a spot.
    pub sky: &'a [LightSample],
    pub places: Vec<Place>,
    pub is_front: Vec<bool>,
    pub inside: Vec<Inside>,
}

impl Asked<'_> {
    /// How many lights are drawn for a point asked alone.
    pub fn light_samples(&self) -> u32 {
        self.transport.options.light_samples
    }

    /// The normal of a spot's triangle, on the front.
    pub fn geometric(&self, spot: usize) -> DVec3 {
        self.transport.scene().area_normal(self.spots[spot].point.triangle).normalize_or_zero()
    }
}
