//! The project file: a saved document.
//!
//! Three layers: the container (bytes), the manifest (format and version), and [`ProjectFile`] (the model). A
//! `.fbrush` is a ZIP of
//!
//! | entry | content |
//! | --- | --- |
//! | `manifest.json` | format, version, scene, cameras, exposure, brush, view, checksums of the rest |
//! | `atlas.bin` | the unwrapping, as written by the atlas |
//! | `focus.f32` | t and anchor per texel, f32 little endian, row by row: the composite of all layers |
//! | `focus.gloss.f32` | gloss per texel, in the same form; if not all 0 |
//! | `layers/N.f32`, `layers/N.gloss.f32`, `layers/N.mask.f32` | the same for each layer, and its mask; if there are layers |
//! | `selection.bits` | which texels may be painted, one bit each; if not all |
//! | `thumbnail.png` | the picture when it was saved, for file managers; if one was shown |
//! | `masks/N.f32` | the aperture mask of camera N: width and height as u32, then transmissions as f32 |
//!
//! The scene itself stays where it is; its path is stored relative to the project, so that both may be moved
//! together, with its checksum, so that a change is noticed.

mod capture_choices;
mod container;
mod layer_entries;
mod layer_rows;
pub(crate) mod manifest;
mod recovery;
mod scene_checksum;
mod surface_file;
mod texel_bytes;
mod texel_set;
mod thumbnail;

pub use capture_choices::CaptureChoices;
pub use recovery::{find_recovery, recovery_path_for, remove_recovery, unsaved_recovery_path};
pub use surface_file::{surface_from_bytes, surface_to_bytes};
pub use texel_set::TexelSet;
pub use thumbnail::Thumbnail;

use crate::camera::{camera_from_json, camera_to_json};
use crate::disk::{read_bytes, write_verified};
use crate::scene_path::ScenePath;
use capture_choices::CaptureEntry;
use container::{Container, DAMAGED_CURE, pack};

use manifest::{CameraEntry, MANIFEST, Manifest, MapEntry, SceneReference, sha256_hex};
use scene_checksum::scene_checksum;
use texel_bytes::{bytes_from_floats, floats_from_bytes, pairs_from_bytes};

use crate::{FocusHold, ProjectError, SplatsFile, WorldFile};
use focus::{Brush, FocusLayer, FocusMap, LayerStack, LensMotion};
use lens::{ApertureMask, ApertureShape, Camera, Exposure, FocusOffset};
use scene::BackFaces;
use serde_json::Value;
use std::path::{Path, PathBuf};
use thumbnail::THUMBNAIL;

const ATLAS: &str = "atlas.bin";
const SURFACE: &str = "surface.bin";
const FOCUS_MAP: &str = "focus.f32";
const FOCUS_GLOSS: &str = "focus.gloss.f32";
const SELECTION: &str = "selection.bits";

/// Maximum size of an atlas that is read, bytes.
const MAX_ATLAS_BYTES: u64 = 2 << 30;

/// Maximum width and height of a focus map or mask that is read.
const MAX_SIDE: u32 = 32768;

/// Maximum size of a focus map or mask that is read, bytes.
const MAX_MAP_BYTES: u64 = 4 << 30;

/// A camera and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// Its name.
    pub name: String,
    /// The camera.
    pub camera: Camera,
    /// What its focus is held on; `None`: the point of its axis at the focus distance.
    pub focus_hold: Option<FocusHold>,
}

/// A saved document.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectFile {
    /// The scene file, or the folder of a capture.
    pub scene: PathBuf,
    /// Hex SHA-256 of the scene file when the document was made; see [`Self::scene_state`].
    pub scene_sha256: String,
    /// The cameras, at least one.
    pub cameras: Vec<NamedCamera>,
    /// The active camera: index into `cameras`.
    pub active_camera: usize,
    /// How the sum becomes the picture.
    pub exposure: Exposure,
    /// Whether the backs of faces that are not double-sided are visible.
    pub back_faces: BackFaces,
    /// The name of the chosen variant of the scene; `None`: its own materials.
    pub variant: Option<String>,
    /// For a project of a capture: the user's choices.
    pub capture: Option<CaptureChoices>,
    /// The chosen world; `None`: the scene's own.
    pub world: Option<WorldFile>,
    /// Gaussian splats that were added to the scene, moved or hidden; `None`: as in the scene's file.
    pub splats: Option<SplatsFile>,
    /// If a floor was put under the scene: whether it is shown.
    pub floor: Option<bool>,
    /// The brush.
    pub brush: Brush,
    /// Layout and viewpoint of the window; any JSON.
    pub view: Value,
    /// The unwrapping, as written by the atlas; `None` if there is none yet.
    pub atlas: Option<Vec<u8>>,
    /// The surface that was unwrapped ([`crate::surface_to_bytes`]): the scene's file may have changed when it is
    /// opened again.
    pub surface: Option<Vec<u8>>,
    /// The focus map; `None` if nothing is painted.
    pub focus_map: Option<FocusMap>,
    /// The layers whose composite is the focus map; `None` if there is just one plain layer. The values of adjustment
    /// layers are not saved: they follow from curve and camera ([`LayerStack::evaluate`]).
    pub layers: Option<LayerStack>,
    /// The lens's keyframes; those of layers are stored with the layers.
    pub lens_motion: LensMotion,
    /// The selection; `None`: everything.
    pub selection: Option<TexelSet>,
    /// The background's focus if there is no focus map; else the map's own counts.
    pub background_focus: FocusOffset,
    /// The picture when it was saved.
    pub thumbnail: Option<Thumbnail>,
}

