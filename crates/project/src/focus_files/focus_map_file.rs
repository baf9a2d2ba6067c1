//! Focus maps as files.
//!
//! **EXR**, float: channels `focus.t` and `focus.anchor`, and `focus.gloss` if gloss obeys the paint anywhere.
//! Attributes: `focusBrush.version` (1), `focusBrush.uvSet` (the UV set that the map lies in: 0 is the mesh's first,
//! 1 the atlas), for a map over an atlas `focusBrush.atlasHash`, and `focusBrush.backgroundT`,
//! `focusBrush.backgroundAnchor` and, if not 0, `focusBrush.backgroundGloss`. A file without attributes is a map in
//! the mesh's first UV set. Its display window is the map: texels outside the data window are unpainted, those
//! outside the display window are dropped.
//!
//! **PNG**, 16-bit RGB without a colour profile: red = t·32768 (32768 is exactly t = 1), green = anchor·65535, blue
//! 0; no gloss. t is clamped to [0, 65535/32768]. The EXR's attributes are stored in `NAME.png.json`.

use crate::ProjectError;
use crate::disk::{extension, with_suffix, write_bytes};
use crate::json::{Field, Json};
use crate::openexr::image::{ExrAttribute, ExrImage, read_exr, write_exr};
use crate::openexr::options::ExrOptions;
use crate::pictures::png_file::{encode_rgb16, read_png16};
use atlas::Atlas;
use focus::{FocusImage, FocusMap};
use lens::FocusOffset;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

/// The format version that is written.
const VERSION: u32 = 1;

/// The channels of an EXR.
const T: &str = "focus.t";
const ANCHOR: &str = "focus.anchor";
/// Optional; gloss is 0 without it.
const GLOSS: &str = "focus.gloss";

/// Red of t = 1.
const PNG_UNIT_OFFSET: f64 = 32768.0;

/// Green of anchor = 1, and the maximum value of a channel.
const PNG_MAX: f64 = 65535.0;

/// A focus map with its file's metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusMapFile {
    /// The texels.
    pub image: FocusImage,
    /// The background's focus, if the file gives one.
    pub background: Option<FocusOffset>,
    /// Hash of the atlas that it belongs to; `None` for a map in the mesh's first UV set.
    pub atlas_hash: Option<String>,
    /// Harmless defects of the file, a sentence each.
    pub warnings: Vec<String>,
}

impl FocusMapFile {
    /// The file's content for a map painted over `atlas`.
    pub fn from_atlas_map(map: &FocusMap, atlas: &Atlas) -> Self {
        let (width, height) = (map.width(), map.height());
        let image = FocusImage { width, height, texels: map.to_rows(), gloss: map.gloss_rows() };
        Self {
            image,
            background: Some(map.background),
            atlas_hash: Some(atlas.hash.clone()),
            warnings: Vec::new(),
        }
    }

    /// The map over `atlas`; `file` is named in errors.
    ///
    /// # Errors
    /// The map belongs to another atlas or has another size.
    pub fn into_atlas_map(self, file: &Path, atlas: &Atlas) -> Result<FocusMap, ProjectError> {
        let cure = "unwrap with the settings it was painted with, or bring it in as a map of the mesh's UVs";
        let error = |problem: &str| ProjectError::content(file, problem, cure);
        if self.atlas_hash.as_ref().is_some_and(|hash| *hash != atlas.hash) {
            return Err(error("the focus map belongs to another atlas"));
        }
        let FocusImage { width, height, texels, gloss } = self.image;
        if [width, height] != [atlas.width, atlas.height] {
            let (w, h) = (atlas.width, atlas.height);
            return Err(error(&format!("the focus map has {width}×{height} texels, the atlas {w}×{h}")));
        }
        let background = self.background.unwrap_or(FocusOffset::STANDARD);
        let incomplete = || error("the focus map is incomplete");
        let mut map = FocusMap::from_rows(width, height, &texels, background).ok_or_else(incomplete)?;
        match gloss.is_none_or(|gloss| map.set_gloss_rows(&gloss)) {
            true => Ok(map),
            false => Err(incomplete()),
        }
    }

