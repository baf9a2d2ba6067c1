//! Whether paint or lens spread light into the picture from further outside the frame than was baked.
//!
//! This has to be tested per sample, but a stroke moves few samples. The result is stored as one bit per sample; only samples that have
//! moved since are tested again, and only after the stroke.

use focus::Focus;
use glam::DVec2;
use lens::Camera;
use rayon::prelude::*;
use salf::{LARGEST_MARGIN_HEIGHTS, Salf, SampleFocus, SampleLocation};

/// Which samples of a light field reach the frame with a circle of confusion that is wider than the baked margin.
///
/// As for the margin itself (`BakeOptions::for_focus`), surfaces beyond the margin are assumed to have similar paint to those within it.
pub(crate) struct MarginReach {
    /// One bit per sample: reaches too far.
    too_far: Vec<u64>,
    /// One bit per sample: moved since it was tested.
    moved: Vec<u64>,
}

impl MarginReach {
    /// Tests which samples of the light field reach too far for its margin.
    pub fn survey(salf: &Salf, camera: &Camera, focus: &Focus) -> Self {
        let test = MarginTest::new(salf, camera, focus);
        let far_in_run = |run: usize| {
            let run = salf.samples.run(run);
            let spots = run.indices.clone().zip(run.locations());
            spots.filter(|(_, spot)| test.exceeds_margin(spot)).map(|(index, _)| index).collect::<Vec<_>>()
        };
        let far: Vec<Vec<u32>> = (0..salf.samples.run_count()).into_par_iter().map(far_in_run).collect();
        let mut too_far = vec![0; salf.samples.len().div_ceil(WORD as usize)];
        set(&mut too_far, far.iter().flatten());
        Self { moved: vec![0; too_far.len()], too_far }
    }

    /// Notes the numbers of samples that moved.
    pub fn note_moved(&mut self, samples: &[u32]) {
        set(&mut self.moved, samples);
    }

    /// Tests again the samples that moved.
    pub fn retest_moved(&mut self, salf: &Salf, camera: &Camera, focus: &Focus) {
        let test = MarginTest::new(salf, camera, focus);
        let words = self.too_far.par_iter_mut().zip(&mut self.moved).enumerate();
        words.filter(|(_, (_, moved))| **moved != 0).for_each(|(word, (too_far, moved))| {
            let far =
                samples_of(word, *moved).filter(|&index| test.exceeds_margin(&salf.samples.location(index)));
            *too_far = far.fold(*too_far & !*moved, |far, index| far | 1 << (index % WORD));
            *moved = 0;
        });
    }

    /// Whether any sample reaches too far.
    pub fn is_exceeded(&self) -> bool {
        self.too_far.iter().any(|word| *word != 0)
    }

    /// The margin, px, that the samples that reach too far need; 0 if none does.
    pub fn needed_px(&self, salf: &Salf, camera: &Camera, focus: &Focus) -> f64 {
        let test = MarginTest::new(salf, camera, focus);
        let widest = |(word, bits): (usize, &u64)| {
            samples_of(word, *bits)
                .map(|index| test.radius_px(&salf.samples.location(index)))
                .fold(0.0, f64::max)
        };
        let words = self.too_far.par_iter().enumerate();
        words.map(widest).reduce(|| 0.0, f64::max).min(test.largest_px)
    }
}

/// Bits per word.
const WORD: u32 = u64::BITS;

/// Sets the bits of samples.
fn set<'a>(words: &mut [u64], samples: impl IntoIterator<Item = &'a u32>) {
    for index in samples {
        words[(index / WORD) as usize] |= 1 << (index % WORD);
    }
}

/// The samples whose bits are set in a word.
fn samples_of(word: usize, bits: u64) -> impl Iterator<Item = u32> {
    (0..WORD).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| word as u32 * WORD + bit)
}

/// The test of a sample.
struct MarginTest<'a> {
    focus: SampleFocus<'a>,
    optics: lens::Optics,
    frame: DVec2,
    margin_px: f64,
    /// Maximum margin, px.
    largest_px: f64,
}

impl<'a> MarginTest<'a> {
    fn new(salf: &Salf, camera: &Camera, focus: &'a Focus) -> Self {
        let frame = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        Self {
            focus: SampleFocus::new(focus),
            optics: camera.optics(),
            frame,
            margin_px: f64::from(salf.margin_px),
            largest_px: LARGEST_MARGIN_HEIGHTS * f64::from(camera.height),
        }
    }

    /// The radius of its circle of confusion, px.
    fn radius_px(&self, spot: &SampleLocation) -> f64 {
        let offset = self.focus.offset(spot.address);
        let kappa = self.optics.kappa(f64::from(spot.inverse_depth), offset.or_standard());
        self.optics.splat_radius_px(kappa).abs()
    }

    /// Whether it reaches the frame from further outside than the margin.
    fn exceeds_margin(&self, spot: &SampleLocation) -> bool {
        let radius = self.radius_px(spot);
        let center = spot.center.as_dvec2();
        let outside = (-center).max(center - self.frame).max_element();
        radius.min(self.largest_px) > self.margin_px && radius >= outside
    }
}