/// Whether the scene is still the one that the document was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneState {
    /// It is the same.
    Same,
    /// It has changed since.
    Changed,
    /// It does not exist.
    Missing,
}

impl ProjectFile {
    /// The extension of a project file.
    pub const EXTENSION: &'static str = "fbrush";

    /// A document of a scene without paint. Reads the scene file to compute its checksum.
    ///
    /// # Errors
    /// The scene file cannot be read.
    pub fn new(scene: &Path, cameras: Vec<NamedCamera>) -> Result<Self, ProjectError> {
        Ok(Self {
            scene: scene.to_owned(),
            scene_sha256: Self::scene_checksum(scene)?,
            cameras,
            active_camera: 0,
            exposure: Exposure::default(),
            back_faces: BackFaces::default(),
            variant: None,
            capture: None,
            world: None,
            splats: None,
            floor: None,
            brush: Brush::default(),
            view: Value::Null,
            atlas: None,
            surface: None,
            focus_map: None,
            layers: None,
            lens_motion: LensMotion::default(),
            selection: None,
            background_focus: FocusOffset::STANDARD,
            thumbnail: None,
        })
    }

    /// Hex SHA-256 of a scene file; for a capture's folder, of the files that define its cameras and its surface.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn scene_checksum(scene: &Path) -> Result<String, ProjectError> {
        scene_checksum(scene)
    }

    /// Compares the scene file with the stored checksum.
    pub fn scene_state(&self) -> SceneState {
        match Self::scene_checksum(&self.scene) {
            Ok(sum) if sum == self.scene_sha256 => SceneState::Same,
            Ok(_) => SceneState::Changed,
            Err(_) => SceneState::Missing,
        }
    }

    /// Saves the document. `file` is replaced only once the new one is complete on the disk and has been read back
    /// and compared; whatever fails, the old one stays.
    ///
    /// # Errors
    /// The document is invalid, or the file cannot be written or does not read back the same.
    pub fn save(&self, file: &Path) -> Result<(), ProjectError> {
        self.check(file)?;
        let bytes =
            self.to_bytes(file).map_err(|source| ProjectError::Write { file: file.to_owned(), source })?;
        write_verified(file, &bytes, |back| match Self::from_bytes(file, back) {
            Ok(read) if self.has_same_paint(&read) => Ok(()),
            Ok(_) => Err("its content differs".to_string()),
            Err(error) => Err(error.to_string()),
        })
    }

    /// Reads a document. The scene's path is made absolute from the project's location.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, is not a project, or was written by a newer version.
    pub fn load(file: &Path) -> Result<Self, ProjectError> {
        Self::from_bytes(file, &read_bytes(file)?)
    }

    /// Whether another document has the same scene and paint. The values of adjustment layers are ignored.
    fn has_same_paint(&self, other: &Self) -> bool {
        let layers = |project: &Self| {
            project.layers.clone().map(|stack| {
                let same = stack.layers().iter().map(|layer| {
                    let values = layer.adjustment.is_none().then(|| layer.map.clone());
                    (layer.name.clone(), values, layer.map.mask_rows(), layer.adjustment.clone())
                });
                same.collect::<Vec<_>>()
            })
        };
        (&self.scene_sha256, &self.focus_map, &self.selection)
            == (&other.scene_sha256, &other.focus_map, &other.selection)
            && layers(self) == layers(other)
    }

    /// Rejects what would be saved but could not be read again.
    fn check(&self, file: &Path) -> Result<(), ProjectError> {
        let error = |problem: String| ProjectError::content(file, problem, "correct it before saving");
        if self.active_camera >= self.cameras.len() {
            return Err(error(format!("camera {} of {} is in use", self.active_camera, self.cameras.len())));
        }
        for named in &self.cameras {
            named.camera.validate().map_err(|e| error(format!("camera \"{}\": {e}", named.name)))?;
        }
        if let Some(problem) = self.brush.problem() {
            return Err(error(format!("brush: {problem}")));
        }
        if !self.lens_motion.is_valid() {
            return Err(error("the lens has keys that cannot be used".to_string()));
        }
        let layers = self.layers.iter().flat_map(LayerStack::layers);
        let size = self.focus_map.as_ref().map(FocusMap::size);
        if self.layers.as_ref().is_some_and(|layers| Some(layers.size()) != size) {
            return Err(error("its layers do not have the size of its focus map".to_string()));
        }
        if self.selection.as_ref().is_some_and(|selection| Some(selection.size()) != size) {
            return Err(error("its selection does not have the size of its focus map".to_string()));
        }
        let usable = self.focus_map.as_ref().is_none_or(FocusMap::is_valid)
            && layers.into_iter().all(FocusLayer::is_valid)
            && self.background_focus.is_valid();
        if usable { Ok(()) } else { Err(error("the focus has values that are not finite".to_string())) }
    }

    fn to_bytes(&self, file: &Path) -> Result<Vec<u8>, std::io::Error> {
        let mut entries: Vec<(String, Vec<u8>)> = Vec::new();
        let mut cameras = Vec::new();
        for (index, NamedCamera { name, camera, focus_hold }) in self.cameras.iter().enumerate() {
            let mut value = camera_to_json(camera);
            if let ApertureShape::Mask(mask) = &camera.aperture.shape {
                let entry = format!("masks/{index}.f32");
                value["aperture"]["mask"] = Value::from(entry.as_str());
                value["aperture"]["mask_file"] = Value::from(mask.file.as_str());
                entries.push((entry, mask_to_bytes(mask)));
            }
            cameras.push(CameraEntry { name: name.clone(), camera: value, focus_hold: focus_hold.clone() });
        }
        if let Some(atlas) = &self.atlas {
            entries.push((ATLAS.to_string(), atlas.clone()));
        }
        if let Some(surface) = &self.surface {
            entries.push((SURFACE.to_string(), surface.clone()));
        }
        let focus_map = self.focus_map.as_ref().map(|map| {
            let texels = map.to_rows();
            let bytes = texels.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
            entries.push((FOCUS_MAP.to_string(), bytes));
            let gloss = map.gloss_rows().map(|gloss| {
                entries.push((FOCUS_GLOSS.to_string(), bytes_from_floats(&gloss)));
                FOCUS_GLOSS.to_string()
            });
            MapEntry { entry: FOCUS_MAP.to_string(), width: map.width(), height: map.height(), gloss }
        });
        let layers = self.layers.as_ref().map(|layers| layer_entries::write(layers, &mut entries));
        let background = self.focus_map.as_ref().map_or(self.background_focus, |map| map.background);
        let selection = self.selection.as_ref().map(|selection| {
            entries.push((SELECTION.to_string(), selection.to_bytes()));
            let [width, height] = selection.size();
            MapEntry { entry: SELECTION.to_string(), width, height, gloss: None }
        });
        if let Some(Thumbnail(png)) = &self.thumbnail {
            entries.push((THUMBNAIL.to_string(), png.clone()));
        }

        let manifest = Manifest {
            format: Manifest::FORMAT.to_string(),
            version: Manifest::VERSION,
            written_by: format!("Focus Brush {}", env!("CARGO_PKG_VERSION")),
            scene: SceneReference {
                path: ScenePath::new(&self.scene, file),
                sha256: self.scene_sha256.clone(),
            },
            cameras,
            active_camera: self.active_camera,
            exposure: exposure_name(self.exposure).to_string(),
            back_faces: (self.back_faces != BackFaces::default()).then(|| self.back_faces.name().to_string()),
            variant: self.variant.clone(),
            capture: self.capture.as_ref().map(|choices| CaptureEntry::new(choices, file)),
            world: self.world.as_ref().map(|world| world.to_json(file)),
            splats: self.splats.as_ref().map(|splats| splats.to_json(file)),
            floor: self.floor,
            background_focus: [background.t, background.anchor],
            background_gloss: background.gloss,
            brush: self.brush.clone(),
            view: self.view.clone(),
            focus_map,
            layers,
            selection,
            lens_motion: self.lens_motion.clone(),
            checksums: entries.iter().map(|(name, bytes)| (name.clone(), sha256_hex(bytes))).collect(),
        };
        let manifest =
            serde_json::to_vec_pretty(&manifest.with_oldest_version()).map_err(std::io::Error::other)?;
        entries.insert(0, (MANIFEST.to_string(), manifest));
        pack(&entries)
    }

    fn from_bytes(file: &Path, bytes: &[u8]) -> Result<Self, ProjectError> {
        let mut container = Container::open(file, bytes)?;
        let manifest = Manifest::read(file, &mut container)?;
        let error = |problem: String| ProjectError::Entry {
            file: file.to_owned(),
            entry: MANIFEST.to_string(),
            problem,
            cure: DAMAGED_CURE.to_string(),
        };

        let mut cameras = Vec::new();
        for CameraEntry { name, camera, focus_hold } in &manifest.cameras {
            if !focus_hold.as_ref().is_none_or(FocusHold::is_valid) {
                return Err(error(format!(
                    "the focus of camera \"{name}\" is held on a point that is not finite"
                )));
            }
            cameras.push(NamedCamera {
                name: name.clone(),
                camera: read_camera(file, camera.clone(), &manifest, &mut container)?,
                focus_hold: focus_hold.clone(),
            });
        }
        if manifest.active_camera >= cameras.len() {
            return Err(error(format!("camera {} of {} is in use", manifest.active_camera, cameras.len())));
        }
        let exposure = match manifest.exposure.as_str() {
            "conserve" => Exposure::Conserve,
            "normalise" => Exposure::Normalise,
            other => return Err(error(format!("\"{other}\" is not an exposure"))),
        };
        let back_faces = match manifest.back_faces.as_deref() {
            None => BackFaces::default(),
            Some(name) => BackFaces::from_name(name)
                .ok_or_else(|| error(format!("\"{name}\" is not a setting of back faces")))?,
        };
        let world = manifest.world.as_ref().map(|world| WorldFile::from_value(file, world)).transpose()?;
        let splats =
            manifest.splats.as_ref().map(|splats| SplatsFile::from_value(file, splats)).transpose()?;
        if let Some(problem) = manifest.brush.problem() {
            return Err(error(format!("brush: {problem}")));
        }
        let [t, anchor] = manifest.background_focus;
        if !manifest.lens_motion.is_valid() {
            return Err(error("lens_motion has keys that cannot be used".to_string()));
        }
        let background_focus = FocusOffset::new(t, anchor).with_gloss(manifest.background_gloss);
        if !background_focus.is_valid() {
            return Err(error("background_focus cannot be used".to_string()));
        }
        let atlas = match manifest.checksums.contains_key(ATLAS) {
            true => Some(manifest.read_entry(file, &mut container, ATLAS, MAX_ATLAS_BYTES)?),
            false => None,
        };
        let surface = match manifest.checksums.contains_key(SURFACE) {
            true => Some(manifest.read_entry(file, &mut container, SURFACE, MAX_ATLAS_BYTES)?),
            false => None,
        };
        let focus_map = match &manifest.focus_map {
            Some(entry) => Some(read_focus_map(file, entry, &manifest, &mut container, background_focus)?),
            None => None,
        };
        let layers = match (&manifest.layers, &manifest.focus_map) {
            (Some(rows), Some(size)) => {
                Some(layer_entries::read(file, rows, size, &manifest, &mut container)?)
            }
            (Some(_), None) => return Err(error("has layers but no focus map".to_string())),
            (None, _) => None,
        };
        let selection = match &manifest.selection {
            Some(entry) => Some(read_selection(file, entry, &manifest, &mut container)?),
            None => None,
        };
        if let (Some(set), map) = (&selection, &focus_map)
            && Some(set.size()) != map.as_ref().map(FocusMap::size)
        {
            return Err(error("has a selection of another size than its focus map".to_string()));
        }
        let thumbnail = Thumbnail::from_container(file, &manifest, &mut container)?;
        let scene = manifest.scene.path.resolve(file);
        let capture = match &manifest.capture {
            Some(row) => Some(row.to_choices(file).map_err(|what| error(what.to_string()))?),
            None => None,
        };
        Ok(Self {
            scene: scene.ok_or_else(|| error("scene.path_bytes is not in hex".to_string()))?,
            scene_sha256: manifest.scene.sha256.clone(),
            cameras,
            active_camera: manifest.active_camera,
            exposure,
            back_faces,
            variant: manifest.variant,
            capture,
            world,
            splats,
            floor: manifest.floor,
            brush: manifest.brush,
            view: manifest.view,
            atlas,
            surface,
            focus_map,
            layers,
            lens_motion: manifest.lens_motion,
            selection,
            background_focus,
            thumbnail,
        })
    }
}

