//! The lens that a picture is summed with, and where it sends samples.

use crate::aperture_image::ApertureImage;
use crate::kernel::Kernel;
use lens::{Aperture, FocusOffset, Optics};
use salf::Sample;
use scene::SurfaceField;

/// A larger splat leaves less than half a quantum in any pixel, however bright ([`crate::fixed_point::BRIGHTEST`]): nothing.
const WIDEST_PX: f64 = (1u64 << 30) as f64;

/// Aperture and optics of one picture, in units of the baked aperture.
pub struct SplatLens {
    kernel: Kernel,
    optics: Optics,
}

/// How a sample is summed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its defocus.
    pub kappa: f64,
    /// How fast its defocus changes with its depth, as a share of the unpainted: ∂κ/∂(1/s − 1/z) = t·(1 − a).
    pub depth_share: f64,
    /// Whether it is unpainted.
    pub is_standard: bool,
}

impl SplatLens {
    /// A lens of `optics`, which may be stopped down from `baked_radius`.
    pub fn new(aperture: &Aperture, optics: Optics, baked_radius: f64) -> Self {
        let stop = if baked_radius > 0.0 { (optics.aperture_radius / baked_radius).min(1.0) } else { 1.0 };
        let kernel = Kernel::new(aperture, stop);
        Self { kernel, optics: Optics { aperture_radius: baked_radius, ..optics } }
    }

    /// Where `focus` sends a sample.
    pub fn place(&self, sample: &Sample, focus: &dyn SurfaceField<FocusOffset>) -> Placed {
        let offset =
            sample.surface.map_or_else(|| focus.at_infinity(), |point| focus.at(point)).or_standard();
        if offset.is_standard() {
            self.standard(sample)
        } else {
            let kappa = self.optics.kappa(sample.inverse_depth as f64, offset);
            Placed { kappa, depth_share: offset.t * (1.0 - offset.anchor), is_standard: false }
        }
    }

    /// Where the unpainted lens sends a sample.
    pub fn standard(&self, sample: &Sample) -> Placed {
        let kappa = self.optics.standard_kappa(sample.inverse_depth as f64);
        Placed { kappa, depth_share: 1.0, is_standard: true }
    }

    /// The aperture image of a sample.
    pub fn image<'a>(&'a self, sample: &'a Sample, placed: Placed) -> ApertureImage<'a> {
        let radius_px = self.optics.splat_radius_px(placed.kappa).clamp(-WIDEST_PX, WIDEST_PX);
        ApertureImage { sample, kernel: &self.kernel, radius_px, depth_share: placed.depth_share }
    }
}
