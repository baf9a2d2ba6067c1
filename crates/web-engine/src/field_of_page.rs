//! What a page holds: a light field with the focus of its samples.
//!
//! Little endian:
//!
//! ```text
//! magic      8 bytes   "FBPAGE\r\n"
//! version    u32       1
//! exposure   u32       0 conserved, 1 normalised
//! gain       f32       what radiances are multiplied by
//! painted    u32       the number of samples, or 0 where none is painted
//! t          f32 each, in four columns
//! anchor     f32 each, in four columns
//! parts      u32       of the field; then the bytes of each and the columns of each, 2 × u32
//! field      a .salf file of trimmed samples, part by part in columns; what is left in one
//! ```
//!
//! *Columns*: first every nth byte from the first on, then every nth from the second on … Bytes of a kind then follow each other, which
//! compresses to less.

use crate::error::EngineError;
use lens::{Exposure, FocusOffset};
use salf::{Address, Salf, SalfFile, SampleFocus};
use std::sync::Arc;
use surface::SurfaceField;

const MAGIC: &[u8; 8] = b"FBPAGE\r\n";
const VERSION: u32 = 1;
/// Bytes of a number of the paint.
const NUMBER: usize = size_of::<f32>();
/// No record has more bytes.
const MOST_COLUMNS: usize = 64;
/// t and anchor of what is not painted.
const STANDARD: [f32; 2] = [1.0, 0.0];

/// A light field, and the focus of each of its samples.
#[derive(Clone, Debug)]
pub struct FieldOfPage {
    /// The light field. Surface addresses are not used.
    pub salf: Arc<Salf>,
    /// t and anchor of every sample, carried light's included; `None` where all is focused by the ordinary lens.
    pub focus: Option<Vec<[f32; 2]>>,
    /// How the picture is exposed.
    pub exposure: Exposure,
    /// What its radiance is multiplied by, > 0.
    pub gain: f32,
}

impl FieldOfPage {
    /// The samples of a light field, trimmed, with their focus.
    pub fn new(salf: &Salf, focus: &dyn SurfaceField<FocusOffset>, exposure: Exposure) -> Self {
        let of_samples = SampleFocus::new(focus);
        let numbers = |address: Address| {
            let FocusOffset { t, anchor, .. } = of_samples.offset(address).or_standard();
            [t as f32, anchor as f32]
        };
        let mut addresses = salf.samples.addresses();
        let focus: Vec<_> =
            (0..salf.samples.len() as u32).map(|sample| numbers(addresses.get(sample))).collect();
        let is_painted = focus.iter().any(|numbers| *numbers != STANDARD);
        let samples = salf.samples.clone().trimmed();
        Self {
            salf: Arc::new(Salf { camera: salf.camera.clone(), samples, ..*salf }),
            focus: is_painted.then_some(focus),
            exposure,
            gain: 1.0,
        }
    }

    /// The focus of every sample.
    pub fn focus_of_samples(&self) -> Vec<FocusOffset> {
        match &self.focus {
            None => vec![FocusOffset::STANDARD; self.salf.samples.len()],
            Some(numbers) => {
                numbers.iter().map(|&[t, anchor]| FocusOffset::new(t.into(), anchor.into())).collect()
            }
        }
    }

    /// Its bytes, not compressed.
    pub fn to_bytes(&self) -> Vec<u8> {
        let exposure = u32::from(self.exposure == Exposure::Normalise);
        let focus = self.focus.as_deref().unwrap_or_default();
        let mut bytes = MAGIC.to_vec();
        for number in [VERSION, exposure, self.gain.to_bits(), focus.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        for channel in [0, 1] {
            let numbers: Vec<u8> = focus.iter().flat_map(|numbers| numbers[channel].to_le_bytes()).collect();
            bytes.extend(to_columns(&numbers, NUMBER));
        }
        let file = SalfFile { source: "page".into(), triangles: 1, salf: self.salf.clone() };
        let mut field = Vec::new();
        file.write(&mut field).expect("memory takes what is written");
        let parts = file.parts();
        bytes.extend((parts.len() as u32).to_le_bytes());
        for (length, columns) in &parts {
            bytes
                .extend([*length, *columns].map(|number| number as u32).map(u32::to_le_bytes).as_flattened());
        }
        let mut rest = &*field;
        for (length, columns) in parts {
            let (part, after) = rest.split_at(length);
            bytes.extend(to_columns(part, columns));
            rest = after;
        }
        bytes.extend(rest);
        bytes
    }

    /// Reads them, and checks all that is in them.
    ///
    /// # Errors
    /// [`EngineError`]: what is wrong with the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, EngineError> {
        let damaged = EngineError::Damaged;
        let head = bytes.strip_prefix(MAGIC).ok_or(damaged("it is none"))?;
        let (head, rest) = head.split_first_chunk::<16>().ok_or(damaged("it is cut short"))?;
        let [version, exposure, gain, painted] =
            [0, 4, 8, 12].map(|at| u32::from_le_bytes(std::array::from_fn(|k| head[at + k])));
        if version != VERSION {
            return Err(damaged("it is of another version than the page's program"));
        }
        let exposure = match exposure {
            0 => Exposure::Conserve,
            1 => Exposure::Normalise,
            _ => return Err(damaged("its exposure makes no sense")),
        };
        let gain = f32::from_bits(gain);
        if !(gain.is_finite() && gain > 0.0) {
            return Err(damaged("its gain makes no sense"));
        }
        let channel = painted as usize * NUMBER;
        if channel > rest.len() / 2 {
            return Err(damaged("its paint is cut short"));
        }
        let (paint, rest) = rest.split_at(2 * channel);
        let salf = SalfFile::read(&*field(rest).ok_or(damaged("its parts are cut short"))?)?.salf;
        let [t, anchor] = [&paint[..channel], &paint[channel..]].map(numbers);
        let focus: Vec<_> = t.into_iter().zip(anchor).map(|(t, anchor)| [t, anchor]).collect();
        if painted > 0 && focus.len() != salf.samples.len() {
            return Err(damaged("its paint is that of another light field"));
        }
        Ok(Self { salf, focus: (painted > 0).then_some(focus), exposure, gain })
    }
}

