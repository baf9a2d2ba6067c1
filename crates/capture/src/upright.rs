//! What is up in a world that does not say so.

use glam::{DQuat, DVec3};
use scene::View;

/// The rotation that turns a world so that +y is up: what was up for its cameras on the whole. People hold cameras level more often than
/// not, and where they circle, tilts cancel. The identity if they agree on nothing.
pub(crate) fn upright(views: &[View]) -> DQuat {
    let up: DVec3 = views.iter().map(View::up).sum();
    up.try_normalize().map_or(DQuat::IDENTITY, |up| DQuat::from_rotation_arc(up, DVec3::Y))
}
