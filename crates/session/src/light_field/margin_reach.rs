//! Whether paint or lens spread light into the picture from further outside the frame than was baked.
//!
//! This has to be tested per sample, but a stroke moves few samples. The result is stored as one bit per sample; only samples that have
//! moved since are tested again, and only after the stroke.

use focus::Focus;
use glam::DVec2;
use lens::Camera;
use rayon::prelude::*;
use salf::{LARGEST_MARGIN_HEIGHTS, Salf, SampleFocus, SampleLocation};
use splat::{Splatter, WideImage};

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
    /// Tests which samples reach too far for the margin of their light field, as they were summed for `camera`.
    pub fn survey(splatter: &Splatter, camera: &Camera) -> Self {
        let salf = splatter.salf();
        let [margin_px, largest_px] = margins(salf, camera);
        let frame = frame(camera);
        // One that is as large as can be is enough.
        let least_px = if margin_px < largest_px { margin_px } else { f64::INFINITY };
        let images = splatter.images_wider_than(least_px);
        let is_in_frame =
            |image: &&WideImage| f64::from(image.radius_px) >= outside(image.center_px.as_dvec2(), frame);
        let mut too_far = vec![0; salf.samples.len().div_ceil(WORD as usize)];
        set(&mut too_far, images.iter().filter(is_in_frame).map(|image| &image.sample));
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

/// Whether any sample of a light field that is not summed reaches too far for its margin.
pub(crate) fn exceeds_margin(salf: &Salf, camera: &Camera, focus: &Focus) -> bool {
    let test = MarginTest::new(salf, camera, focus);
    (0..salf.samples.run_count())
        .into_par_iter()
        .any(|run| salf.samples.run(run).locations().any(|spot| test.exceeds_margin(&spot)))
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
        let [margin_px, largest_px] = margins(salf, camera);
        let (focus, optics) = (SampleFocus::new(focus), camera.optics());
        Self { focus, optics, frame: frame(camera), margin_px, largest_px }
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
        radius.min(self.largest_px) > self.margin_px && radius >= outside(spot.center.as_dvec2(), self.frame)
    }
}

/// The margin that is baked, and the largest that could be, px.
fn margins(salf: &Salf, camera: &Camera) -> [f64; 2] {
    [salf.margin_px.into(), LARGEST_MARGIN_HEIGHTS * f64::from(camera.height)]
}

/// Columns and rows.
fn frame(camera: &Camera) -> DVec2 {
    DVec2::new(camera.width.into(), camera.height.into())
}

/// How far outside of the frame a place is, px; below 0 inside.
fn outside(center: DVec2, frame: DVec2) -> f64 {
    (-center).max(center - frame).max_element()
}
