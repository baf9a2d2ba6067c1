//! The light field.

use crate::carried::Carried;
use crate::light_change::LightChange;
use crate::samples::Samples;
use lens::Camera;
use serde::{Deserialize, Serialize};

/// The surface-aperture light field of one camera.
#[derive(Clone, Debug)]
pub struct Salf {
    /// The camera it was baked for. Its focus distance and aperture shape may change afterwards, and its
    /// aperture radius shrink; all else is fixed.
    pub camera: Camera,
    /// How far outside the frame it was sampled, px.
    pub margin_px: u32,
    /// How finely its carried light is sampled.
    pub carried: Carried,
    /// What answered what of the aperture is visible.
    pub baked_on: BakedOn,
    /// Its samples.
    pub samples: Samples,
}

/// What a light field was baked on. A graphics card answers to the precision of its floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum BakedOn {
    /// The processor.
    #[default]
    #[serde(rename = "cpu")]
    Processor,
    /// A graphics card, as far as it answered.
    #[serde(rename = "gpu")]
    Card,
}

impl BakedOn {
    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Processor => "cpu",
            Self::Card => "gpu",
        }
    }
}

/// How many samples there are of each kind, and what they take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SalfStatistics {
    /// Samples that see the whole aperture.
    pub open: usize,
    /// Samples that see part of the aperture.
    pub partial: usize,
    /// Samples of the background, which are among the others.
    pub background: usize,
    /// Samples of what is mirrored or let through, which are among the others.
    #[serde(default)]
    pub carried: usize,
    /// Bytes of all samples.
    pub bytes: usize,
    /// Of these, what the open samples take.
    pub open_bytes: usize,
    /// Of these, what the partly occluded samples take, visibility included.
    pub partial_bytes: usize,
}

impl Salf {
    /// A light field of samples that were made, not baked: as if by the processor, of standard density, and of the frame alone.
    pub fn with_samples(camera: Camera, samples: Samples) -> Self {
        let (carried, baked_on) = (Carried::Standard, BakedOn::Processor);
        Self { camera, margin_px: 0, carried, baked_on, samples }
    }

    /// The same light field in other light; `None` if a radiance is too large to be stored.
    pub fn in_light(&self, light: &LightChange) -> Option<Self> {
        Some(Self { camera: self.camera.clone(), samples: self.samples.in_light(light)?, ..*self })
    }

    /// Counts the light field's samples by kind.
    pub fn statistics(&self) -> SalfStatistics {
        let [open, partial, background, carried] = self.samples.counts();
        let [bytes, partial_bytes] = self.samples.bytes();
        let open_bytes = bytes - partial_bytes;
        SalfStatistics { open, partial, background, carried, bytes, open_bytes, partial_bytes }
    }
}
