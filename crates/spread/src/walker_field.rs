//! The outcomes of screened random walks, at a ladder of reaches and anywhere between.

use crate::error::MAX_LABELS;
use crate::multigrid::{Hierarchy, Screened};
use crate::{Graph, SpreadError};
use progress::{Progress, Stage};
use rayon::prelude::*;
use std::ops::Range;

/// The least and the greatest mean free path of a walker, in links.
pub const LEAST_REACH: f64 = 2.0;
/// See [`LEAST_REACH`].
pub const GREATEST_REACH: f64 = 32768.0;

/// Reaches at which the equations are solved: from the least to the greatest, each four times the one before.
const RUNGS: usize = 8;
const RUNG_FACTOR: f64 = 4.0;

/// Logits are stored in units of 1/2048; a probability is at least e⁻¹² and at most 1 − e⁻¹².
const LOGIT_UNIT: f32 = 1.0 / 2048.0;
const GREATEST_LOGIT: f64 = 12.0;

/// The probabilities with which walkers from every node of a graph meet each label, for all reaches.
///
/// A walker of mean free path ρ, in links, is screened by λ = 1/ρ². The equations are solved for eight ρ; between them
/// the logit ln(p/(1 − p)) is linear in ln ρ, which is exact for a region behind an edge: it holds W/(W + λA), with W the
/// conductance into it and A its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkerField {
    labels: usize,
    nodes: usize,
    /// By rung, label and node; empty for a rung that is not solved.
    logits: Vec<Vec<Vec<i16>>>,
}

/// The outcomes at one reach.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'a> {
    field: &'a WalkerField,
    /// The rung below, and how far the reach is from there to the next, in [0, 1].
    rung: usize,
    share: f32,
    /// Below this logit no label can win: its probability is less than 1/(labels + 1), and thus the least of all. A little less, for rounding.
    least_winning_logit: f32,
}

impl WalkerField {
    /// Solves for the labels of some nodes: (node, label) each, with labels below `labels`. Of a node that appears
    /// several times the first counts; nodes that do not exist are ignored.
    ///
    /// # Errors
    /// No node has a label, there are more than [`MAX_LABELS`], or `progress` was cancelled.
    pub fn solve(
        graph: &Graph,
        seeds: &[(u32, u8)],
        labels: usize,
        progress: &dyn Progress,
    ) -> Result<Self, SpreadError> {
        Self::solve_rungs(graph, (seeds, labels), 0..RUNGS, progress)
    }

