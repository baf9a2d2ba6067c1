//! The palette of colours beyond degree 0: 64 entries a row, each as many pixels wide as it has coefficients.

use super::super::reading::Reading;
use super::container::Container;
use super::meta::PaletteMeta;
use super::texture::Texture;
use crate::cloud::harmonics::coefficient_count;
use crate::error::{GaussianError, quoted};

const ENTRIES_PER_ROW: u32 = 64;

/// Labels have 16 bits.
const MAX_ROWS: u32 = (1 << 16) / ENTRIES_PER_ROW;

/// The highest degree that SOG has.
const MAX_DEGREE: u32 = 3;

/// The colours of all splats.
pub(super) struct Palette {
    degree: u32,
    entries: u64,
    values: Box<[f32; 256]>,
    centroids: Texture,
    labels: Texture,
}

impl Palette {
    /// Reads the pictures of a palette for `count` splats.
    ///
    /// # Errors
    /// A picture is missing or malformed, or the palette's size is that of no degree.
    pub fn read(
        reading: &Reading<'_>,
        container: &mut Container<'_>,
        meta: &PaletteMeta,
        count: u64,
    ) -> Result<Self, GaussianError> {
        let [centroids, labels] = &meta.files;
        let max_texels = u64::from(ENTRIES_PER_ROW * MAX_ROWS) * coefficient_count(MAX_DEGREE) as u64;
        let place = quoted(centroids);
        let centroids = Texture::read_sized(reading, container, centroids, max_texels, 0)?;
        let labels = Texture::read(reading, container, labels, count)?;
        let width_of = |degree: u32| ENTRIES_PER_ROW * coefficient_count(degree) as u32;
        let degree = (1..=MAX_DEGREE).find(|degree| width_of(*degree) == centroids.width);
        let Some(degree) = degree.filter(|degree| meta.degree.is_none_or(|declared| declared == *degree))
        else {
            let what = format!(
                "is {} pixels wide, which 64 entries of no degree (or not of the declared) are",
                centroids.width
            );
            return Err(reading.malformed(place, what));
        };
        let rows = u64::from(ENTRIES_PER_ROW) * u64::from(centroids.height);
        let entries = meta.entries.unwrap_or(rows).min(rows);
        Ok(Self { degree, entries, values: meta.values.clone(), centroids, labels })
    }

    /// The degree of the colours.
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.centroids.bytes() + self.labels.bytes()
    }

    /// The coefficients of a splat; 0 where its label is none of the palette.
    pub fn decode(&self, index: usize, coefficients: &mut [f32]) {
        let [low, high, _, _] = self.labels.pixel(index);
        let label = u32::from(u16::from_le_bytes([low, high]));
        if u64::from(label) >= self.entries {
            coefficients.fill(0.0);
            return;
        }
        let count = coefficient_count(self.degree);
        let first = (label / ENTRIES_PER_ROW * self.centroids.width) as usize
            + (label % ENTRIES_PER_ROW) as usize * count;
        for (k, rgb) in coefficients.chunks_exact_mut(3).enumerate() {
            let pixel = self.centroids.pixel(first + k);
            (0..3).for_each(|channel| rgb[channel] = self.values[pixel[channel] as usize]);
        }
    }
}