/// The manifest's name of an exposure.
fn exposure_name(exposure: Exposure) -> &'static str {
    match exposure {
        Exposure::Conserve => "conserve",
        Exposure::Normalise => "normalise",
    }
}

fn read_camera(
    file: &Path,
    mut json: Value,
    manifest: &Manifest,
    container: &mut Container<'_>,
) -> Result<Camera, ProjectError> {
    let named = json.get_mut("aperture").and_then(Value::as_object_mut).and_then(|a| a.remove("mask_file"));
    let mask_file = named.and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default();
    let mask_entry = json.pointer("/aperture/mask").and_then(Value::as_str).map(str::to_owned);
    let mask = match mask_entry {
        Some(entry) => {
            let bytes = manifest.read_entry(file, container, &entry, MAX_MAP_BYTES)?;
            Some(
                mask_from_bytes(&bytes, mask_file)
                    .ok_or_else(|| container.error(&entry, "is not an aperture mask"))?,
            )
        }
        None => None,
    };
    let stored_mask =
        |_: &str| mask.clone().ok_or_else(|| container.error(MANIFEST, "names no aperture mask"));
    let camera = camera_from_json(file, &json.to_string(), &Camera::default(), &stored_mask)?;
    // Projects used to store black if nothing had been chosen; darkness is now chosen by a world.
    let background = camera.background.filter(|color| *color != [0.0; 3]);
    Ok(Camera { background, ..camera })
}