    /// The same for one reach only, with the same bits: a quarter of the work.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_at_reach(
        graph: &Graph,
        seeds: &[(u32, u8)],
        labels: usize,
        reach: f64,
        progress: &dyn Progress,
    ) -> Result<Self, SpreadError> {
        let (rung, _) = rung_below(reach);
        Self::solve_rungs(graph, (seeds, labels), rung..rung + 2, progress)
    }

    /// Solves for some of the reaches; each on its own, so that its bits do not depend on the others.
    fn solve_rungs(
        graph: &Graph,
        (seeds, labels): (&[(u32, u8)], usize),
        rungs: Range<usize>,
        progress: &dyn Progress,
    ) -> Result<Self, SpreadError> {
        if labels > MAX_LABELS {
            return Err(SpreadError::TooManyLabels { count: labels });
        }
        let nodes = graph.nodes();
        let mut label_of = vec![FREE; nodes];
        for &(node, label) in seeds.iter().rev().filter(|(_, label)| usize::from(*label) < labels) {
            if let Some(own) = label_of.get_mut(node as usize) {
                *own = label;
            }
        }
        if label_of.iter().all(|label| *label == FREE) {
            return Err(SpreadError::NoSeeds);
        }
        let system = FreeSystem::new(graph, &label_of);
        let rights: Vec<Vec<f64>> =
            (0..labels).map(|label| system.right_side(graph, &label_of, label)).collect();
        let hierarchy = Hierarchy::new(system.graph, system.sinks, progress)?;
        let mut logits = vec![Vec::new(); RUNGS];
        for (step, rung) in rungs.clone().enumerate() {
            let [from, to] = [step, step + 1].map(|step| step as f32 / rungs.len() as f32);
            let stage = Stage::new(progress, from, to);
            let reach = LEAST_REACH * RUNG_FACTOR.powi(rung as i32);
            let screened = Screened::new(&hierarchy, 1.0 / (reach * reach));
            let solve = |(label, right): (usize, &Vec<f64>)| {
                let mut x = vec![0.0; hierarchy.nodes()];
                screened.solve(right, &mut x, &stage)?;
                Ok(logits_of(&label_of, label, &x))
            };
            logits[rung] = rights.par_iter().enumerate().map(solve).collect::<Result<_, SpreadError>>()?;
            stage.report(1.0);
        }
        Ok(Self { labels, nodes, logits })
    }

    /// The number of labels.
    pub fn labels(&self) -> usize {
        self.labels
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Whether the outcomes at a reach are solved for.
    pub fn is_solved_at(&self, reach: f64) -> bool {
        let (rung, _) = rung_below(reach);
        self.logits[rung..rung + 2].iter().all(|logits| logits.len() == self.labels)
    }

    /// The outcomes at a reach, in links, which is clamped to [[`LEAST_REACH`], [`GREATEST_REACH`]]; NaN counts as the
    /// least. Takes no time.
    ///
    /// # Panics
    /// The reach is not solved for ([`Self::is_solved_at`]).
    pub fn at_reach(&self, reach: f64) -> Outcomes<'_> {
        assert!(self.is_solved_at(reach), "only a reach that is solved for has outcomes");
        let (rung, share) = rung_below(reach);
        let least_winning_logit = -(self.labels as f32).ln() - 1e-3;
        Outcomes { field: self, rung, share, least_winning_logit }
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.logits.iter().flatten().map(|logits| size_of_val(&**logits)).sum()
    }
}

impl Outcomes<'_> {
    /// The probability, in [0, 1], that a walker from a node meets this label before any other and before it dies.
    #[inline]
    pub fn probability(&self, node: usize, label: usize) -> f32 {
        1.0 / (1.0 + (-self.logit(node, label)).exp())
    }

    #[inline]
    fn logit(&self, node: usize, label: usize) -> f32 {
        let [low, high] = [0, 1].map(|k| f32::from(self.field.logits[self.rung + k][label][node]));
        (low + (high - low) * self.share) * LOGIT_UNIT
    }

    /// The likeliest outcome at a node: a label, or `None` if dying on the way is as likely as any.
    pub fn winner(&self, node: usize) -> Option<usize> {
        let labels = (0..self.field.labels).map(|label| (label, self.logit(node, label)));
        let (winner, greatest) = labels.reduce(|best, other| if other.1 > best.1 { other } else { best })?;
        // Above one half it needs no exponentials, nor below the share that each outcome has if all are equal.
        if greatest > 0.0 {
            return Some(winner);
        }
        if greatest < self.least_winning_logit {
            return None;
        }
        let p = self.probability(node, winner);
        if p * (self.field.labels as f32 + 1.0) <= 1.0 {
            return None;
        }
        let all: f32 = (0..self.field.labels).map(|label| self.probability(node, label)).sum();
        (p > 1.0 - all).then_some(winner)
    }

    /// Writes the weight of each label into `weights`, of which there is one for each label, and returns that of none:
    /// all are in [0, 1] and sum to 1. With softness 0 the likeliest outcome has all the weight; with 1 the weights are
    /// the probabilities; between, they go as p^(1/softness).
    pub fn weights(&self, node: usize, softness: f32, weights: &mut [f32]) -> f32 {
        if softness.is_nan() || softness <= 0.0 {
            let winner = self.winner(node);
            for (label, weight) in weights.iter_mut().enumerate() {
                *weight = if Some(label) == winner { 1.0 } else { 0.0 };
            }
            return if winner.is_none() { 1.0 } else { 0.0 };
        }
        let mut none = 1.0f32;
        for (label, weight) in weights.iter_mut().enumerate() {
            *weight = self.probability(node, label);
            none -= *weight;
        }
        none = none.max(0.0);
        let greatest = weights.iter().copied().fold(none, f32::max);
        let power = 1.0 / softness.min(1.0);
        // Of the two that powers leave as they are, each node has one at least.
        let sharpen =
            |p: f32| if p == greatest || p == 0.0 { p / greatest } else { (p / greatest).powf(power) };
        weights.iter_mut().for_each(|weight| *weight = sharpen(*weight));
        let none = sharpen(none);
        let sum = none + weights.iter().sum::<f32>();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        none / sum
    }
}

