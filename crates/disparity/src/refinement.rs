//! From labels to disparities: where the pictures determine a disparity it stays, elsewhere it follows its neighbours.
//!
//! Rounds of (1) the `evidence` of every pixel at its present disparity and (2) weighted least squares (`line_relaxation`) between that
//! and neighbours, whose bonds are weak across edges of the picture and jumps of the disparity (Geman–McClure weights of the present
//! differences). Before the first round plain surfaces, where labels are arbitrary, are filled from certain pixels around them, from
//! the farther ones: thin objects before a plain wall do not pull it toward them.

pub mod evidence;
pub mod line_relaxation;
pub mod occlusion;

use crate::matching::labels::Labels;
use crate::matching::sweep::ShiftedView;
use crate::planes::Planes;
use crate::refinement::evidence::{Evidence, collect_evidence};
use crate::refinement::line_relaxation::Bonds;
use progress::{Cancelled, Progress, Stage};

/// Rounds of evidence and smoothing.
const ROUNDS: usize = 5;

/// Typical difference of neighbouring disparities, pixels in the farthest view.
const SLOPE_PX: f32 = 0.1;

/// The difference of colours (sum of three channels) that halves a bond.
const EDGE: f32 = 0.03;

/// The least bond across an edge, relative to one without: plain surfaces that touch nothing certain still get a
/// value.
const LEAST_BOND: f32 = 1e-4;

/// The difference of neighbours where a surface ends, labels.
const JUMP_LABELS: f32 = 2.0;

/// Rounds that a membrane takes to converge, on each size of picture.
const SETTLING: usize = 8;

/// The weight at first of a certain pixel that is nearer than the membrane: plain surfaces lie where the farthest of their edges do, even
/// if those are few and far away.
const LIFT: f32 = 0.003;

/// Rounds with that low weight, and the rounds after them, in which pixels near the membrane have full weight.
const BEHIND: usize = 3;
const ATTACHED: usize = 5;

/// The power of colour similarity in a membrane's bonds: edges stop it more than they stop the last rounds.
const MEMBRANE_POWER: i32 = 3;

/// The least bond of a membrane across an edge, relative to one without.
const LEAST_MEMBRANE_BOND: f32 = 1e-8;

/// The membrane is used where at least this share of the views sees it,
const MIN_VISIBILITY: f32 = 0.5;

/// and where their agreement drops by no more than this.
const MAX_AGREEMENT_LOSS: f32 = 0.1;

/// Certainties below this share of the smoothness do not hold the membrane: noise alone hardly ever exceeds it.
const MIN_MEMBRANE_CERTAINTY: f32 = 0.3;

/// A pixel whose weight relative to its neighbours is below this takes the membrane whether views agree or not.
const OPEN: f32 = 0.05;

/// The power of the views' agreement that multiplies certainty: what only half of the views confirm is hardly
/// certain.
const AGREEMENT_POWER: i32 = 6;

/// The best accuracy: pixels in the farthest view.
const BEST_PX: f32 = 0.01;

/// The inputs of a refinement.
pub struct Refinement<'a> {
    /// The picture whose disparities are refined.
    pub reference: &'a Planes,
    /// The other views.
    pub others: &'a [ShiftedView<'a>],
    /// A part of them, spread evenly: enough for all rounds but the last.
    pub subset: &'a [ShiftedView<'a>],
    /// The labels: their range is not exceeded.
    pub labels: Labels,
    /// Standard deviation of the noise of a value.
    pub noise: f32,
    /// The largest coordinate of an offset.
    pub reach: f32,
}

