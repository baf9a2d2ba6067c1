//! The picture as a running integer sum that single samples can leave and enter.

use lens::{Camera, FocusOffset, Picture};
use progress::Progress;
use salf::Salf;
use scene::SurfaceField;
use std::ops::Range;
use std::sync::Arc;

/// Why a picture could not be summed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplatError {
    /// Nobody wants it any more.
    #[error("cancelled")]
    Cancelled,
    /// The integer sum would overflow.
    #[error("the scene's radiance is too high to be summed exactly (lower the brightest light below 1e6)")]
    Overflow,
}

/// A SALF being looked at: sums that follow the focus as it is painted.
///
/// ```text
/// let mut splatter = Splatter::new(salf);                       // once a bake
/// splatter.render(&camera, &focus, progress)?;                  // whole picture: first, or lens changed
/// let dirty = splatter.update(&focus, &changed_samples)?;       // paint: subtract and add
/// let picture = splatter.picture();
/// ```
pub struct Splatter {
    salf: Arc<Salf>,
}

impl Splatter {
    /// Prepares to render `salf`.
    pub fn new(salf: Arc<Salf>) -> Self {
        Self { salf }
    }

    /// The light field.
    pub fn salf(&self) -> &Arc<Salf> {
        &self.salf
    }

    /// Sums the whole picture for a lens (`camera` may differ from the baked one in focus distance, aperture
    /// shape and a smaller aperture radius, nothing else) and a focus.
    pub fn render(
        &mut self,
        _camera: &Camera,
        _focus: &dyn SurfaceField<FocusOffset>,
        _progress: &dyn Progress,
    ) -> Result<(), SplatError> {
        todo!()
    }

    /// Moves the given samples to where `focus` now sends them. Returns the rows of the picture that changed.
    /// Equal, bit for bit, to a render from scratch.
    pub fn update(
        &mut self,
        _focus: &dyn SurfaceField<FocusOffset>,
        _samples: &[u32],
    ) -> Result<Range<u32>, SplatError> {
        todo!()
    }

    /// The picture as it now is.
    pub fn picture(&self) -> Picture {
        todo!()
    }
}