fn read_focus_map(
    file: &Path,
    entry: &MapEntry,
    manifest: &Manifest,
    container: &mut Container<'_>,
    background: FocusOffset,
) -> Result<FocusMap, ProjectError> {
    let size = entry.width as u64 * entry.height as u64 * 8;
    let sides = 1..=MAX_SIDE;
    if !sides.contains(&entry.width) || !sides.contains(&entry.height) || size > MAX_MAP_BYTES {
        return Err(
            container.error(&entry.entry, format!("cannot have {}×{} texels", entry.width, entry.height))
        );
    }
    let bytes = manifest.read_entry(file, container, &entry.entry, size)?;
    let wrong_size = "does not have the size given in the manifest";
    let mut map = FocusMap::from_rows(entry.width, entry.height, &pairs_from_bytes(&bytes), background)
        .ok_or_else(|| container.error(&entry.entry, wrong_size))?;
    if let Some(gloss) = &entry.gloss {
        let bytes = manifest.read_entry(file, container, gloss, size / 2)?;
        if !map.set_gloss_rows(&floats_from_bytes(&bytes)) {
            return Err(container.error(gloss, wrong_size));
        }
    }
    if !map.is_valid() {
        return Err(container.error(&entry.entry, "has values that are not finite"));
    }
    Ok(map)
}

