//! Waiting for the preview's light field, and having the preview wait for exports.

use crate::light_field::BakeState;
use crate::preview::deliveries::BAKE_SHARE;
use crate::preview::mailbox::Shared;
use document::Stage;
use lens::Camera;
use progress::{Cancelled, Progress};
use salf::Salf;
use std::sync::Arc;
use std::time::Duration;

/// Interval of checks whether the preview is still making a light field.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

impl Shared {
    /// Waits for the light field that the preview is making, and returns it if it is compatible with `camera` in `stage`. On `None` the
    /// caller can start its own bake: the preview's has ended, so the two do not compete for the processors.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn wait_for_field(
        &self,
        stage: &Arc<Stage>,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Salf>>, Cancelled> {
        // Progress of the bake when the wait began.
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
                // The thread's current work may lead to a bake.
                BakeState::Absent if self.is_at_work() => std::thread::sleep(POLL_INTERVAL),
                BakeState::Absent => return Ok(None),
            }
        }
    }
}

/// A guard for an export: while it exists, the exact picture on screen waits.
pub(crate) struct Exporting(Arc<Shared>);

impl Exporting {
    /// Begins an export.
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
