//! The `.salf` file: a baked light field, to be splatted again with another focus or lens.
//!
//! Little endian throughout:
//!
//! ```text
//! magic        8 bytes   "FBSALF\r\n"
//! version      u32       2
//! source       text      the scene or project it was baked from, as a path
//! triangles    u32       of that scene: what surface addresses count in
//! camera       see `write_camera`
//! margin       u32       px sampled outside the frame
//! samples      u64       how many; then, sample after sample:
//!   center, half_size     2 × f32 each
//!   inverse_depth, weight f32 each
//!   tilt                  2 × f32
//!   radiance              3 × f32
//!   triangle              u32, 2³² − 1 for the background; else followed by barycentrics, 2 × f64
//!   words                 u8: 0 open, else that many u64 of visibility cells (1 or 4), followed by
//!                         occluder_inverse_depth, f32
//! checksum     32 bytes  SHA-256 of everything before
//! ```
//!
//! A text is its length in bytes (u32) and UTF-8.

use crate::{Salf, Sample, Visibility};
use glam::{DMat4, DVec2, Vec2, Vec3};
use lens::{Aperture, ApertureMask, ApertureShape, Camera};
use scene::SurfacePoint;
use sha2::{Digest, Sha256};
use std::io::{self, Read, Write};
use std::sync::Arc;

const MAGIC: &[u8; 8] = b"FBSALF\r\n";
const VERSION: u32 = 2;
const BACKGROUND: u32 = u32::MAX;
/// More than any path takes.
const LONGEST_TEXT: u32 = 1 << 16;
/// Room made for samples before they are read: a wrong count must not take the memory.
const FIRST_CAPACITY: u64 = 1 << 20;

/// A light field and what it was baked from.
#[derive(Clone, Debug)]
pub struct SalfFile {
    /// The scene or project, as a path.
    pub source: String,
    /// How many triangles that scene has.
    pub triangles: u32,
    /// The light field.
    pub salf: Arc<Salf>,
}

/// Why a `.salf` file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SalfFileError {
    /// It cannot be read to its end.
    #[error("cannot be read: {0} (check the path, or bake it again)")]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("not a .salf file (bake one with `focus-brush bake`)")]
    NotSalf,
    /// It is of another version.
    #[error("version {0} of the .salf format is not known, only version {VERSION} (bake it again)")]
    Version(u32),
    /// It ends early.
    #[error("cut short (copy it again, or bake it again)")]
    CutShort,
    /// A value in it makes no sense.
    #[error("damaged: {0} (copy it again, or bake it again)")]
    Damaged(String),
}

impl SalfFile {
    /// Writes the file.
    pub fn write(&self, to: impl Write) -> io::Result<()> {
        let mut to = Hashing { inner: to, hash: Sha256::new() };
        to.write_all(MAGIC)?;
        to.write_all(&VERSION.to_le_bytes())?;
        write_text(&mut to, &self.source)?;
        to.write_all(&self.triangles.to_le_bytes())?;
        write_camera(&mut to, &self.salf.camera)?;
        to.write_all(&self.salf.margin_px.to_le_bytes())?;
        to.write_all(&(self.salf.samples.len() as u64).to_le_bytes())?;
        self.salf.samples.iter().try_for_each(|sample| write_sample(&mut to, sample))?;
        let sum = to.hash.finalize();
        to.inner.write_all(&sum)?;
        to.inner.flush()
    }

    /// Reads the file and checks it.
    pub fn read(from: impl Read) -> Result<Self, SalfFileError> {
        let mut from = Hashing { inner: from, hash: Sha256::new() };
        let magic: [u8; 8] = bytes(&mut from)?;
        if magic != *MAGIC {
            return Err(SalfFileError::NotSalf);
        }
        let version = u32::from_le_bytes(bytes(&mut from)?);
        if version != VERSION {
            return Err(SalfFileError::Version(version));
        }
        let source = read_text(&mut from)?;
        let triangles = u32::from_le_bytes(bytes(&mut from)?);
        let camera = read_camera(&mut from)?;
        camera.validate().map_err(|error| SalfFileError::Damaged(error.to_string()))?;
        let margin_px = u32::from_le_bytes(bytes(&mut from)?);
        let count = u64::from_le_bytes(bytes(&mut from)?);
        let mut samples = Vec::with_capacity(count.min(FIRST_CAPACITY) as usize);
        for index in 0..count {
            let sample = read_sample(&mut from)?;
            if sample.surface.is_some_and(|point| point.triangle >= triangles) {
                let what = format!("sample {index} lies on a triangle that the scene does not have");
                return Err(SalfFileError::Damaged(what));
            }
            samples.push(sample);
        }
        let expected = from.hash.clone().finalize();
        let found: [u8; 32] = bytes(&mut from)?;
        if found[..] != expected[..] {
            return Err(SalfFileError::Damaged("the checksum does not match".into()));
        }
        Ok(Self { source, triangles, salf: Arc::new(Salf { camera, margin_px, samples }) })
    }
}

/// Hashes what passes.
struct Hashing<T> {
    inner: T,
    hash: Sha256,
}