    /// Reads an EXR or PNG focus map, by extension.
    ///
    /// # Errors
    /// The file cannot be read, is not a focus map, or has values out of range.
    pub fn read(file: &Path) -> Result<Self, ProjectError> {
        let map = match extension(file).as_str() {
            "exr" => from_exr(file, read_exr(file, default_channel_value)?)?,
            "png" => from_png(file)?,
            _ => {
                return Err(ProjectError::content(
                    file,
                    "is not a focus map: unknown extension",
                    "give an .exr or .png",
                ));
            }
        };
        let usable = |[t, anchor]: &[f32; 2]| t.is_finite() && (0.0..=1.0).contains(anchor);
        if let Some(index) = map.image.texels.iter().position(|texel| !usable(texel)) {
            let [t, anchor] = map.image.texels[index];
            let (x, y) = (index % map.image.width as usize, index / map.image.width as usize);
            return Err(ProjectError::content(
                file,
                format!("texel ({x}, {y}) has t = {t}, anchor = {anchor}"),
                "t must be finite and anchor in [0, 1]",
            ));
        }
        let gloss = map.image.gloss.iter().flatten();
        if let Some((index, gloss)) = gloss.enumerate().find(|(_, gloss)| !(0.0..=1.0).contains(*gloss)) {
            let (x, y) = (index % map.image.width as usize, index / map.image.width as usize);
            let problem = format!("texel ({x}, {y}) has gloss = {gloss}");
            return Err(ProjectError::content(file, problem, "gloss must be in [0, 1]"));
        }
        Ok(map)
    }
}

/// Writes an EXR or PNG focus map, by extension. Returns what the format could not hold, a sentence each.
///
/// # Errors
/// The extension is another, or the file cannot be written.
pub fn write_focus_map(file: &Path, map: &FocusMapFile) -> Result<Vec<String>, ProjectError> {
    match extension(file).as_str() {
        "exr" => {
            write_exr(file, to_exr(map), ExrOptions::default())?;
            Ok(Vec::new())
        }
        "png" => to_png(file, map),
        _ => Err(ProjectError::content(
            file,
            "focus maps cannot be written in this format",
            "name an .exr or .png",
        )),
    }
}

fn stored_uv_set(map: &FocusMapFile) -> u32 {
    u32::from(map.atlas_hash.is_some())
}

fn to_exr(map: &FocusMapFile) -> ExrImage {
    let channel = |k: usize| map.image.texels.iter().map(|texel| texel[k]).collect();
    let mut channels = BTreeMap::from([(T.to_string(), channel(0)), (ANCHOR.to_string(), channel(1))]);
    if let Some(gloss) = &map.image.gloss {
        channels.insert(GLOSS.to_string(), gloss.clone());
    }
    let mut attributes = BTreeMap::new();
    let mut insert = |name: &str, value| attributes.insert(format!("focusBrush.{name}"), value);
    insert("version", ExrAttribute::Number(VERSION as f64));
    insert("uvSet", ExrAttribute::Number(stored_uv_set(map) as f64));
    if let Some(hash) = &map.atlas_hash {
        insert("atlasHash", ExrAttribute::Text(hash.clone()));
    }
    if let Some(background) = map.background {
        insert("backgroundT", ExrAttribute::Number(background.t));
        insert("backgroundAnchor", ExrAttribute::Number(background.anchor));
        if background.gloss != 0.0 {
            insert("backgroundGloss", ExrAttribute::Number(background.gloss));
        }
    }
    ExrImage { width: map.image.width, height: map.image.height, channels, attributes, ..ExrImage::default() }
}

/// Value of a channel where the file has no texel: the focus of the ordinary lens.
fn default_channel_value(channel: &str) -> f32 {
    let FocusOffset { t, anchor, gloss } = FocusOffset::STANDARD;
    match channel {
        T => t as f32,
        ANCHOR => anchor as f32,
        _ => gloss as f32,
    }
}

fn from_exr(file: &Path, mut exr: ExrImage) -> Result<FocusMapFile, ProjectError> {
    let mut channel = |name: &str| {
        let available: Vec<_> = exr.channels.keys().cloned().collect();
        exr.channels.remove(name).ok_or_else(|| {
            let problem =
                format!("is not a focus map: it has no channel {name}, only {}", available.join(", "));
            ProjectError::content(file, problem, "give an EXR with channels focus.t and focus.anchor")
        })
    };
    let (t, anchor) = (channel(T)?, channel(ANCHOR)?);
    let number = |name: &str| match exr.attributes.get(&format!("focusBrush.{name}")) {
        Some(ExrAttribute::Number(number)) => Some(*number),
        _ => None,
    };
    if let Some(version) = number("version").filter(|&version| version > VERSION as f64) {
        let newest = VERSION as u64;
        return Err(ProjectError::Newer { file: file.to_owned(), version: version as u64, newest });
    }
    let background = number("backgroundT").zip(number("backgroundAnchor"));
    let background_gloss = number("backgroundGloss").unwrap_or(0.0);
    let background = background.map(|(t, anchor)| FocusOffset::new(t, anchor).with_gloss(background_gloss));
    if background.is_some_and(|background| !background.is_valid()) {
        return Err(ProjectError::content(
            file,
            "the background's focus cannot be used",
            "its t must be finite, its anchor and gloss in [0, 1]",
        ));
    }
    let atlas_hash = match exr.attributes.get("focusBrush.atlasHash") {
        Some(ExrAttribute::Text(hash)) => Some(hash.clone()),
        _ => None,
    };
    let texels = t.into_iter().zip(anchor).map(|(t, anchor)| [t, anchor]).collect();
    let gloss = exr.channels.remove(GLOSS);
    let image = FocusImage { width: exr.width, height: exr.height, texels, gloss };
    Ok(FocusMapFile { image, background, atlas_hash, warnings: Vec::new() })
}

