//! The manifest of a project and its format versions.

use crate::FocusHold;
use crate::ProjectError;
use crate::project_file::capture_choices::CaptureEntry;
use crate::project_file::container::{Container, DAMAGED_CURE};
use crate::project_file::layer_rows::{LayerEntries, LayerEntry, is_zero};
use crate::scene_path::ScenePath;
use focus::{Brush, LensMotion};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;

/// The manifest's entry: the first of the container.
pub(crate) const MANIFEST: &str = "manifest.json";

/// The version of a project without depth repairs: older programs would show the depth unrepaired.
const WITHOUT_DEPTH: u64 = 6;
const WITHOUT_CHOSEN_LAYER: u64 = 7;

/// The version of a project without a floor that was put under its scene: older programs would take its atlas for that of another scene.
const WITHOUT_FLOOR: u64 = 10;

/// The version of a project whose splats are those of its scene's file, unedited: older programs would show no others.
const WITHOUT_SPLATS: u64 = 9;

/// The version of a project without layers that were spread: older programs would lose the strokes.
const WITHOUT_SPREAD: u64 = 8;

/// The version of a project in which gloss keeps the lens's focus everywhere: older programs assume that.
const WITHOUT_GLOSS: u64 = 5;

/// The version of a project with the scene's own materials, not a variant: older programs would show the former in
/// place of the latter.
const WITHOUT_VARIANT: u64 = 4;

/// The version of a project without focal planes: older programs would treat their layers as the ordinary lens.
const WITHOUT_PLANES: u64 = 3;

/// The version of a project whose brush is mirrored along the world's axes, if at all: older programs lose nothing of
/// it.
const ALONG_WORLD_AXES: u64 = 2;

/// The version of a project without layers either.
const WITHOUT_LAYERS: u64 = 1;

/// Maximum size of a manifest that is read, bytes.
const MAX_MANIFEST_BYTES: u64 = 16 << 20;

/// The manifest. Unknown fields are ignored: a later program may have added harmless ones.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Manifest {
    pub format: String,
    pub version: u64,
    /// The program that wrote it, for information.
    #[serde(default)]
    pub written_by: String,
    pub scene: SceneReference,
    pub cameras: Vec<CameraEntry>,
    pub active_camera: usize,
    pub exposure: String,
    /// Whether back faces are shown, if not the default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_faces: Option<String>,
    /// The name of the scene's variant, if one was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// The choices for the capture, if the scene is one. An older program takes its folder for a file and reports
    /// that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capture: Option<CaptureEntry>,
    /// The world, if one was chosen; as in a world file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<Value>,
    /// Gaussian splats that were added, moved or hidden; as in a file of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub splats: Option<Value>,
    /// If a floor was put under the scene: whether it is shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<bool>,
    pub background_focus: [f64; 2],
    /// The background's gloss, if not 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub background_gloss: f64,
    pub brush: Brush,
    #[serde(default)]
    pub view: Value,
    #[serde(default)]
    pub focus_map: Option<MapEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<LayerEntries>,
    /// The selection, if not everything. A program that does not support it lets everything be painted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selection: Option<MapEntry>,
    /// The lens's keyframes, if any. A program that does not support them shows the still picture.
    #[serde(default, skip_serializing_if = "LensMotion::is_empty")]
    pub lens_motion: LensMotion,
    /// Checksum of every other entry by its name: hex SHA-256 of its unpacked bytes.
    #[serde(default)]
    pub checksums: BTreeMap<String, String>,
}

/// The scene's path and checksum.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SceneReference {
    #[serde(flatten)]
    pub path: ScenePath,
    /// Hex SHA-256 of the scene file.
    pub sha256: String,
}

/// A camera: its name, and its form as in a camera file; a mask is named by its entry.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CameraEntry {
    pub name: String,
    pub camera: Value,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub focus_hold: Option<FocusHold>,
}

