//! The description of a SOG scene, both versions in one form.

use super::super::reading::Reading;
use super::container::Container;
use crate::error::GaussianError;
use glam::{DVec3, Vec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

/// A scene.
pub(super) struct Meta {
    pub count: u64,
    pub is_antialiased: bool,
    pub means: Means,
    pub scales: Scales,
    /// The picture of rotations.
    pub rotations: String,
    pub colors: Colors,
    pub palette: Option<PaletteMeta>,
}

/// Places.
pub(super) struct Means {
    /// Low bytes, high bytes.
    pub files: [String; 2],
    /// The least and the largest, of sign(x)·ln(1 + |x|).
    range: [DVec3; 2],
}

/// Scales, ln s.
pub(super) struct Scales {
    pub file: String,
    pub levels: Levels,
}

/// Coefficients of degree 0.
pub(super) struct Colors {
    pub file: String,
    pub levels: Levels,
    pub opacity: Opacity,
}

/// What the bytes of three channels mean.
pub(super) enum Levels {
    /// 256 values for all channels.
    Codebook(Box<[f32; 256]>),
    /// The least and the largest.
    Range([Vec3; 2]),
}

/// What the alpha of colours means.
pub(super) enum Opacity {
    /// The opacity.
    Plain,
    /// Its logit, between the least and the largest.
    Logit([f64; 2]),
}

/// Colours beyond degree 0.
pub(super) struct PaletteMeta {
    /// The colours, and the index of each splat.
    pub files: [String; 2],
    /// The degree, where it is declared.
    pub degree: Option<u32>,
    /// Its entries, where they are declared.
    pub entries: Option<u64>,
    /// What the bytes mean: 256 values.
    pub values: Box<[f32; 256]>,
}

#[derive(Deserialize)]
struct RawMeta {
    version: Option<u32>,
    count: Option<u64>,
    #[serde(default)]
    antialias: bool,
    model: Option<String>,
    means: RawImage,
    scales: RawImage,
    quats: RawImage,
    sh0: RawImage,
    #[serde(rename = "shN")]
    sh_n: Option<RawImage>,
}

#[derive(Deserialize)]
struct RawImage {
    files: Vec<String>,
    shape: Option<Vec<u64>>,
    #[serde(default)]
    mins: Numbers,
    #[serde(default)]
    maxs: Numbers,
    codebook: Option<Vec<Option<f32>>>,
    count: Option<u64>,
    bands: Option<u32>,
}

/// One number or several.
#[derive(Default, Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Several(Vec<f64>),
    #[default]
    Missing,
    Other(IgnoredAny),
}

