//! How things are shown. Kept between runs, not part of any document.

use super::paint_view::SurfaceAppearance;
use super::tool_settings::ToolSettings;
use serde::{Deserialize, Serialize};
use session::{Display, KeyMap, ToneCurve};
use splat::Tolerance;
use std::path::{Path, PathBuf};

/// Files that the Open recent menu remembers.
const MAX_RECENT: usize = 8;

/// The largest tolerance of the live picture, px: as wide as the circle of confusion.
pub const LARGEST_TOLERANCE_PX: f64 = 16.0;

/// The tolerance of the live picture at first, px: three eighths of the circle of confusion.
const TOLERANCE_PX: f64 = 6.0;

/// The user's own settings of the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewSettings {
    /// Share of false colour in the paint view, in [0, 1].
    pub focus_share: f32,
    /// Contour lines of blur.
    pub contours: bool,
    /// How many photographs see the surface of a capture, or what of it was invented.
    #[serde(rename = "seeing")]
    pub photograph_counts: bool,
    /// How far the surface of a picture is.
    pub depth: bool,
    /// The longest side that the preview is drawn at, px.
    pub preview_size: u32,
    /// Sides of what the live picture draws as one where the circle of confusion is 16 px wide, px; 0: every sample.
    pub tolerance_px: f64,
    /// Exposure of the display, stops.
    pub display_stops: f32,
    /// What the display makes of light brighter than white.
    pub tone_curve: ToneCurve,
    /// Dark on light instead of light on dark.
    pub light_theme: bool,
    /// Size of text and controls: 1 is the system's own.
    pub scale: f32,
    /// Length of the string by which the pointer pulls the brush, points: 0 is none, more is steadier.
    pub stabiliser: f32,
    /// Whose keys and mouse buttons are obeyed.
    pub key_map: KeyMap,
    /// What the tools are set to.
    pub tools: ToolSettings,
    /// Files opened lately, the latest first.
    pub recent: Vec<PathBuf>,
    /// Whether the hint of the first start was put away.
    #[serde(rename = "hint_seen")]
    pub hint_dismissed: bool,
}

impl Default for ViewSettings {
    fn default() -> Self {
        let appearance = SurfaceAppearance::default();
        Self {
            focus_share: appearance.focus_share,
            contours: appearance.contours,
            photograph_counts: appearance.photograph_counts,
            depth: appearance.depth,
            preview_size: 960,
            tolerance_px: TOLERANCE_PX,
            display_stops: 0.0,
            tone_curve: ToneCurve::default(),
            light_theme: false,
            scale: 1.0,
            stabiliser: 0.0,
            key_map: KeyMap::default(),
            tools: ToolSettings::default(),
            recent: Vec::new(),
            hint_dismissed: false,
        }
    }
}

impl ViewSettings {
    /// The paint view's look.
    pub fn surface_appearance(&self) -> SurfaceAppearance {
        let Self { focus_share, contours, photograph_counts, depth, .. } = *self;
        SurfaceAppearance { focus_share, contours, photograph_counts, depth }
    }

    /// How pictures are put on screen.
    pub fn display(&self) -> Display {
        Display { stops: self.display_stops, curve: self.tone_curve }
    }

    /// How coarse the live picture may be.
    pub fn tolerance(&self) -> Tolerance {
        Tolerance::px(self.tolerance_px.clamp(0.0, LARGEST_TOLERANCE_PX))
    }

    /// Notes that a file was opened or saved.
    pub fn remember(&mut self, path: &Path) {
        self.recent.retain(|recent| recent != path);
        self.recent.insert(0, path.to_path_buf());
        self.recent.truncate(MAX_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_file_is_first_and_stands_once() {
        let mut settings = ViewSettings::default();
        for k in 0..12 {
            settings.remember(Path::new(&format!("{}.glb", k % 9)));
        }
        assert_eq!(settings.recent.len(), 8);
        assert_eq!(settings.recent[0], Path::new("2.glb"));
        assert_eq!(settings.recent.iter().filter(|path| **path == Path::new("2.glb")).count(), 1);
    }
}
