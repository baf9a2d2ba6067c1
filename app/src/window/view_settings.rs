//! Settings of the window. Saved between runs, not part of any document.

use super::tools::tool_settings::ToolSettings;
use render::{Display, ToneCurve};
use serde::{Deserialize, Serialize};
use session::KeyMap;
use splat::Tolerance;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Number of files in the Open recent menu.
const MAX_RECENT: usize = 8;

/// Largest tolerance of the live picture, px: the width of the reference circle of confusion.
pub const LARGEST_TOLERANCE_PX: f64 = 16.0;

/// Default tolerance of the live picture, px: three eighths of the reference circle of confusion.
const TOLERANCE_PX: f64 = 6.0;

/// The user's own settings of the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewSettings {
    /// Share of false colour in the paint view, in [0, 1].
    pub focus_share: f32,
    /// Whether to draw contour lines of blur.
    pub contours: bool,
    /// Whether to show the number of photographs of a capture's surface, or its invented parts.
    #[serde(rename = "seeing")]
    pub photograph_counts: bool,
    /// Whether to show the depth of a picture's surface.
    pub depth: bool,
    /// Whether to draw frame and thirds over the picture.
    pub guides: bool,
    /// Whether to draw the line of the focus plane over the picture.
    pub focus_plane: bool,
    /// Longest side of the preview, px.
    pub preview_size: u32,
    /// Side of the merged samples of the live picture where the circle of confusion is 16 px wide, px; 0:
    /// every sample is drawn.
    pub tolerance_px: f64,
    /// Exposure of the display, stops.
    pub display_stops: f32,
    /// Tone curve of the display.
    pub tone_curve: ToneCurve,
    /// Whether to use the light theme.
    pub light_theme: bool,
    /// Scale of text and controls: 1 is the system's.
    pub scale: f32,
    /// Length of the stabiliser's string, points: 0 is off, longer is steadier.
    pub stabiliser: f32,
    /// The key map.
    pub key_map: KeyMap,
    /// Settings of the tools.
    pub tools: ToolSettings,
    /// The sections of the inspector that the user opened (true) or closed, by title.
    pub toggled_sections: BTreeMap<String, bool>,
    /// Recently opened files, the latest first.
    pub recent: Vec<PathBuf>,
    /// Whether the hint at first start was dismissed.
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
            guides: false,
            focus_plane: false,
            preview_size: 960,
            tolerance_px: TOLERANCE_PX,
            display_stops: 0.0,
            tone_curve: ToneCurve::default(),
            light_theme: false,
            scale: 1.0,
            stabiliser: 0.0,
            key_map: KeyMap::default(),
            tools: ToolSettings::default(),
            toggled_sections: BTreeMap::new(),
            recent: Vec::new(),
            hint_dismissed: false,
        }
    }
}

impl ViewSettings {
    /// Appearance of the surface in the paint view.
    pub fn surface_appearance(&self) -> SurfaceAppearance {
        let Self { focus_share, contours, photograph_counts, depth, .. } = *self;
        SurfaceAppearance { focus_share, contours, photograph_counts, depth }
    }

    /// Display settings of pictures.
    pub fn display(&self) -> Display {
        Display { stops: self.display_stops, curve: self.tone_curve }
    }

    /// Tolerance of the live picture.
    pub fn tolerance(&self) -> Tolerance {
        Tolerance::px(self.tolerance_px.clamp(0.0, LARGEST_TOLERANCE_PX))
    }

    /// Adds an opened or saved file to the recent files.
    pub fn remember(&mut self, path: &Path) {
        self.recent.retain(|recent| recent != path);
        self.recent.insert(0, path.to_path_buf());
        self.recent.truncate(MAX_RECENT);
    }
}

/// Appearance of the surface in the paint view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceAppearance {
    /// Share of the false colours of blur, in [0, 1]; the rest is the scene's own colour.
    pub focus_share: f32,
    /// Whether to draw contour lines where the circle of confusion is 1, 4 and 16 px.
    pub contours: bool,
    /// Whether to show the number of photographs, or the invented parts, instead of the light of photographs.
    pub photograph_counts: bool,
    /// Whether to show the depth of a picture's surface.
    pub depth: bool,
}

impl Default for SurfaceAppearance {
    fn default() -> Self {
        Self { focus_share: 0.65, contours: false, photograph_counts: false, depth: false }
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