impl Meta {
    /// Reads the description of a scene.
    ///
    /// # Errors
    /// It is missing, malformed or of another version.
    pub fn read(reading: &mut Reading<'_>, container: &mut Container<'_>) -> Result<Self, GaussianError> {
        let bytes = container.meta(reading)?;
        let raw: RawMeta = serde_json::from_slice(&bytes).map_err(|e| reading.malformed("meta.json", e))?;
        if let Some(version) = raw.version.filter(|version| ![1, 2].contains(version)) {
            let what = format!("is SOG of version {version}, 1 and 2 are read");
            return Err(GaussianError::unsupported(
                reading.file(),
                what,
                "convert it to version 2, or to .ply",
            ));
        }
        let is_first = raw.version != Some(2);
        let missing = |what: &str| reading.malformed("meta.json", format!("has no {what}"));
        let shape = || raw.means.shape.as_ref().and_then(|shape| shape.first().copied());
        let count = raw.count.or_else(shape).ok_or_else(|| missing("count"))?;
        let file = |image: &RawImage, index: usize, name: &str| {
            image.files.get(index).cloned().ok_or_else(|| missing(&format!("file {index} of {name}")))
        };
        let range = |image: &RawImage, name: &str| -> Result<[DVec3; 2], GaussianError> {
            let end = |numbers: &Numbers| {
                numbers.at_least_three().ok_or_else(|| missing(&format!("mins and maxs of {name}")))
            };
            Ok([end(&image.mins)?, end(&image.maxs)?])
        };
        let levels = |image: &RawImage, name: &str| -> Result<Levels, GaussianError> {
            match is_first {
                true => Ok(Levels::Range(range(image, name)?.map(|end| end.as_vec3()))),
                false => Ok(Levels::Codebook(
                    codebook(image).ok_or_else(|| missing(&format!("codebook of {name}")))?,
                )),
            }
        };
        let opacity = match is_first {
            true => {
                let fourth = |numbers: &Numbers| {
                    numbers.get(3).ok_or_else(|| missing("fourth of mins and maxs of sh0"))
                };
                Opacity::Logit([fourth(&raw.sh0.mins)?, fourth(&raw.sh0.maxs)?])
            }
            false => Opacity::Plain,
        };
        let palette = match &raw.sh_n {
            Some(image) => Some(PaletteMeta {
                files: [file(image, 0, "shN")?, file(image, 1, "shN")?],
                degree: image.bands,
                entries: image.count,
                values: palette_values(image, is_first).ok_or_else(|| missing("codebook of shN"))?,
            }),
            None => None,
        };
        let meta = Self {
            count,
            is_antialiased: raw.antialias || raw.model.as_deref() == Some("antialiased"),
            means: Means {
                files: [file(&raw.means, 0, "means")?, file(&raw.means, 1, "means")?],
                range: range(&raw.means, "means")?,
            },
            scales: Scales { file: file(&raw.scales, 0, "scales")?, levels: levels(&raw.scales, "scales")? },
            rotations: file(&raw.quats, 0, "quats")?,
            colors: Colors { file: file(&raw.sh0, 0, "sh0")?, levels: levels(&raw.sh0, "sh0")?, opacity },
            palette,
        };
        if meta.palette.as_ref().and_then(|palette| palette.degree) == Some(0) {
            return Ok(Self { palette: None, ..meta });
        }
        Ok(meta)
    }
}

impl Means {
    /// The mean of the pixels of low and high bytes.
    pub fn decode(&self, low: [u8; 4], high: [u8; 4]) -> Vec3 {
        let share = |axis: usize| f64::from(u16::from_le_bytes([low[axis], high[axis]])) / 65535.0;
        let [least, most] = self.range;
        let logarithm = least + (most - least) * DVec3::new(share(0), share(1), share(2));
        logarithm.to_array().map(|v| v.signum() * v.abs().exp_m1()).map(|x| x as f32).into()
    }
}

impl Numbers {
    fn get(&self, index: usize) -> Option<f64> {
        match self {
            Self::One(number) => Some(*number),
            Self::Several(numbers) => numbers.get(index).copied(),
            Self::Missing | Self::Other(_) => None,
        }
    }

    fn at_least_three(&self) -> Option<DVec3> {
        Some(DVec3::new(self.get(0)?, self.get(1)?, self.get(2)?))
    }
}

/// The codebook of an image: up to 256 numbers, those that are missing 0.
fn codebook(image: &RawImage) -> Option<Box<[f32; 256]>> {
    let numbers = image.codebook.as_ref().filter(|numbers| (1..=256).contains(&numbers.len()))?;
    let mut values = Box::new([0.0; 256]);
    for (value, number) in values.iter_mut().zip(numbers) {
        *value = number.unwrap_or_default();
    }
    Some(values)
}

/// What the bytes of a palette mean.
fn palette_values(image: &RawImage, is_first: bool) -> Option<Box<[f32; 256]>> {
    if !is_first {
        return codebook(image);
    }
    let (least, most) = (image.mins.get(0)?, image.maxs.get(0)?);
    Some(Box::new(std::array::from_fn(|byte| (least + (most - least) * byte as f64 / 255.0) as f32)))
}
