//! What the focus is held on while the camera moves, as stored in projects.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What the focus is held on while the camera moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FocusHold {
    /// A point of the world: the focus plane passes through it wherever the camera goes.
    Point(DVec3),
    /// The middle of an object, by the name of its node.
    Object(String),
    /// The focus distance stays as it is.
    Distance,
}

impl FocusHold {
    /// Whether its numbers are finite.
    pub fn is_valid(&self) -> bool {
        match self {
            Self::Point(position) => position.is_finite(),
            Self::Object(_) | Self::Distance => true,
        }
    }
}