fn to_png(file: &Path, map: &FocusMapFile) -> Result<Vec<String>, ProjectError> {
    let stored = |[t, anchor]: [f32; 2]| {
        let red = (t as f64 * PNG_UNIT_OFFSET).round().clamp(0.0, PNG_MAX);
        let green = (anchor as f64 * PNG_MAX).round().clamp(0.0, PNG_MAX);
        [red as u16, green as u16, 0]
    };
    let rgb: Vec<u16> = map.image.texels.iter().flat_map(|&texel| stored(texel)).collect();
    let bytes = encode_rgb16(map.image.width, map.image.height, &rgb, &[]).map_err(|error| {
        ProjectError::Write { file: file.to_owned(), source: std::io::Error::other(error) }
    })?;
    let mut sidecar = json!({
        "format": "focus-brush focus map",
        "version": VERSION,
        "uv_set": stored_uv_set(map),
        "encoding": {"t": "red / 32768", "anchor": "green / 65535"},
    });
    if let Some(hash) = &map.atlas_hash {
        sidecar["atlas_hash"] = json!(hash);
    }
    if let Some(background) = map.background {
        sidecar["background"] = json!({"t": background.t, "anchor": background.anchor});
    }
    let text = serde_json::to_string_pretty(&sidecar).expect("a JSON value has a text");
    write_bytes(&with_suffix(file, ".json"), (text + "\n").as_bytes())?;
    write_bytes(file, &bytes)?;
    let outside = |t: f32| !(0.0..=PNG_MAX / PNG_UNIT_OFFSET).contains(&(t as f64));
    let lost = map.image.texels.iter().filter(|[t, _]| outside(*t)).count();
    let offset_warning = format!(
        "{}: {lost} texels have t outside [0, 2), which 16-bit PNG cannot hold; they were clipped (write an .exr to keep them)",
        file.display()
    );
    let gloss_warning = format!(
        "{}: gloss obeys the paint in places, which a PNG cannot hold; it was left out (write an .exr to keep it)",
        file.display()
    );
    let background_gloss = map.background.is_some_and(|background| background.gloss != 0.0);
    let warnings =
        [(lost > 0, offset_warning), (map.image.gloss.is_some() || background_gloss, gloss_warning)];
    Ok(warnings.into_iter().filter_map(|(is_lost, warning)| is_lost.then_some(warning)).collect())
}

fn from_png(file: &Path) -> Result<FocusMapFile, ProjectError> {
    let png = read_png16(file)?;
    let value =
        |[red, green, _]: [u16; 3]| [(red as f64 / PNG_UNIT_OFFSET) as f32, (green as f64 / PNG_MAX) as f32];
    let texels = png.rgb.into_iter().map(value).collect();
    let image = FocusImage { width: png.width, height: png.height, texels, gloss: None };
    let mut warnings = Vec::new();
    if png.has_color_space {
        warnings.push(format!(
            "{}: has a colour profile, which a focus map must not have; its numbers are used as they are",
            file.display()
        ));
    }
    let mut map = FocusMapFile { image, background: None, atlas_hash: None, warnings };
    let sidecar = with_suffix(file, ".json");
    if sidecar.exists() {
        let json = Json::read(&sidecar)?;
        let fields = Field::root(&sidecar, &json).object()?;
        if let Some(version) = fields.get("version").map(|field| field.whole_number()).transpose()?
            && version > VERSION
        {
            return Err(ProjectError::Newer {
                file: sidecar,
                version: version as u64,
                newest: VERSION as u64,
            });
        }
        map.atlas_hash = fields.get("atlas_hash").map(|field| field.text().map(str::to_owned)).transpose()?;
        if let Some(field) = fields.get("background") {
            let background = field.object()?;
            let number = |name, default| background.get(name).map_or(Ok(default), |field| field.number());
            let background = FocusOffset::new(number("t", 1.0)?, number("anchor", 0.0)?);
            if !background.is_valid() {
                return Err(field.error("cannot be used", "its anchor must be in [0, 1]"));
            }
            map.background = Some(background);
        }
    }
    Ok(map)
}
