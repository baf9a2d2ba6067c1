//! The format of a project: what its manifest says, and the versions of it.

use crate::ProjectError;
use crate::capture_choices::CaptureEntry;
use crate::container::{Container, DAMAGED_CURE};
use crate::layer_rows::{LayerEntries, LayerEntry, is_zero};
use crate::scene_path::{ScenePath, hex};
use focus::{Brush, LensMotion};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;

/// The manifest's entry: the first of the container.
pub(crate) const MANIFEST: &str = "manifest.json";

/// The version of a project whose depth is as it was found: older programs would show it so.
const WITHOUT_DEPTH: u64 = 6;

/// The version of a project in which gloss keeps the lens's focus everywhere: older programs would take it so.
const WITHOUT_GLOSS: u64 = 5;

/// The version of a project in the scene's own materials, no variant of them: older programs would show these in its place.
const WITHOUT_VARIANT: u64 = 4;

/// The version of one without focal planes: older programs would take their layers for the ordinary lens.
const WITHOUT_PLANES: u64 = 3;

/// The version of a project whose brush is mirrored along the world's axes, if at all: older programs lose nothing of it.
const ALONG_WORLD_AXES: u64 = 2;

/// The version of one without layers, too.
const WITHOUT_LAYERS: u64 = 1;

/// The largest manifest that is read, bytes.
const MAX_MANIFEST_BYTES: u64 = 16 << 20;

/// The manifest. Unknown fields are let pass: a later program may have added some that do no harm.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Manifest {
    pub format: String,
    pub version: u64,
    /// What wrote it, for people.
    #[serde(default)]
    pub written_by: String,
    pub scene: SceneReference,
    pub cameras: Vec<CameraEntry>,
    pub active_camera: usize,
    pub exposure: String,
    /// Whether faces are seen from behind, where that is told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_faces: Option<String>,
    /// The scene's variant, by name, where one was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// What was chosen of the capture, where the scene is one. An older program takes its folder for a file, and says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capture: Option<CaptureEntry>,
    /// What lies beyond all surfaces, where that was chosen: as in a world file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<Value>,
    pub background_focus: [f64; 2],
    /// How far gloss obeys it, where it does.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub background_gloss: f64,
    pub brush: Brush,
    #[serde(default)]
    pub view: Value,
    #[serde(default)]
    pub focus_map: Option<MapEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<LayerEntries>,
    /// What may be painted, where that is not everything. A program that does not know it lets everything be painted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub selection: Option<MapEntry>,
    /// How the lens moves, where it does. A program that does not know it shows the still picture.
    #[serde(default, skip_serializing_if = "LensMotion::is_empty")]
    pub lens_motion: LensMotion,
    /// Checksum of every other entry by its name: hex SHA-256 of its unpacked bytes.
    #[serde(default)]
    pub checksums: BTreeMap<String, String>,
}

/// Where the scene is.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SceneReference {
    #[serde(flatten)]
    pub path: ScenePath,
    /// Hex SHA-256 of the scene file.
    pub sha256: String,
}

/// A camera: its name, and its form as in a camera file; a mask names an entry.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct CameraEntry {
    pub name: String,
    pub camera: Value,
}

/// An entry that says something of every texel, row by row: the focus map's t and anchor, f32 little endian; or whether it
/// is selected, a bit each, the lowest first, the last byte filled up with 0.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct MapEntry {
    pub entry: String,
    pub width: u32,
    pub height: u32,
    /// Of a focus map: the entry that says how far gloss obeys it, a number a texel; where it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gloss: Option<String>,
}

impl Manifest {
    /// What the manifest calls the format.
    pub const FORMAT: &str = "focus-brush project";

    /// The newest version. It changes when an older program would misread the file.
    pub const VERSION: u64 = 7;

    /// The same in the oldest version that can say it all.
    pub fn with_oldest_version(self) -> Self {
        let rows = self.layers.as_ref().map(|layers| &layers.layers);
        let any_row = |of: fn(&LayerEntry) -> bool| rows.is_some_and(|rows| rows.iter().any(of));
        let has_gloss = self.background_gloss != 0.0
            || self.brush.paints_gloss()
            || self.focus_map.as_ref().is_some_and(|map| map.gloss.is_some())
            || any_row(LayerEntry::has_gloss);
        let version = match () {
            _ if self.capture.as_ref().is_some_and(CaptureEntry::has_depth_strokes) => Self::VERSION,
            _ if has_gloss => WITHOUT_DEPTH,
            _ if self.variant.is_some() => WITHOUT_GLOSS,
            _ if any_row(|row| row.plane.is_some()) => WITHOUT_VARIANT,
            _ if self.brush.has_custom_axes() => WITHOUT_PLANES,
            _ if rows.is_some() => ALONG_WORLD_AXES,
            _ => WITHOUT_LAYERS,
        };
        Self { version, ..self }
    }

    /// Reads and checks the manifest.
    pub fn read(file: &Path, container: &mut Container<'_>) -> Result<Self, ProjectError> {
        /// What every version says.
        #[derive(Deserialize)]
        struct Header {
            format: String,
            version: u64,
        }
        let bytes = container.read(MANIFEST, MAX_MANIFEST_BYTES)?;
        let header: Header = serde_json::from_slice(&bytes)
            .map_err(|error| container.error(MANIFEST, format!("cannot be understood: {error}")))?;
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
            .map_err(|error| container.error(MANIFEST, format!("cannot be understood: {error}")))
    }

    /// An entry's bytes, checked against the manifest.
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
    hex(&Sha256::digest(bytes))
}
