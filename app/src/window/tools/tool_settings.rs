//! Settings of the tools. Saved between runs, not part of any document.

use focus::{Ease, GradientShape, Likeness, SpreadSettings, ViewFrame};
use glam::DVec3;
use lens::FocusOffset;
use project::SelectionShape;
use serde::{Deserialize, Serialize};

/// Settings of gradients, selections and rack focus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ToolSettings {
    /// Settings of gradients.
    pub gradient: GradientSettings,
    /// Whether lasso and box also select hidden surfaces.
    pub select_through: bool,
    /// Largest angle between normals considered similar, degrees.
    pub facing_degrees: f64,
    /// Settings of selecting what is alike.
    pub similar: SimilarSettings,
    /// How far a selection's outline moves when it is refined, texels.
    pub refine_texels: u32,
    /// How strokes are spread.
    pub spread: SpreadSettings,
    /// Settings of rack focus.
    pub rack: RackSettings,
}

/// Settings of selecting what touches a clicked point and is like it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SimilarSettings {
    /// What makes it alike. The axis of a depth is that of the view.
    pub likeness: Likeness,
    /// How unlike it may be, in [0, 1].
    pub tolerance: f64,
}

impl SimilarSettings {
    /// What a click on a point, world space, selects in a view.
    pub fn shape_at(&self, position: DVec3, view: &ViewFrame) -> SelectionShape {
        let likeness = match self.likeness {
            Likeness::Depth(_) => {
                Likeness::Depth(-view.camera_to_world.z_axis.truncate().normalize_or_zero())
            }
            likeness => likeness,
        };
        SelectionShape::Similar { position, likeness, tolerance: self.tolerance }
    }
}

impl Default for SimilarSettings {
    fn default() -> Self {
        Self { likeness: Likeness::Color, tolerance: 0.1 }
    }
}

/// Settings of rack focus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RackSettings {
    /// Duration, s.
    pub seconds: f64,
    /// Interpolation.
    pub ease: Ease,
}

impl Default for RackSettings {
    fn default() -> Self {
        Self { seconds: 1.0, ease: Ease::Smooth }
    }
}

impl Default for ToolSettings {
    fn default() -> Self {
        Self {
            gradient: GradientSettings::default(),
            select_through: false,
            facing_degrees: 30.0,
            similar: SimilarSettings::default(),
            refine_texels: 8,
            spread: SpreadSettings::default(),
            rack: RackSettings::default(),
        }
    }
}

/// Settings of gradients.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct GradientSettings {
    /// Linear along the line, or radial around its start.
    pub shape: GradientShape,
    /// Whether the line lies in world space; otherwise on the screen.
    pub in_world: bool,
    /// Focus at the end.
    pub end: GradientEnd,
}

/// Focus at the end of a gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum GradientEnd {
    /// The existing focus.
    #[default]
    Fade,
    /// The ordinary lens.
    Lens,
    /// Sharp, wherever the lens focuses.
    Sharp,
}

impl GradientEnd {
    /// All, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Fade, Self::Lens, Self::Sharp];

    /// Its name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fade => "what is there",
            Self::Lens => "the ordinary lens",
            Self::Sharp => "sharp",
        }
    }
}

impl GradientSettings {
    /// The focus at the end; `None` for the existing focus.
    pub fn end_focus(&self) -> Option<FocusOffset> {
        match self.end {
            GradientEnd::Fade => None,
            GradientEnd::Lens => Some(FocusOffset::STANDARD),
            GradientEnd::Sharp => Some(FocusOffset::SHARP),
        }
    }
}
