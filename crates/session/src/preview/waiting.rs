//! How others wait for the preview's work, or have it wait for theirs.

use crate::light_field::BakeState;
use crate::preview::deliveries::BAKE_SHARE;
use crate::preview::mailbox::Shared;
use document::Stage;
use lens::Camera;
use progress::{Cancelled, Progress};
use salf::Salf;
use std::sync::Arc;
use std::time::Duration;

/// How often it is looked whether the preview is still at work on a light field that others need.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

impl Shared {
    /// The light field that the preview makes now, if it serves `camera` in `stage`: it is waited for. None is another bake's time
    /// to begin: the preview's own is over by then, and has the processors for itself as long as it takes.
    pub fn wait_for_field(
        &self,
        stage: &Arc<Stage>,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Salf>>, Cancelled> {
        // What is left of the bake when the wait begins.
        let mut initial_fraction = None;
        loop {
            progress.check()?;
            match self.field.wait_for(stage, camera, POLL_INTERVAL) {
                BakeState::Baked(salf) => return Ok(Some(salf)),
                BakeState::InProgress => {
                    let baked = self.progress.fraction() / BAKE_SHARE;
                    let first = *initial_fraction.get_or_insert(baked);
                    progress.report((baked - first) / (1.0 - first).max(f32::EPSILON));
                }
                // What the thread does now may end in making one.
                BakeState::Absent if self.is_at_work() => std::thread::sleep(POLL_INTERVAL),
                BakeState::Absent => return Ok(None),
            }
        }
    }
}

/// While there is one, a picture is being made that the user asked for: that comes first, and the exact picture on screen, which
/// nobody asked for, after it.
pub(crate) struct Exporting(Arc<Shared>);

impl Exporting {
    /// Begins.
    pub fn new(shared: &Arc<Shared>) -> Self {
        shared.begin_export();
        Self(shared.clone())
    }
}

impl Drop for Exporting {
    fn drop(&mut self) {
        self.0.end_export();
    }
}
