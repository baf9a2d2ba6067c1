//! Light fields in other light: what is baked stays.

use crate::light_field::{BakedField, LightField};
use graphics_card::Gpu;
use render::Modelled;
use salf::LightChange;
use splat::Tolerance;
use std::sync::Arc;

/// A light field without its sums, that can be shown in other light.
pub(crate) struct Relightable {
    /// It and where its samples are.
    pub baked: BakedField,
    /// What it holds, counted.
    pub modelled: Modelled,
    /// By how many passes its light was refined.
    pub light_passes: u32,
    /// Tolerance of its sums.
    pub tolerance: Tolerance,
}

impl From<&LightField> for Relightable {
    fn from(field: &LightField) -> Self {
        Self {
            baked: field.baked(),
            modelled: field.modelled(),
            light_passes: field.light_passes(),
            tolerance: field.tolerance(),
        }
    }
}

impl Relightable {
    /// The light field in other light, not summed; `None` if that is too bright to be stored.
    pub fn in_light(&self, light: &LightChange, gpu: Option<Gpu>) -> Option<LightField> {
        let salf = Arc::new(self.baked.salf.in_light(light)?);
        let index = Arc::new(self.baked.index.of_same_places(salf.clone()));
        let field = LightField::resting(salf, index, self.modelled, self.tolerance, gpu);
        Some(field.refined(self.light_passes))
    }
}

impl LightField {
    /// The share of its samples on triangles that `selects`, `None` being the background.
    pub fn share_of_samples(&self, selects: impl Fn(Option<u32>) -> bool) -> f64 {
        let salf = self.baked().salf;
        let mut addresses = salf.samples.addresses();
        let count = salf.samples.len() as u32;
        let triangle = |index| addresses.get(index).surface.map(|point| point.triangle);
        let selected = (0..count).map(triangle).filter(|triangle| selects(*triangle)).count();
        selected as f64 / f64::from(count.max(1))
    }
}