/// A container entry with a value for every texel, row by row: the focus map's t and anchor, f32 little endian; or
/// whether it is selected, one bit each, lowest first, the last byte padded with 0.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct MapEntry {
    pub entry: String,
    pub width: u32,
    pub height: u32,
    /// For a focus map: the container entry of its gloss, one number per texel, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gloss: Option<String>,
}

impl Manifest {
    /// The manifest's name of the format.
    pub const FORMAT: &str = "focus-brush project";

    /// The newest version. It is increased whenever an older program would misread the file.
    pub const VERSION: u64 = 11;

    /// The same in the oldest version that can express it.
    pub fn with_oldest_version(self) -> Self {
        let rows = self.layers.as_ref().map(|layers| &layers.layers);
        let any_row = |of: fn(&LayerEntry) -> bool| rows.is_some_and(|rows| rows.iter().any(of));
        let has_gloss = self.background_gloss != 0.0
            || self.brush.paints_gloss()
            || self.focus_map.as_ref().is_some_and(|map| map.gloss.is_some())
            || any_row(LayerEntry::has_gloss);
        let capture_has = |of: fn(&CaptureEntry) -> bool| self.capture.as_ref().is_some_and(of);
        let version = match () {
            _ if self.floor.is_some() => Self::VERSION,
            _ if self.splats.is_some() => WITHOUT_FLOOR,
            _ if any_row(|row| row.spread.is_some()) => WITHOUT_SPLATS,
            _ if capture_has(CaptureEntry::has_layer) => WITHOUT_SPREAD,
            _ if capture_has(CaptureEntry::has_depth_strokes) => WITHOUT_CHOSEN_LAYER,
            _ if has_gloss => WITHOUT_DEPTH,
            _ if self.variant.is_some() => WITHOUT_GLOSS,
            _ if any_row(|row| row.plane.is_some()) => WITHOUT_VARIANT,
            _ if self.brush.has_custom_axes() => WITHOUT_PLANES,
            _ if rows.is_some() => ALONG_WORLD_AXES,
            _ => WITHOUT_LAYERS,
        };
        Self { version, ..self }
    }

    /// Reads and checks the manifest of a project.
    ///
    /// # Errors
    /// It is missing or malformed, or of a version that is not supported.
    pub fn read(file: &Path, container: &mut Container<'_>) -> Result<Self, ProjectError> {
        /// The fields that every version has.
        #[derive(Deserialize)]
        struct Header {
            format: String,
            version: u64,
        }
        let bytes = container.read(MANIFEST, MAX_MANIFEST_BYTES)?;
        let header: Header = serde_json::from_slice(&bytes)
            .map_err(|error| container.error(MANIFEST, format!("cannot be parsed: {error}")))?;
        if header.format != Self::FORMAT {
            let problem = format!("is not a Focus Brush project but \"{}\"", header.format);
            return Err(ProjectError::content(file, problem, "open it with the program that wrote it"));
        }
        if header.version > Self::VERSION {
            return Err(ProjectError::Newer {
                file: file.to_owned(),
                version: header.version,
                newest: Self::VERSION,
            });
        }
        serde_json::from_slice(&bytes)
            .map_err(|error| container.error(MANIFEST, format!("cannot be parsed: {error}")))
    }

    /// Reads an entry of at most `limit` bytes, and checks it against the manifest's checksum.
    ///
    /// # Errors
    /// The entry is missing, damaged, or longer, or has no checksum.
    pub fn read_entry(
        &self,
        file: &Path,
        container: &mut Container<'_>,
        entry: &str,
        limit: u64,
    ) -> Result<Vec<u8>, ProjectError> {
        let bytes = container.read(entry, limit)?;
        match self.checksums.get(entry) {
            Some(sum) if *sum == sha256_hex(&bytes) => Ok(bytes),
            Some(_) => Err(container.error(entry, "is damaged: its checksum does not match")),
            None => Err(ProjectError::content(
                file,
                format!("{MANIFEST} has no checksum of {entry}"),
                DAMAGED_CURE,
            )),
        }
    }
}

/// Hex SHA-256.
pub(crate) fn sha256_hex(bytes: &[u8]) -> String {
    hex::encode(Sha256::digest(bytes))
}
