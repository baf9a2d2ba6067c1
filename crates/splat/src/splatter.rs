//! The picture as a running integer sum that single samples can leave and enter.

use crate::accumulator::{Band, running_sum};
use crate::fixed_point::{BRIGHTEST, LARGEST_PIXEL, QUANTA};
use crate::lens_in_use::{Placed, SplatLens};
use crate::partition::share_of_partial;
use crate::sums::{Sums, is_sharing};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use salf::{Salf, Sample};
use scene::SurfaceField;
use std::ops::Range;
use std::sync::Arc;

/// Why a picture could not be summed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplatError {
    /// Nobody wants it any more.
    #[error("cancelled")]
    Cancelled,
    /// The integer sum could overflow.
    #[error("the scene's radiance is too high to be summed exactly (keep the brightest light below 1e6)")]
    Overflow,
}

impl From<Cancelled> for SplatError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// A SALF being looked at: sums that follow the focus as it is painted.
///
/// Two sums are kept in integers: `free` of open samples and of painted ones, and `sharing` of the unpainted samples that
/// see only part of the aperture; the latter share what the open ones leave of the standard picture.
pub struct Splatter {
    salf: Arc<Salf>,
    lens: SplatLens,
    /// Where each sample was last summed.
    placed: Vec<Placed>,
    free: Vec<[i64; 4]>,
    sharing: Vec<[i64; 4]>,
    /// By what the sharing sum is multiplied, a pixel.
    shares: Vec<f32>,
    /// The largest radiance of any sample, at least 1.
    brightest: f64,
    picture: Picture,
}

impl Splatter {
    /// Prepares to render `salf`. The picture is black until [`Self::render`].
    pub fn new(salf: Arc<Salf>) -> Self {
        let camera = &salf.camera;
        let pixels = camera.width as usize * camera.height as usize;
        let radiances = salf.samples.par_iter().map(|sample| sample.radiance.max_element());
        Self {
            brightest: radiances.reduce(|| 1.0, f32::max) as f64,
            lens: SplatLens::new(&camera.aperture, camera.optics(), camera.aperture_radius),
            placed: Vec::new(),
            free: vec![[0; 4]; pixels],
            sharing: vec![[0; 4]; pixels],
            shares: vec![1.0; pixels],
            picture: Picture::black(camera.width, camera.height),
            salf,
        }
    }

    /// The light field.
    pub fn salf(&self) -> &Arc<Salf> {
        &self.salf
    }

    /// The picture as it now is.
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    /// Sums the whole picture for a lens (`camera` may differ from the baked one in focus distance, aperture shape and a
    /// smaller aperture radius, nothing else) and a focus.
    ///
    /// After an error the picture is that of before, but the sums are not: render again before updating.
    pub fn render(
        &mut self,
        camera: &Camera,
        focus: &dyn SurfaceField<FocusOffset>,
        progress: &dyn Progress,
    ) -> Result<(), SplatError> {
        self.check_range()?;
        let samples = &self.salf.samples;
        self.lens = SplatLens::new(&camera.aperture, camera.optics(), self.salf.camera.aperture_radius);
        let lens = &self.lens;
        self.placed = samples.par_iter().map(|sample| lens.place(sample, focus)).collect();
        let is_painted = self.placed.iter().any(|placed| !placed.is_standard);

        let width = self.salf.camera.width as usize;
        let first = Stage::new(progress, 0.0, if is_painted { 0.6 } else { 1.0 });
        let mut sums = Sums { width, free: &mut self.free, sharing: &mut self.sharing };
        sums.set(lens, samples, &self.placed, &color, &first)?;
        self.shares = if is_painted {
            let standard: Vec<_> = samples.iter().map(|sample| lens.standard(sample)).collect();
            let (mut open, mut partial) = (vec![[0]; self.free.len()], vec![[0]; self.free.len()]);
            let mut sums = Sums { width, free: &mut open, sharing: &mut partial };
            sums.set(lens, samples, &standard, &|_| [1.0], &Stage::new(progress, 0.6, 1.0))?;
            shares_of(width, &open, &partial, 0)
        } else {
            shares_of(width, &self.free, &self.sharing, 3)
        };
        self.resolve(0..self.salf.camera.height)
    }