impl Refinement<'_> {
    /// Refines `disparity` except where `is_fixed`; returns the evidence for the result.
    pub fn run(
        &self,
        disparity: &mut Vec<f32>,
        is_fixed: &(impl Fn(usize) -> bool + Sync),
        progress: &dyn Progress,
    ) -> Result<Vec<Evidence>, Cancelled> {
        let is_free = |index: usize| !is_fixed(index);
        let mut evidence = Vec::new();
        let part = |k: usize| k as f32 / (ROUNDS + 2) as f32;
        self.fill_open_areas(disparity, is_fixed, &Stage::new(progress, 0.0, part(2)))?;
        for round in 0..ROUNDS {
            let stage = Stage::new(progress, part(round + 2), part(round + 3));
            let views = if round + 1 < ROUNDS { self.subset } else { self.others };
            evidence = collect_evidence(self.reference, views, disparity, self.noise, &is_free, &stage)?;
            let (certainty, target) = self.data_term(disparity, &evidence, is_fixed);
            self.bonds(disparity).relax(disparity, &certainty, &target, 6);
        }
        Ok(evidence)
    }

    /// The certainty and the target disparity of every pixel.
    fn data_term(
        &self,
        disparity: &[f32],
        evidence: &[Evidence],
        is_fixed: &impl Fn(usize) -> bool,
    ) -> (Vec<f32>, Vec<f32>) {
        let best = (self.reach / BEST_PX).powi(2);
        let (low, high) = (self.labels.low, self.labels.disparity((self.labels.count - 1) as f32));
        let pixels = disparity.iter().zip(evidence).enumerate();
        pixels
            .map(|(index, (d, own))| {
                if is_fixed(index) {
                    return (best, *d);
                }
                // A step is only valid nearby: no more than a label at once.
                let step = own.step.clamp(-self.labels.step, self.labels.step);
                let certainty = own.certainty * own.agreement.powi(AGREEMENT_POWER);
                (certainty.min(best), (d + step).clamp(low, high))
            })
            .unzip()
    }

    /// The certainty that balances one neighbour's bond.
    fn smoothness(&self) -> f32 {
        (self.reach / SLOPE_PX).powi(2)
    }

    /// The similarity of two pixels by their colours.
    fn likeness(&self, a: usize, b: usize) -> f32 {
        let width = self.reference.width();
        let colour = |index: usize| self.reference.pixel(index % width, index / width);
        let (a, b) = (colour(a), colour(b));
        let difference: f32 = (0..3).map(|c| (a[c] - b[c]).abs()).sum();
        1.0 / (1.0 + (difference / EDGE).powi(2))
    }

    /// Moves uncertain pixels to a membrane through the certain ones; also certain ones, if the views agree as well there: next to an edge, a
    /// plain surface may lie where the edge does, or anywhere behind it.
    fn fill_open_areas(
        &self,
        disparity: &mut [f32],
        is_fixed: &(impl Fn(usize) -> bool + Sync),
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let is_free = |index: usize| !is_fixed(index);
        let evidence_at = |disparity: &[f32], from: f32, to: f32| {
            let stage = Stage::new(progress, from, to);
            collect_evidence(self.reference, self.subset, disparity, self.noise, &is_free, &stage)
        };
        let evidence = evidence_at(disparity, 0.0, 0.4)?;
        let (certainty, target) = self.data_term(disparity, &evidence, is_fixed);
        let membrane = self.membrane(&certainty, &target);
        let membrane_evidence = evidence_at(&membrane, 0.6, 1.0)?;
        let jump = self.jump();
        for index in (0..disparity.len()).filter(|index| is_free(*index)) {
            let own = certainty[index] / (certainty[index] + self.smoothness());
            let (target, membrane) = (target[index], membrane[index]);
            if (membrane - target).abs() < jump {
                disparity[index] = own * target + (1.0 - own) * membrane;
                continue;
            }
            let agrees = own < OPEN
                || membrane_evidence[index].agreement > evidence[index].agreement - MAX_AGREEMENT_LOSS;
            if agrees && membrane_evidence[index].visibility > MIN_VISIBILITY {
                disparity[index] = membrane;
            }
        }
        Ok(())
    }

    /// A membrane that is held by certain pixels and cut by edges of the picture. An edge belongs to the nearer of its two sides: a surface
    /// lies where the farthest of its edges are, and what is nearer occludes it. So pixels nearer than the membrane have little weight at
    /// first (asymmetric least squares: Newey and Powell, 1987), then as much as they are close to it.
    fn membrane(&self, certainty: &[f32], target: &[f32]) -> Vec<f32> {
        let (smoothness, jump) = (self.smoothness(), self.jump());
        let bonds = Bonds::new(self.reference.width(), self.reference.height(), |a, b| {
            smoothness * (self.likeness(a, b).powi(MEMBRANE_POWER) + LEAST_MEMBRANE_BOND)
        });
        let held = |c: f32| if c < MIN_MEMBRANE_CERTAINTY * smoothness { 0.0 } else { c.min(smoothness) };
        let held: Vec<f32> = certainty.iter().map(|c| held(*c)).collect();
        let mut membrane = target.to_vec();
        bonds.solve_coarse_to_fine(&mut membrane, &held, target, SETTLING);
        for round in 0..BEHIND + ATTACHED {
            let counted = |nearer: f32| match nearer > 0.0 {
                true if round < BEHIND => LIFT,
                true => (-(nearer / jump).powi(2)).exp(),
                false => 1.0,
            };
            let pixels = held.iter().zip(target.iter().zip(&membrane));
            let weights: Vec<f32> =
                pixels.map(|(held, (target, membrane))| held * counted(target - membrane)).collect();
            bonds.solve_coarse_to_fine(&mut membrane, &weights, target, SETTLING);
        }
        membrane
    }

    /// The least step of disparity where a surface ends.
    fn jump(&self) -> f32 {
        JUMP_LABELS * self.labels.step
    }

    /// Bonds by colours and by the present disparities.
    fn bonds(&self, disparity: &[f32]) -> Bonds {
        let (smoothness, jump) = (self.smoothness(), self.jump());
        Bonds::new(self.reference.width(), self.reference.height(), |a, b| {
            let difference = (disparity[a] - disparity[b]) / jump;
            smoothness * (self.likeness(a, b) + LEAST_BOND) / (1.0 + difference * difference).powi(2)
        })
    }
}