fn read_selection(
    file: &Path,
    entry: &MapEntry,
    manifest: &Manifest,
    container: &mut Container<'_>,
) -> Result<TexelSet, ProjectError> {
    let sides = 1..=MAX_SIDE;
    if !sides.contains(&entry.width) || !sides.contains(&entry.height) {
        let problem = format!("cannot have {}×{} texels", entry.width, entry.height);
        return Err(container.error(&entry.entry, problem));
    }
    let size = (entry.width as u64 * entry.height as u64).div_ceil(8);
    let bytes = manifest.read_entry(file, container, &entry.entry, size)?;
    TexelSet::from_bytes([entry.width, entry.height], bytes)
        .ok_or_else(|| container.error(&entry.entry, "does not have the size given in the manifest"))
}

fn mask_to_bytes(mask: &ApertureMask) -> Vec<u8> {
    let size = [mask.width, mask.height].into_iter().flat_map(u32::to_le_bytes);
    size.chain(mask.transmission.iter().flat_map(|t| t.to_le_bytes())).collect()
}

fn mask_from_bytes(bytes: &[u8], file: String) -> Option<ApertureMask> {
    let (words, rest) = bytes.as_chunks::<4>();
    let [width, height, transmission @ ..] = words else { return None };
    let (width, height) = (u32::from_le_bytes(*width), u32::from_le_bytes(*height));
    let whole = rest.is_empty() && width as u64 * height as u64 == transmission.len() as u64;
    let transmission = transmission.iter().map(|word| f32::from_le_bytes(*word)).collect();
    whole.then_some(ApertureMask { width, height, transmission, file })
}
