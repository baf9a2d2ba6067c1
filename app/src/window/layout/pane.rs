//! The panels of the window.

use serde::{Deserialize, Serialize};
use session::CommandId;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pane {
    /// The scene in 3D.
    Paint,
    /// The refocused picture.
    Picture,
    /// The settings of the document, section by section.
    Inspector,
    /// The flat focus map.
    Atlas,
    /// The aperture as seen from one point.
    Aperture,
    /// The circles of confusion of the picture.
    Histogram,
    /// The photographs of a capture.
    Photographs,
    /// The keys over time.
    Timeline,
}

impl Pane {
    /// All panels.
    pub const ALL: [Self; 8] = [
        Self::Paint,
        Self::Picture,
        Self::Inspector,
        Self::Atlas,
        Self::Aperture,
        Self::Histogram,
        Self::Photographs,
        Self::Timeline,
    ];

    /// The displayed title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Paint => "Paint",
            Self::Picture => "Picture",
            Self::Inspector => "Inspector",
            Self::Atlas => "Atlas",
            Self::Aperture => "Aperture view",
            Self::Histogram => "Blur histogram",
            Self::Photographs => "Photographs",
            Self::Timeline => "Timeline",
        }
    }

    /// The command that opens or closes it; `None` for the two views, of which one is always open.
    pub fn command(self) -> Option<CommandId> {
        match self {
            Self::Paint | Self::Picture => None,
            Self::Inspector => Some(CommandId::ShowInspector),
            Self::Atlas => Some(CommandId::ShowAtlas),
            Self::Aperture => Some(CommandId::ShowAperture),
            Self::Histogram => Some(CommandId::ShowHistogram),
            Self::Photographs => Some(CommandId::ShowPhotographs),
            Self::Timeline => Some(CommandId::ShowTimeline),
        }
    }

    /// Whether it can be closed.
    pub fn is_foldable(self) -> bool {
        self.command().is_some()
    }
}
