//! How a light field is baked.

use crate::carried::Carried;
use crate::margin::{painted_margin_px, standard_margin_px};
use crate::view::View;
use lens::{Camera, FocusOffset};
use scene::SurfaceField;
use trace::Tracer;

/// How the light field is sampled.
#[derive(Clone, Copy, Debug)]
pub struct BakeOptions {
    /// How far outside the frame to sample at least, px: the radius of the largest circle of confusion that paint
    /// may give. What the standard picture needs is always sampled.
    pub margin_px: f64,
    /// How large a cell of a partly visible aperture may be on the picture, px, where 16 cells a side allow it: up to
    /// this circle of confusion, samples have 8 cells a side. A pixel of a surface whose radiance varies by more
    /// than [`Self::EVEN_PER_PX`] times this is a sample a quadrant. Smaller is more exact and takes more memory.
    pub tolerance_px: f64,
    /// How finely carried light is sampled over the aperture.
    pub carried: Carried,
    /// Whether samples are packed ([`crate::Samples`]). It is right unless what that loses is to be measured.
    pub packs: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self { margin_px: 0.0, tolerance_px: Self::TOLERANCE_PX, carried: Carried::Standard, packs: true }
    }
}

impl BakeOptions {
    /// The default tolerance, px.
    pub const TOLERANCE_PX: f64 = 2.0;

    /// The mean radiances of the quadrants of a pixel that is one sample differ by at most this share of the largest, for
    /// each px of tolerance.
    pub const EVEN_PER_PX: f64 = 0.05;

    /// Sampled as far outside the frame, and as finely, as `focus` needs.
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