    /// Moves the given samples to where `focus` now sends them. Returns the rows of the picture that changed.
    ///
    /// Equal, bit for bit, to a render from scratch. Cost grows with the number of samples and the size of their splats.
    pub fn update(
        &mut self,
        focus: &dyn SurfaceField<FocusOffset>,
        samples: &[u32],
    ) -> Result<Range<u32>, SplatError> {
        assert_eq!(self.placed.len(), self.salf.samples.len(), "update follows a render");
        let (width, height) = (self.salf.camera.width as usize, self.salf.camera.height as i64);
        let mut changed = height..0;
        for &index in samples {
            let sample = &self.salf.samples[index as usize];
            let (old, new) = (self.placed[index as usize], self.lens.place(sample, focus));
            if old == new {
                continue;
            }
            self.placed[index as usize] = new;
            for (placed, sign) in [(old, -1), (new, 1)] {
                let image = self.lens.image(sample, placed);
                let rows = image.rows();
                changed = changed.start.min(rows.start)..changed.end.max(rows.end);
                let sum = if is_sharing(sample, placed) { &mut self.sharing } else { &mut self.free };
                let mut band = Band::new(width, 0..height, sum);
                image.deposit(&mut band, &color(sample), sign);
            }
        }
        let rows = changed.start.clamp(0, height) as u32..changed.end.clamp(0, height) as u32;
        if rows.is_empty() {
            return Ok(0..0);
        }
        self.resolve(rows.clone())?;
        Ok(rows)
    }

    /// Integrates `rows` of the sums to the picture.
    fn resolve(&mut self, rows: Range<u32>) -> Result<(), SplatError> {
        let width = self.salf.camera.width as usize;
        let range = rows.start as usize * width..rows.end as usize * width;
        let brightest = self.brightest;
        let sums =
            self.free[range.clone()].par_chunks(width).zip(self.sharing[range.clone()].par_chunks(width));
        let shares = self.shares[range.clone()].par_chunks(width);
        let radiance = self.picture.radiance[range.clone()].par_chunks_mut(width);
        let coverage = self.picture.coverage[range].par_chunks_mut(width);
        let lines = radiance.zip(coverage).zip(sums.zip(shares));
        lines.try_for_each(|((radiance, coverage), ((free, sharing), shares))| {
            for (x, (free, sharing)) in running_sum(free).zip(running_sum(sharing)).enumerate() {
                let share = shares[x] as f64;
                let value = |c: usize| (free[c] as f64 + share * sharing[c] as f64) / QUANTA;
                // A colour is at most the brightest radiance times the coverage, which cannot wrap itself.
                if free[3].max(sharing[3]) as f64 / QUANTA * brightest > LARGEST_PIXEL {
                    return Err(SplatError::Overflow);
                }
                radiance[x] = std::array::from_fn(|c| value(c) as f32);
                coverage[x] = value(3) as f32;
            }
            Ok(())
        })
    }

    /// Whether every sample is dim enough for the integers.
    fn check_range(&self) -> Result<(), SplatError> {
        let density = |sample: &Sample| {
            let footprint = 4.0 * sample.half_size.x * sample.half_size.y;
            (sample.weight.abs() + sample.tilt.abs().element_sum()) / footprint
        };
        let is_dim =
            |sample: &Sample| (sample.radiance.max_element().max(1.0) * density(sample)) as f64 <= BRIGHTEST;
        if self.salf.samples.par_iter().all(is_dim) { Ok(()) } else { Err(SplatError::Overflow) }
    }
}

/// Radiance and coverage.
fn color(sample: &Sample) -> [f64; 4] {
    let [r, g, b] = sample.radiance.as_dvec3().to_array();
    [r, g, b, 1.0]
}

/// What each pixel's sharing sum is multiplied by, from the sums of the standard picture, whose `channel` is coverage.
fn shares_of<const C: usize>(
    width: usize,
    open: &[[i64; C]],
    partial: &[[i64; C]],
    channel: usize,
) -> Vec<f32> {
    let lines = open.par_chunks(width).zip(partial.par_chunks(width));
    lines
        .flat_map_iter(|(open, partial)| {
            let covered = move |sum: [i64; C]| sum[channel] as f64 / QUANTA;
            running_sum(open)
                .zip(running_sum(partial))
                .map(move |(open, partial)| share_of_partial(covered(open), covered(partial)))
        })
        .collect()
}

#[cfg(test)]
mod tests;
