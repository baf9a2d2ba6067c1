//! From labels to disparities: what the pictures tell is kept, what they leave open follows its neighbours.
//!
//! Rounds of (1) the `evidence` of every pixel at its present disparity and (2) weighted least squares (`lines`) between that and
//! neighbours, whose bonds are weak over edges of the picture and over jumps of the disparity (Geman–McClure weights of the present
//! differences). Before the first round plain surfaces, where a label says nothing, are filled from what is certain around them.

use crate::evidence::{Evidence, evidence};
use crate::labels::Labels;
use crate::lines::Bonds;
use crate::planes::Planes;
use crate::sweep::Shifted;
use progress::{Cancelled, Progress, Stage};

/// Rounds of evidence and smoothing. More than four gain a tenth of what the last one does.
const ROUNDS: usize = 4;

/// How much disparities of neighbours differ, pixels in the farthest view.
const SLOPE_PX: f32 = 0.1;

/// The difference of colours (sum of three channels) that halves a bond.
const EDGE: f32 = 0.03;

/// What a bond over an edge is at least, of one without: plain surfaces that touch nothing certain still get a value.
const LEAST_BOND: f32 = 1e-4;

/// Labels that neighbours differ by where a surface ends.
const JUMP_LABELS: f32 = 2.0;

/// Filling reaches so far: the square root of this, pixels.
const FILL_STRENGTH: f32 = 100.0;

/// Certainties below this share of the smoothness' own fill nothing.
const FILLING: f32 = 0.05;

/// The power of the views' agreement that certainty is multiplied by: what only half of the views that see it say is not said.
const AGREEMENT_POWER: i32 = 6;

/// The best that is believed: pixels in the farthest view.
const BEST_PX: f32 = 0.01;

/// Disparities that are refined.
pub struct Refinement<'a> {
    /// The picture whose disparities they are.
    pub reference: &'a Planes,
    /// The others.
    pub others: &'a [Shifted<'a>],
    /// A part of them, spread evenly: enough for all rounds but the last.
    pub few: &'a [Shifted<'a>],
    /// The labels they come from: their range is kept.
    pub labels: Labels,
    /// Standard deviation of the noise of a value.
    pub noise: f32,
    /// The largest coordinate of an offset.
    pub reach: f32,
}

impl Refinement<'_> {
    /// Refines `disparity` where it is not `known`; returns the evidence for what came out.
    pub fn run(
        &self,
        disparity: &mut Vec<f32>,
        known: &(impl Fn(usize) -> bool + Sync),
        progress: &dyn Progress,
    ) -> Result<Vec<Evidence>, Cancelled> {
        let asked = |index: usize| !known(index);
        let mut told = Vec::new();
        for round in 0..ROUNDS {
            let part = |k: usize| (round as f32 + k as f32 / 2.0) / (ROUNDS as f32 + 0.5);
            let stage = Stage::new(progress, part(0), part(1));
            let views = if round + 1 < ROUNDS { self.few } else { self.others };
            told = evidence(self.reference, views, disparity, self.noise, &asked, &stage)?;
            let (certainty, target) = self.data(disparity, &told, known);
            if round == 0 {
                self.fill(disparity, &certainty, &target);
            }
            self.bonds(disparity).relax(disparity, &certainty, &target, 6);
            progress.report(part(2));
        }
        Ok(told)
    }

    /// How certain every pixel is of which disparity.
    fn data(
        &self,
        disparity: &[f32],
        told: &[Evidence],
        known: &impl Fn(usize) -> bool,
    ) -> (Vec<f32>, Vec<f32>) {
        let best = (self.reach / BEST_PX).powi(2);
        let (low, high) = (self.labels.low, self.labels.disparity((self.labels.count - 1) as f32));
        let pixels = disparity.iter().zip(told).enumerate();
        pixels
            .map(|(index, (d, told))| {
                if known(index) {
                    return (best, *d);
                }
                // A step is only right nearby: no more than a label at once.
                let step = told.step.clamp(-self.labels.step, self.labels.step);
                let certainty = told.certainty * told.agreement.powi(AGREEMENT_POWER);
                (certainty.min(best), (d + step).clamp(low, high))
            })
            .unzip()
    }

    /// The certainty that stands against one neighbour's bond.
    fn smoothness(&self) -> f32 {
        (self.reach / SLOPE_PX).powi(2)
    }

    /// How much two pixels hang together by their colours.
    fn likeness(&self, a: usize, b: usize) -> f32 {
        let width = self.reference.width();
        let colour = |index: usize| self.reference.pixel(index % width, index / width);
        let (a, b) = (colour(a), colour(b));
        let difference: f32 = (0..3).map(|c| (a[c] - b[c]).abs()).sum();
        1.0 / (1.0 + (difference / EDGE).powi(2))
    }

    /// Spreads what is certain to what is not, along like colours: a quotient of two smoothed pictures.
    fn fill(&self, disparity: &mut [f32], certainty: &[f32], target: &[f32]) {
        let (width, height) = (self.reference.width(), self.reference.height());
        let bonds = Bonds::new(width, height, |a, b| self.likeness(a, b));
        let smoothness = self.smoothness();
        let counted = |certainty: f32| if certainty < FILLING * smoothness { 0.0 } else { certainty };
        let mut weights: Vec<f32> = certainty.iter().map(|c| counted(*c)).collect();
        let mut sums: Vec<f32> = weights.iter().zip(target).map(|(weight, target)| weight * target).collect();
        bonds.smooth(&mut weights, FILL_STRENGTH);
        bonds.smooth(&mut sums, FILL_STRENGTH);
        for (index, d) in disparity.iter_mut().enumerate() {
            // Where nothing certain is within reach, the label stays.
            if weights[index] > 1e-12 * smoothness {
                let own = certainty[index] / (certainty[index] + smoothness);
                *d = own * target[index] + (1.0 - own) * sums[index] / weights[index];
            }
        }
    }

    /// Bonds by colours and by the present disparities.
    fn bonds(&self, disparity: &[f32]) -> Bonds {
        let jump = JUMP_LABELS * self.labels.step;
        let smoothness = self.smoothness();
        Bonds::new(self.reference.width(), self.reference.height(), |a, b| {
            let apart = (disparity[a] - disparity[b]) / jump;
            smoothness * (self.likeness(a, b) + LEAST_BOND) / (1.0 + apart * apart).powi(2)
        })
    }
}
