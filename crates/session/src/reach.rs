//! Whether paint or lens spread light into the picture from further outside the frame than was baked.
//!
//! Only samples can tell, and a stroke moves few of them: whoever reaches too far is remembered, a bit a sample, and
//! those that moved are looked at again.

use focus::Focus;
use glam::DVec2;
use lens::{Camera, FocusOffset};
use rayon::prelude::*;
use salf::{LARGEST_MARGIN_HEIGHTS, Salf, Spot};
use scene::SurfaceField;

/// Which samples of a light field reach the frame with a circle of confusion that is wider than the baked margin.
///
/// A surface beyond the margin that has as wide a circle is of the same paint, as a rule, as one within it: as for the
/// margin itself (`BakeOptions::for_focus`), what is found within tells of what lies further out.
#[derive(Default)]
pub(crate) struct Reach {
    /// A bit a sample.
    too_far: Vec<u64>,
    /// How many are set.
    count: usize,
}

impl Reach {
    /// Looks at all samples.
    pub fn of_all(salf: &Salf, camera: &Camera, focus: &Focus) -> Self {
        let look = Look::new(salf, camera, focus);
        let far_of_run = |run: usize| {
            let run = salf.samples.run(run);
            let spots = run.indices.clone().zip(run.spots());
            spots.filter(|(_, spot)| look.at(spot)).map(|(index, _)| index).collect::<Vec<_>>()
        };
        let far: Vec<Vec<u32>> = (0..salf.samples.run_count()).into_par_iter().map(far_of_run).collect();
        let mut too_far = vec![0; salf.samples.len().div_ceil(64)];
        for &index in far.iter().flatten() {
            too_far[index as usize / 64] |= 1 << (index % 64);
        }
        Self { too_far, count: far.iter().map(Vec::len).sum() }
    }

    /// Looks again at those that moved; all of them must have been looked at before.
    pub fn look_again(&mut self, salf: &Salf, camera: &Camera, focus: &Focus, moved: &[u32]) {
        let look = Look::new(salf, camera, focus);
        for &index in moved {
            let word = &mut self.too_far[index as usize / 64];
            let mask = 1 << (index % 64);
            let (was, is) = (*word & mask != 0, look.at(&salf.samples.spot(index)));
            *word = if is { *word | mask } else { *word & !mask };
            self.count = self.count + usize::from(is) - usize::from(was);
        }
    }

    /// Whether any sample reaches too far.
    pub fn is_exceeded(&self) -> bool {
        self.count > 0
    }

    /// The margin that those would need which reach too far, px; 0 if none does.
    pub fn needed_px(&self, salf: &Salf, camera: &Camera, focus: &Focus) -> f64 {
        let look = Look::new(salf, camera, focus);
        let set = |(index, word): (usize, &u64)| (*word != 0).then_some((index * 64, *word));
        let of_word = |(first, word): (usize, u64)| {
            let bits = (0..64).filter(|bit| word >> bit & 1 == 1);
            bits.map(|bit| look.radius_px(&salf.samples.spot((first + bit) as u32))).fold(0.0, f64::max)
        };
        let words = self.too_far.par_iter().enumerate().filter_map(set);
        words.map(of_word).reduce(|| 0.0, f64::max).min(look.largest_px)
    }
}

/// How a sample is looked at.
struct Look<'a> {
    focus: &'a Focus,
    optics: lens::Optics,
    frame: DVec2,
    margin_px: f64,
    /// Wider than this no margin is made.
    largest_px: f64,
}

impl<'a> Look<'a> {
    fn new(salf: &Salf, camera: &Camera, focus: &'a Focus) -> Self {
        let frame = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        Self {
            focus,
            optics: camera.optics(),
            frame,
            margin_px: f64::from(salf.margin_px),
            largest_px: LARGEST_MARGIN_HEIGHTS * f64::from(camera.height),
        }
    }

    /// The radius of its circle of confusion, px.
    fn radius_px(&self, spot: &Spot) -> f64 {
        let offset: FocusOffset =
            spot.surface.map_or_else(|| self.focus.at_infinity(), |point| self.focus.at(point));
        let kappa = self.optics.kappa(f64::from(spot.inverse_depth), offset.or_standard());
        self.optics.splat_radius_px(kappa).abs()
    }

    /// Whether it reaches the frame from further outside than the margin.
    fn at(&self, spot: &Spot) -> bool {
        let radius = self.radius_px(spot);
        let center = spot.center.as_dvec2();
        let outside = (-center).max(center - self.frame).max_element();
        radius.min(self.largest_px) > self.margin_px && radius >= outside
    }
}
