//! How a light field is baked.

use crate::carried::Carried;
use crate::margin::{painted_margin_px, standard_margin_px};
use crate::view::View;
use lens::{Camera, FocusOffset};
use surface::SurfaceField;
use trace::Tracer;

/// How the light field is sampled.
#[derive(Clone, Copy, Debug)]
pub struct BakeOptions {
    /// The least margin around the frame to sample, px: the radius of the largest circle of confusion that paint may
    /// cause. The margin of the standard picture is always sampled.
    pub margin_px: f64,
    /// The largest cell of a partly visible aperture in the picture, px, as far as 16 cells per side allow: up to this
    /// circle of confusion, samples have 8 cells per side. Pixels whose radiance varies by more than
    /// [`Self::EVEN_PER_PX`] times this have a sample per quadrant. Smaller values are more exact and take more memory.
    pub tolerance_px: f64,
    /// How finely carried light is sampled over the aperture.
    pub carried: Carried,
    /// Side of a pixel of the picture, px of the baked camera, which may be finer: splats are as blurred as the picture's pixels make them.
    pub pixel_px: f64,
    /// Cells of the aperture, along each side, from which Gaussian splats are looked at: 8, or 4 for a rough picture in a third of the time.
    pub splat_cells: u32,
    /// Whether samples are packed ([`crate::Samples`]): always, except to measure the loss.
    pub packs: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            margin_px: 0.0,
            tolerance_px: Self::TOLERANCE_PX,
            carried: Carried::Standard,
            pixel_px: 1.0,
            splat_cells: Self::SPLAT_CELLS,
            packs: true,
        }
    }
}

impl BakeOptions {
    /// The default tolerance, px.
    pub const TOLERANCE_PX: f64 = 2.0;

    /// [`Self::splat_cells`] of finished pictures.
    pub const SPLAT_CELLS: u32 = 8;
    /// The same of rough ones.
    pub const ROUGH_SPLAT_CELLS: u32 = 4;

    /// The mean radiances of the quadrants of a pixel that is one sample differ by at most this share of the largest, for
    /// each px of tolerance.
    pub const EVEN_PER_PX: f64 = 0.05;

    /// Options whose margin (px) and resolution of carried light suit `focus`.
    pub fn for_focus(tracer: &Tracer, camera: &Camera, focus: &dyn SurfaceField<FocusOffset>) -> Self {
        let view = View::new(camera, Self::TOLERANCE_PX);
        let margin_px = painted_margin_px(tracer, &view, focus);
        Self { margin_px, carried: Carried::for_focus(focus), ..Self::default() }
    }

    /// The same for several lenses and focuses at one camera position, as at different times: options that suit all of them.
    pub fn for_all<'a>(
        tracer: &Tracer,
        shots: impl IntoIterator<Item = (&'a Camera, &'a dyn SurfaceField<FocusOffset>)>,
    ) -> Self {
        shots.into_iter().fold(Self::default(), |all, (camera, focus)| {
            let own = Self::for_focus(tracer, camera, focus);
            let standard = standard_margin_px(tracer.scene(), &View::new(camera, Self::TOLERANCE_PX));
            Self {
                margin_px: all.margin_px.max(own.margin_px).max(standard),
                carried: all.carried.max(own.carried),
                ..all
            }
        })
    }
}