/// The rung at or below a reach, not the last, and how far the reach is from there to the next, in [0, 1].
fn rung_below(reach: f64) -> (usize, f32) {
    let reach = if reach > LEAST_REACH { reach.min(GREATEST_REACH) } else { LEAST_REACH };
    let position = (reach / LEAST_REACH).ln() / RUNG_FACTOR.ln();
    let rung = (position as usize).min(RUNGS - 2);
    (rung, (position - rung as f64).clamp(0.0, 1.0) as f32)
}

/// The label of a node that has none.
const FREE: u8 = u8::MAX;

/// The equations of the nodes without a label.
struct FreeSystem {
    graph: Graph,
    sinks: Vec<f64>,
    /// By unknown: its node.
    nodes: Vec<u32>,
}

impl FreeSystem {
    fn new(graph: &Graph, label_of: &[u8]) -> Self {
        let is_free = |node: usize| label_of[node] == FREE;
        let nodes: Vec<u32> =
            (0..graph.nodes()).filter(|node| is_free(*node)).map(|node| node as u32).collect();
        let mut number = vec![0u32; graph.nodes()];
        for (unknown, node) in nodes.iter().enumerate() {
            number[*node as usize] = unknown as u32;
        }
        let (mut starts, mut rows, mut sinks) = (vec![0u32], Vec::new(), Vec::with_capacity(nodes.len()));
        for node in &nodes {
            let mut sink = 0.0;
            for (neighbour, conductance) in graph.neighbours_of(*node as usize) {
                if is_free(neighbour) {
                    rows.push((number[neighbour], conductance));
                } else {
                    sink += f64::from(conductance);
                }
            }
            sinks.push(sink);
            starts.push(rows.len() as u32);
        }
        Self { graph: Graph::from_rows(&starts, &mut rows), sinks, nodes }
    }

    /// What flows into the unknowns from the nodes of a label, which have the value 1.
    fn right_side(&self, graph: &Graph, label_of: &[u8], label: usize) -> Vec<f64> {
        let inflow = |node: &u32| {
            let of_label = graph.neighbours_of(*node as usize);
            let of_label = of_label.filter(|(neighbour, _)| usize::from(label_of[*neighbour]) == label);
            of_label.map(|(_, conductance)| f64::from(conductance)).sum()
        };
        self.nodes.iter().map(inflow).collect()
    }
}

/// The logits of a label at all nodes, from the solution at those without a label.
fn logits_of(label_of: &[u8], label: usize, solution: &[f64]) -> Vec<i16> {
    let to_stored =
        |logit: f64| (logit.clamp(-GREATEST_LOGIT, GREATEST_LOGIT) as f32 / LOGIT_UNIT).round() as i16;
    let mut unknowns = solution.iter();
    let at = |own: &u8| match *own {
        FREE => {
            // A solution may leave [0, 1] by its tolerance.
            let p = unknowns.next().copied().unwrap_or(0.0).clamp(0.0, 1.0);
            to_stored(p.ln() - (1.0 - p).ln())
        }
        own => to_stored(if usize::from(own) == label { GREATEST_LOGIT } else { -GREATEST_LOGIT }),
    };
    label_of.iter().map(at).collect()
}
