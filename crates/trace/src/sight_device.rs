//! What answers the visibility of a square from many viewpoints at once in the place of the processor, such as a graphics card.

use crate::{PointSet, Square, TargetPoints, Tracer, Viewpoint};

/// A device that can be asked what is visible.
pub trait SightDevice: Send + Sync {
    /// Gets ready for queries about a square, each about one of `targets`; `None` where the scene does not fit the device, or it no
    /// longer works.
    fn prepare(
        &self,
        tracer: &Tracer,
        square: &Square,
        targets: &[&TargetPoints],
    ) -> Option<Box<dyn PreparedSight>>;
}

/// A device that is ready for queries about a square.
pub trait PreparedSight: Send + Sync {
    /// The points that are hidden for each query, as [`Tracer::square_visibility`] finds them, those that only the back of the
    /// viewpoint's own face shows apart; `None` for queries that the device leaves to the processor. `None` for all once it no longer works.
    fn hidden(&self, queries: &[SightQuery]) -> Option<Vec<Option<PointSet>>>;
}

/// A question about a square.
#[derive(Clone, Copy, Debug)]
pub struct SightQuery {
    /// Where the square is seen from.
    pub from: Viewpoint,
    /// The number of the targets that are asked for.
    pub target: u32,
}