/// The bytes of the field from its parts; `None` if a part is missing.
fn field(bytes: &[u8]) -> Option<Vec<u8>> {
    let (count, rest) = bytes.split_first_chunk()?;
    let (table, mut rest) = rest.split_at_checked((u32::from_le_bytes(*count) as usize).checked_mul(8)?)?;
    let mut field = Vec::with_capacity(rest.len());
    for part in table.chunks_exact(8) {
        let [length, columns] =
            [0, 4].map(|at| u32::from_le_bytes(std::array::from_fn(|k| part[at + k])) as usize);
        if !(1..=MOST_COLUMNS).contains(&columns) {
            return None;
        }
        let (part, after) = rest.split_at_checked(length)?;
        field.extend(from_columns(part, columns));
        rest = after;
    }
    field.extend(rest);
    Some(field)
}

/// Numbers from their bytes in columns.
fn numbers(columns: &[u8]) -> Vec<f32> {
    let bytes = from_columns(columns, NUMBER);
    bytes.chunks_exact(NUMBER).map(|number| f32::from_le_bytes(std::array::from_fn(|k| number[k]))).collect()
}

/// Every `stride`th byte from the first on, then every `stride`th from the second on …
fn to_columns(bytes: &[u8], stride: usize) -> Vec<u8> {
    (0..stride).flat_map(|column| bytes.iter().skip(column).step_by(stride).copied()).collect()
}

/// The inverse of [`to_columns`].
fn from_columns(columns: &[u8], stride: usize) -> Vec<u8> {
    let mut bytes = vec![0; columns.len()];
    let mut rest = columns.iter();
    for column in 0..stride {
        bytes.iter_mut().skip(column).step_by(stride).zip(&mut rest).for_each(|(byte, from)| *byte = *from);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_field::{PaintedWall, wall};

    #[test]
    fn columns_are_put_back() {
        let bytes: Vec<u8> = (0..37).collect();
        assert_eq!(to_columns(&bytes, 16)[..4], [0, 16, 32, 1]);
        for stride in [1, 4, 16, 64] {
            assert_eq!(from_columns(&to_columns(&bytes, stride), stride), bytes);
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let salf = wall();
        for field in [
            FieldOfPage::new(&salf, &PaintedWall, Exposure::Normalise),
            FieldOfPage {
                focus: None,
                gain: 2.0,
                ..FieldOfPage::new(&salf, &PaintedWall, Exposure::Conserve)
            },
        ] {
            let read = FieldOfPage::from_bytes(&field.to_bytes()).unwrap();
            assert_eq!((read.exposure, read.gain, &read.focus), (field.exposure, field.gain, &field.focus));
            assert_eq!((&read.salf.samples, &read.salf.camera), (&field.salf.samples, &salf.camera));
            assert_eq!(read.focus_of_samples().len(), salf.samples.len());
        }
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let field = FieldOfPage::new(&wall(), &PaintedWall, Exposure::Normalise);
        assert!(field.focus.is_some());
        let good = field.to_bytes();
        let is_refused = |bytes: &[u8]| FieldOfPage::from_bytes(bytes).is_err();
        assert!(!is_refused(&good));
        for length in (0..good.len()).step_by(997) {
            assert!(is_refused(&good[..length]), "cut at {length}");
        }
        let paint = 24..24 + 8 * field.salf.samples.len();
        for index in (0..good.len()).step_by(211).filter(|index| !paint.contains(index)) {
            let mut bad = good.clone();
            bad[index] ^= 0x22;
            assert!(is_refused(&bad), "byte {index}");
        }
    }
}
