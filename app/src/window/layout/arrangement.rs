//! How the two views lie.

use egui::Vec2;
use serde::{Deserialize, Serialize};

/// How the two views lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Arrangement {
    /// The picture is large, the paint view small over its lower left corner.
    Navigator,
    /// The paint view lies left of the picture: for tall pictures.
    SideBySide,
    /// The paint view lies above the picture: for wide pictures.
    Stacked,
}

/// Least size of the navigator, points.
pub const LEAST_NAVIGATOR: [f32; 2] = [120.0, 90.0];

/// Panels of the picture whose sides are shorter have no room for the navigator, points.
pub const LEAST_ROOM: f32 = 180.0;

/// Most of the picture's panel that the navigator covers, in width and height.
pub const LARGEST_SHARE: f32 = 0.48;

/// Share of the picture's panel that the navigator is wide, and its height by its width.
const NAVIGATOR_SHARE: f32 = 0.3;
const NAVIGATOR_RATIO: f32 = 0.68;

/// Space between the navigator and the edges of the picture's panel, points.
const MARGIN: f32 = 10.0;

/// Where the navigator lies at first in a panel of this size: distance from the left and the lower edge, width and height, points.
pub fn navigator_place(room: Vec2) -> [f32; 4] {
    let width = (NAVIGATOR_SHARE * room.x).clamp(LEAST_NAVIGATOR[0], 400.0);
    [MARGIN, MARGIN, width, (NAVIGATOR_RATIO * width).max(LEAST_NAVIGATOR[1])]
}
