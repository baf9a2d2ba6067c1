//! Sums over the picture, band by band: the same order of additions, and so the same bits, for any number of threads.

use lens::Picture;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixel rows that one thread sums at a time: their sums fit into a core's cache.
const BAND_ROWS: usize = 32;

/// Radiance and coverage a pixel, as they are summed.
pub struct PictureSum {
    width: usize,
    pixels: Vec<[f64; 4]>,
}

/// Some rows of a sum.
pub struct Band<'a> {
    width: i64,
    rows: Range<i64>,
    pixels: &'a mut [[f64; 4]],
}

impl Band<'_> {
    /// The rows.
    pub fn rows(&self) -> Range<i64> {
        self.rows.clone()
    }

    /// Adds `light` to the pixel in column `x` and row `y`, if it is in the band.
    #[inline(always)]
    pub fn add(&mut self, x: i64, y: i64, light: [f64; 4]) {
        if x >= 0 && x < self.width && self.rows.contains(&y) {
            let pixel = &mut self.pixels[((y - self.rows.start) * self.width + x) as usize];
            (0..4).for_each(|c| pixel[c] += light[c]);
        }
    }
}

impl PictureSum {
    /// A sum of nothing over `size` pixels.
    pub fn new(size: [u32; 2]) -> Self {
        Self { width: size[0] as usize, pixels: vec![[0.0; 4]; size[0] as usize * size[1] as usize] }
    }

    /// Lets every item deposit its light. `rows_of` gives the pixel rows that an item may touch; it is skipped for the others.
    /// In each band the items come in their order.
    pub fn add<T: Sync>(
        &mut self,
        items: &[T],
        rows_of: impl Fn(&T) -> Range<i64>,
        deposit: impl Fn(usize, &T, &mut Band) + Sync,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let width = self.width;
        let height = self.pixels.len() / width;
        let mut of_band = vec![Vec::new(); height.div_ceil(BAND_ROWS)];
        for (index, item) in items.iter().enumerate() {
            let rows = rows_of(item);
            let rows = rows.start.max(0) as usize..rows.end.clamp(0, height as i64) as usize;
            if !rows.is_empty() {
                let bands = rows.start / BAND_ROWS..rows.end.div_ceil(BAND_ROWS);
                of_band[bands].iter_mut().for_each(|band| band.push(index as u32));
            }
        }
        let done = AtomicUsize::new(0);
        let bands = self.pixels.par_chunks_mut(BAND_ROWS * width).zip(&of_band).enumerate();
        bands.try_for_each(|(band, (pixels, in_band))| {
            let first = (band * BAND_ROWS) as i64;
            let rows = first..first + (pixels.len() / width) as i64;
            let mut band = Band { width: width as i64, rows, pixels };
            for (count, &index) in in_band.iter().enumerate() {
                if count % 4096 == 0 {
                    progress.check()?;
                }
                deposit(index as usize, &items[index as usize], &mut band);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / of_band.len() as f32);
            Ok(())
        })
    }

    /// The sum as a picture.
    pub fn into_picture(self) -> Picture {
        Picture {
            width: self.width as u32,
            height: (self.pixels.len() / self.width) as u32,
            radiance: self.pixels.iter().map(|&[r, g, b, _]| [r as f32, g as f32, b as f32]).collect(),
            coverage: self.pixels.iter().map(|pixel| pixel[3] as f32).collect(),
            colour_coverage: None,
        }
    }
}
