//! Summing all samples of a light field, band by band.

use crate::accumulator::Band;
use crate::lens_in_use::{Placed, SplatLens};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use salf::{Sample, Visibility};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixel rows that one thread sums at a time: their sums fit into a core's cache.
const BAND_ROWS: usize = 32;

/// The two sums of a picture, as differences along its rows, C channels each.
pub struct Sums<'a, const C: usize> {
    /// Picture width, px.
    pub width: usize,
    /// Open samples, and painted ones.
    pub free: &'a mut [[i64; C]],
    /// Unpainted samples that see part of the aperture.
    pub sharing: &'a mut [[i64; C]],
}

/// Whether a sample shares what open samples leave (see [`crate::partition`]).
pub fn is_sharing(sample: &Sample, placed: Placed) -> bool {
    placed.is_standard && sample.visibility != Visibility::Open
}

impl<const C: usize> Sums<'_, C> {
    /// Sets the sums to those of `samples`, `light` times each.
    pub fn set(
        &mut self,
        lens: &SplatLens,
        samples: &[Sample],
        placed: &[Placed],
        light: &(impl Fn(&Sample) -> [f64; C] + Sync),
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let width = self.width;
        let of_band = samples_of_bands(self.free.len() / width, lens, samples, placed);
        let done = AtomicUsize::new(0);
        let free = self.free.par_chunks_mut(BAND_ROWS * width);
        let sharing = self.sharing.par_chunks_mut(BAND_ROWS * width);
        free.zip(sharing).zip(&of_band).enumerate().try_for_each(|(index, ((free, sharing), in_band))| {
            progress.check()?;
            let first = (index * BAND_ROWS) as i64;
            let rows = first..first + (free.len() / width) as i64;
            free.fill([0; C]);
            sharing.fill([0; C]);
            let mut free = Band::new(width, rows.clone(), free);
            let mut sharing = Band::new(width, rows, sharing);
            for &index in in_band {
                let (sample, placed) = (&samples[index as usize], placed[index as usize]);
                let band = if is_sharing(sample, placed) { &mut sharing } else { &mut free };
                lens.image(sample, placed).deposit(band, &light(sample), 1);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / of_band.len() as f32);
            Ok(())
        })
    }
}

/// The samples that reach into each band of a picture of `height` rows.
fn samples_of_bands(height: usize, lens: &SplatLens, samples: &[Sample], placed: &[Placed]) -> Vec<Vec<u32>> {
    let mut of_band = vec![Vec::new(); height.div_ceil(BAND_ROWS)];
    for (index, (sample, placed)) in samples.iter().zip(placed).enumerate() {
        let rows = lens.image(sample, *placed).rows();
        let rows = rows.start.max(0) as usize..rows.end.clamp(0, height as i64) as usize;
        if !rows.is_empty() {
            let bands = rows.start / BAND_ROWS..rows.end.div_ceil(BAND_ROWS);
            of_band[bands].iter_mut().for_each(|band| band.push(index as u32));
        }
    }
    of_band
}