impl<T: Write> Write for Hashing<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for Hashing<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.hash.update(&buffer[..read]);
        Ok(read)
    }
}

fn bytes<const N: usize>(from: &mut impl Read) -> Result<[u8; N], SalfFileError> {
    let mut buffer = [0; N];
    from.read_exact(&mut buffer).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => SalfFileError::CutShort,
        _ => SalfFileError::Io(error),
    })?;
    Ok(buffer)
}

fn write_text(to: &mut impl Write, text: &str) -> io::Result<()> {
    to.write_all(&(text.len() as u32).to_le_bytes())?;
    to.write_all(text.as_bytes())
}

fn read_text(from: &mut impl Read) -> Result<String, SalfFileError> {
    let length = u32::from_le_bytes(bytes(from)?);
    if length > LONGEST_TEXT {
        return Err(SalfFileError::Damaged(format!("a text of {length} bytes")));
    }
    let mut text = vec![0; length as usize];
    from.read_exact(&mut text).map_err(|_| SalfFileError::CutShort)?;
    String::from_utf8(text).map_err(|_| SalfFileError::Damaged("a text that is not UTF-8".into()))
}

fn write_f64s(to: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))
}

fn read_f64s<const N: usize>(from: &mut impl Read) -> Result<[f64; N], SalfFileError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = f64::from_le_bytes(bytes(from)?);
    }
    Ok(values)
}

fn write_f32s(to: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))
}

fn read_f32s<const N: usize>(from: &mut impl Read) -> Result<[f32; N], SalfFileError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = f32::from_le_bytes(bytes(from)?);
    }
    Ok(values)
}

/// Width and height (u32); yfov, focus distance, aperture radius, sensor height, background (3), pose (16, by
/// columns), aperture ratio (f64); shape (u8): 0 disc, 1 polygon with blades (u32), rotation and roundness
/// (f64), 2 square, 3 mask with width and height (u32), file (text) and a transmission a texel (f32).
fn write_camera(to: &mut impl Write, camera: &Camera) -> io::Result<()> {
    to.write_all(&camera.width.to_le_bytes())?;
    to.write_all(&camera.height.to_le_bytes())?;
    write_f64s(to, &[camera.yfov, camera.focus_distance, camera.aperture_radius, camera.sensor_height])?;
    write_f64s(to, &camera.background)?;
    write_f64s(to, &camera.camera_to_world.to_cols_array())?;
    write_f64s(to, &[camera.aperture.ratio])?;
    match &camera.aperture.shape {
        ApertureShape::Disc => to.write_all(&[0]),
        ApertureShape::Polygon { blades, rotation, roundness } => {
            to.write_all(&[1])?;
            to.write_all(&blades.to_le_bytes())?;
            write_f64s(to, &[*rotation, *roundness])
        }
        ApertureShape::Square => to.write_all(&[2]),
        ApertureShape::Mask(mask) => {
            to.write_all(&[3])?;
            to.write_all(&mask.width.to_le_bytes())?;
            to.write_all(&mask.height.to_le_bytes())?;
            write_text(to, &mask.file)?;
            write_f32s(to, &mask.transmission)
        }
    }
}

fn read_camera(from: &mut impl Read) -> Result<Camera, SalfFileError> {
    let width = u32::from_le_bytes(bytes(from)?);
    let height = u32::from_le_bytes(bytes(from)?);
    let [yfov, focus_distance, aperture_radius, sensor_height] = read_f64s(from)?;
    let background = read_f64s(from)?;
    let camera_to_world = DMat4::from_cols_array(&read_f64s(from)?);
    let [ratio] = read_f64s(from)?;
    let [shape] = bytes(from)?;
    let shape = match shape {
        0 => ApertureShape::Disc,
        1 => {
            let blades = u32::from_le_bytes(bytes(from)?);
            let [rotation, roundness] = read_f64s(from)?;
            ApertureShape::Polygon { blades, rotation, roundness }
        }
        2 => ApertureShape::Square,
        3 => ApertureShape::Mask(Arc::new(read_mask(from)?)),
        other => return Err(SalfFileError::Damaged(format!("aperture shape {other}"))),
    };
    Ok(Camera {
        width,
        height,
        yfov,
        focus_distance,
        aperture_radius,
        sensor_height,
        camera_to_world,
        background,
        aperture: Aperture { shape, ratio },
    })
}

fn read_mask(from: &mut impl Read) -> Result<ApertureMask, SalfFileError> {
    let width = u32::from_le_bytes(bytes(from)?);
    let height = u32::from_le_bytes(bytes(from)?);
    let file = read_text(from)?;
    if width > Camera::LARGEST_SIDE_PX || height > Camera::LARGEST_SIDE_PX {
        return Err(SalfFileError::Damaged(format!("an aperture mask of {width} × {height}")));
    }
    let texels = width as u64 * height as u64;
    let mut transmission = Vec::with_capacity(texels.min(FIRST_CAPACITY) as usize);
    for _ in 0..texels {
        let [texel] = read_f32s(from)?;
        transmission.push(texel);
    }
    Ok(ApertureMask { width, height, transmission, file })
}

