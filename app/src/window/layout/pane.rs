//! What panels there are.

use serde::{Deserialize, Serialize};
use session::CommandId;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pane {
    /// The scene in 3D.
    Paint,
    /// The refocused picture.
    Picture,
    /// What the document is made of, section by section.
    Inspector,
    /// The focus map flat.
    Atlas,
    /// What of the aperture one point sees.
    Aperture,
    /// The circles of confusion of the picture.
    Histogram,
    /// The photographs of a capture.
    Photographs,
    /// The keys over time.
    Timeline,
}

impl Pane {
    /// All.
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

    /// What it is called.
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

    /// The command that shows it, or folds it away; none for the two views, one of which there always is.
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

    /// Whether it can be folded away.
    pub fn is_foldable(self) -> bool {
        self.command().is_some()
    }
}
