//! What the tools are set to. Kept between runs, not part of any document.

use focus::{Ease, GradientShape};
use lens::FocusOffset;
use serde::{Deserialize, Serialize};

/// Gradients and selections as the user wants them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ToolSettings {
    /// How gradients run.
    pub gradient: GradientSettings,
    /// Whether lasso and box reach hidden surfaces too.
    pub select_through: bool,
    /// The largest angle between normals that face alike, degrees.
    pub facing_degrees: f64,
    /// How a rack focus goes.
    pub rack: RackSettings,
}

/// How a rack focus goes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RackSettings {
    /// How long it takes, s.
    pub seconds: f64,
    /// How it begins and ends.
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
            rack: RackSettings::default(),
        }
    }
}

/// How gradients run.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct GradientSettings {
    /// Across their line, or around its start.
    pub shape: GradientShape,
    /// Whether their line lies in the world; else it lies on the screen.
    pub in_world: bool,
    /// What they lead to.
    pub end: GradientEnd,
}

/// What a gradient leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum GradientEnd {
    /// What is there already.
    #[default]
    Fade,
    /// The ordinary lens.
    Lens,
    /// Sharp, wherever the lens focuses.
    Sharp,
}

impl GradientEnd {
    /// All, as a menu offers them.
    pub const ALL: [Self; 3] = [Self::Fade, Self::Lens, Self::Sharp];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fade => "what is there",
            Self::Lens => "the ordinary lens",
            Self::Sharp => "sharp",
        }
    }
}

impl GradientSettings {
    /// The focus at the end; none for what is there.
    pub fn end_focus(&self) -> Option<FocusOffset> {
        match self.end {
            GradientEnd::Fade => None,
            GradientEnd::Lens => Some(FocusOffset::STANDARD),
            GradientEnd::Sharp => Some(FocusOffset::SHARP),
        }
    }
}