fn write_sample(to: &mut impl Write, sample: &Sample) -> io::Result<()> {
    let Sample { center, half_size, inverse_depth, weight, tilt, radiance, surface, visibility } = sample;
    write_f32s(to, &[center.x, center.y, half_size.x, half_size.y, *inverse_depth, *weight, tilt.x, tilt.y])?;
    write_f32s(to, &radiance.to_array())?;
    match surface {
        None => to.write_all(&BACKGROUND.to_le_bytes())?,
        Some(point) => {
            to.write_all(&point.triangle.to_le_bytes())?;
            write_f64s(to, &point.barycentric.to_array())?;
        }
    }
    match visibility {
        Visibility::Open => to.write_all(&[0]),
        Visibility::Cells { words, occluder_inverse_depth } => {
            to.write_all(&[words.len() as u8])?;
            words.iter().try_for_each(|word| to.write_all(&word.to_le_bytes()))?;
            write_f32s(to, &[*occluder_inverse_depth])
        }
    }
}

fn read_sample(from: &mut impl Read) -> Result<Sample, SalfFileError> {
    let [cx, cy, hx, hy, inverse_depth, weight, tx, ty, r, g, b] = read_f32s(from)?;
    let surface = match u32::from_le_bytes(bytes(from)?) {
        BACKGROUND => None,
        triangle => {
            let barycentric = DVec2::from_array(read_f64s(from)?);
            Some(SurfacePoint { triangle, barycentric })
        }
    };
    let visibility = match bytes(from)? {
        [0] => Visibility::Open,
        [count @ (1 | 4)] => {
            let words = (0..count).map(|_| Ok(u64::from_le_bytes(bytes(from)?)));
            let words = words.collect::<Result<_, SalfFileError>>()?;
            let [occluder_inverse_depth] = read_f32s(from)?;
            Visibility::Cells { words, occluder_inverse_depth }
        }
        [count] => return Err(SalfFileError::Damaged(format!("{count} words of visibility"))),
    };
    let finite = [cx, cy, hx, hy, inverse_depth, weight, tx, ty, r, g, b].iter().all(|x| x.is_finite());
    let occluded_somewhere = match visibility {
        Visibility::Open => true,
        Visibility::Cells { occluder_inverse_depth, .. } => occluder_inverse_depth.is_finite(),
    };
    let addressed = surface.is_none_or(|point| point.barycentric.is_finite());
    if !(finite && addressed && occluded_somewhere) {
        return Err(SalfFileError::Damaged("a sample that is not finite".into()));
    }
    Ok(Sample {
        center: Vec2::new(cx, cy),
        half_size: Vec2::new(hx, hy),
        inverse_depth,
        weight,
        tilt: Vec2::new(tx, ty),
        radiance: Vec3::new(r, g, b),
        surface,
        visibility,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> SalfFile {
        let mask = ApertureMask { width: 2, height: 1, transmission: vec![0.25, 1.0], file: "f.png".into() };
        let camera = Camera {
            aperture: Aperture { shape: ApertureShape::Mask(mask.into()), ratio: 1.5 },
            focus_distance: f64::INFINITY,
            ..Camera::default()
        };
        let on_surface = Sample {
            center: Vec2::new(1.5, -2.0),
            half_size: Vec2::splat(0.5),
            inverse_depth: 0.3,
            weight: 1.0,
            tilt: Vec2::new(0.1, 0.2),
            radiance: Vec3::new(1.0, 2.0, 3.0),
            surface: Some(SurfacePoint { triangle: 6, barycentric: DVec2::new(0.1, 0.7) }),
            visibility: Visibility::Cells {
                words: Box::new([1, 2, 3, u64::MAX]),
                occluder_inverse_depth: 0.7,
            },
        };
        let background =
            Sample { surface: None, visibility: Visibility::Open, inverse_depth: 0.0, ..on_surface.clone() };
        let salf = Salf { camera, margin_px: 32, samples: vec![on_surface, background] };
        SalfFile { source: "garden.glb".into(), triangles: 7, salf: Arc::new(salf) }
    }

    fn written(file: &SalfFile) -> Vec<u8> {
        let mut bytes = Vec::new();
        file.write(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn what_is_written_is_read() {
        let file = file();
        let read = SalfFile::read(written(&file).as_slice()).unwrap();
        assert_eq!((read.source.as_str(), read.triangles), ("garden.glb", 7));
        assert_eq!(read.salf.camera, file.salf.camera);
        assert_eq!((read.salf.margin_px, &read.salf.samples), (32, &file.salf.samples));
    }

    #[test]
    fn every_flipped_bit_and_every_cut_is_noticed() {
        let good = written(&file());
        for index in 0..good.len() {
            let mut bad = good.clone();
            bad[index] ^= 0x10;
            assert!(SalfFile::read(bad.as_slice()).is_err(), "byte {index}");
            assert!(SalfFile::read(&good[..index]).is_err(), "cut at {index}");
        }
        let few = SalfFile { triangles: 6, ..file() };
        let error = SalfFile::read(written(&few).as_slice()).unwrap_err();
        assert!(error.to_string().contains("triangle"), "{error}");
    }
}
