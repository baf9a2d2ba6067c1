//! The `.salf` file: a baked light field, to be splatted again with another focus or lens.
//!
//! Little endian throughout:
//!
//! ```text
//! magic        8 bytes   "FBSALF\r\n"
//! version      u32       6, or 7 where there are records of splats; 8 and 9 are the same, baked on a graphics card
//! source       path      the scene or project it was baked from
//! triangles    u32       of that scene: what surface addresses count in
//! camera       see `write_camera`
//! margin       u32       px sampled outside the frame
//! counts       7 × u64   of blocks, records, planes, sub-cells, patches, codes, loose samples
//! blocks       each: corner 2 × i32 (px), where its records, planes, sub-cells, patches and codes begin, 5 × u32
//! records      16 bytes each: place, plane, barycentric 2 × u16, inverse depth (3 bytes), radiance (5 bytes);
//!              of splats: weight f16 and triangle u32 in place of plane and barycentric
//! planes       10 bytes each: triangle u32, weights 3 × f16
//! sub-cells    u16 each
//! patches      10 bytes each: place in the pixel (3 bytes), half size 2 × u16, largest weight (3 bytes)
//! codes        bytes
//! loose samples, one after the other:
//!   center, half_size     2 × f32 each
//!   inverse_depth, weight f32 each
//!   tilt                  2 × f32
//!   radiance              3 × f32
//!   triangle              u32, 2³² − 1 for the background; else followed by barycentrics, 2 × f64
//!   words                 u8: 0 open, else that many u64 of visibility cells (1 or 4)
//! checksum     32 bytes  SHA-256 of everything before
//! ```
//!
//! A text is its length in bytes (u32) and UTF-8; a path may have other bytes where the system lets it. What the packed
//! samples mean is told in `samples.rs` and below it.

mod camera;
mod error;
mod little_endian;
mod samples;

use crate::{Carried, Salf};
use camera::{read_camera, write_camera};
pub use error::SalfFileError;
use error::{content_of, version};
use little_endian::{bytes, read_path, write_path};
use samples::{read_samples, write_samples};
use sha2::{Digest, Sha256};
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;

const MAGIC: &[u8; 8] = b"FBSALF\r\n";

/// A light field and what it was baked from.
#[derive(Clone, Debug)]
pub struct SalfFile {
    /// The scene or project.
    pub source: PathBuf,
    /// How many triangles that scene has.
    pub triangles: u32,
    /// The light field.
    pub salf: Arc<Salf>,
}

impl SalfFile {
    /// Writes the file, with a checksum (SHA-256) at its end; the form is described in the book.
    ///
    /// # Errors
    /// Errors of `to`.
    pub fn write(&self, to: impl Write) -> io::Result<()> {
        let mut to = Hashing { inner: to, hash: Sha256::new() };
        self.write_head(&mut to)?;
        write_samples(&mut to, &self.salf.samples)?;
        let sum = to.hash.finalize();
        to.inner.write_all(&sum)?;
        to.inner.flush()
    }

    fn write_head(&self, to: &mut impl Write) -> io::Result<()> {
        to.write_all(MAGIC)?;
        let version = version(self.salf.samples.has_splats(), self.salf.baked_on);
        to.write_all(&version.to_le_bytes())?;
        write_path(to, &self.source)?;
        to.write_all(&self.triangles.to_le_bytes())?;
        write_camera(to, &self.salf.camera)?;
        to.write_all(&self.salf.margin_px.to_le_bytes())
    }

    /// The parts of the file but for its end: how many bytes each has, and in records of how many bytes. Bytes of a kind are alike.
    pub fn parts(&self) -> Vec<(usize, usize)> {
        let mut head = Vec::new();
        self.write_head(&mut head).expect("memory takes what is written");
        let lists = self.salf.samples.lists();
        std::iter::once((head.len(), 1)).chain(lists.map(|(count, bytes)| (count * bytes, bytes))).collect()
    }

    /// Reads a file and checks its form, its checksum and all values.
    ///
    /// # Errors
    /// [`SalfFileError`]: what is wrong with the file, or the error of `from`.
    pub fn read(from: impl Read) -> Result<Self, SalfFileError> {
        let mut from = Hashing { inner: from, hash: Sha256::new() };
        let magic: [u8; 8] = bytes(&mut from)?;
        if magic != *MAGIC {
            return Err(SalfFileError::NotSalf);
        }
        let version = u32::from_le_bytes(bytes(&mut from)?);
        let (has_splats, baked_on) = content_of(version).ok_or(SalfFileError::Version(version))?;
        let source = read_path(&mut from)?;
        let triangles = u32::from_le_bytes(bytes(&mut from)?);
        let camera = read_camera(&mut from)?;
        camera.validate().map_err(|error| SalfFileError::Damaged(error.to_string()))?;
        let margin_px = u32::from_le_bytes(bytes(&mut from)?);
        let samples = read_samples(&mut from, triangles)?;
        if samples.has_splats() != has_splats {
            return Err(SalfFileError::Damaged("splats in a version without them, or none".into()));
        }
        let expected = from.hash.clone().finalize();
        let stored: [u8; 32] = bytes(&mut from)?;
        if stored[..] != expected[..] {
            return Err(SalfFileError::Damaged("the checksum does not match".into()));
        }
        Ok(Self {
            source,
            triangles,
            salf: Arc::new(Salf { camera, margin_px, carried: Carried::Standard, baked_on, samples }),
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BakedOn, Sample, Visibility};
    use glam::{DVec2, Vec2, Vec3};
    use lens::{Aperture, ApertureMask, ApertureShape, Camera};
    use surface::SurfacePoint;

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
            is_carried: true,
            visibility: Visibility::Cells { words: Box::new([1, 2, 3, u64::MAX]) },
        };
        let background =
            Sample { surface: None, visibility: Visibility::Open, inverse_depth: 0.0, ..on_surface.clone() };
        let salf = Salf {
            camera,
            margin_px: 32,
            carried: Carried::Standard,
            baked_on: BakedOn::Card,
            samples: vec![on_surface, background].into(),
        };
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
        assert_eq!((read.source.to_str(), read.triangles), (Some("garden.glb"), 7));
        assert_eq!(read.salf.camera, file.salf.camera);
        assert_eq!((read.salf.margin_px, &read.salf.samples), (32, &file.salf.samples));
        assert_eq!(read.salf.baked_on, BakedOn::Card);
    }

    #[cfg(unix)]
    #[test]
    fn a_source_that_is_not_utf8_is_kept() {
        use std::os::unix::ffi::OsStrExt;
        let source = PathBuf::from(std::ffi::OsStr::from_bytes(b"caf\xe9/\xff.glb"));
        let read = SalfFile::read(written(&SalfFile { source: source.clone(), ..file() }).as_slice());
        assert_eq!(read.unwrap().source, source);
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
