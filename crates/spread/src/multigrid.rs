//! Solves screened Laplace equations on a graph: conjugate gradients, preconditioned by a K-cycle of multigrid.
//!
//! ```text
//! (L + diag(s + λ m)) x = b,    (L x)ᵢ = Σⱼ wᵢⱼ (xᵢ − xⱼ)
//! ```
//!
//! | symbol | meaning | range |
//! | --- | --- | --- |
//! | w | conductances of the links | > 0 |
//! | s | conductance from a node to nodes of a fixed value | ≥ 0 |
//! | λ m | screening times the number of nodes that a node stands for | > 0 |
//!
//! With λ > 0 the matrix is positive definite whatever the graph: islands, single nodes and graphs without fixed nodes
//! need no special case. Coarse levels are joined pairs of pairs (`aggregation`); the cycle is that of Notay, "An
//! aggregation-based algebraic multigrid method" (ETNA 37, 2010), with Gauss–Seidel sweeps. Each solve is sequential, so
//! that its bits do not depend on threads; several are made at once.

mod aggregation;
mod cycle;
mod level;

use crate::Graph;
use aggregation::{NO_AGGREGATE, aggregate};
use level::Level;
use progress::{Cancelled, Progress};

/// All levels of a graph, the finest first.
pub(crate) struct Hierarchy {
    levels: Vec<Level>,
}

/// The coarsest level has at most this many nodes and is solved directly.
const DIRECT_NODES: usize = 48;

/// A level that keeps more than this share of its nodes is not worth its cycle: the coarsest is then swept.
const WORTHWHILE_SHARE: f64 = 0.9;

/// A hierarchy has at most this many levels; each has less than half the nodes of the one before.
const MAX_LEVELS: usize = 40;

impl Hierarchy {
    /// The levels of a graph whose nodes have these conductances to fixed nodes.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn new(graph: Graph, sinks: Vec<f64>, progress: &dyn Progress) -> Result<Self, Cancelled> {
        let masses = vec![1.0; graph.nodes()];
        let mut levels = vec![Level { graph, sinks, masses, aggregates: Vec::new() }];
        while levels.len() < MAX_LEVELS {
            progress.check()?;
            let Some(finest) = levels.last_mut() else { break };
            if finest.graph.nodes() <= DIRECT_NODES {
                break;
            }
            let (aggregates, coarser) = aggregate(finest);
            if coarser.graph.nodes() as f64 > WORTHWHILE_SHARE * finest.graph.nodes() as f64 {
                break;
            }
            finest.aggregates = aggregates;
            levels.push(coarser);
        }
        Ok(Self { levels })
    }

    /// The number of unknowns.
    pub fn nodes(&self) -> usize {
        self.levels[0].graph.nodes()
    }
}

/// A hierarchy with one screening λ > 0.
pub(crate) struct Screened<'a> {
    levels: Vec<ScreenedLevel<'a>>,
    /// The rows of L of the coarsest level's Cholesky decomposition; `None` if that level is swept.
    triangle: Option<Vec<Vec<f64>>>,
}

struct ScreenedLevel<'a> {
    level: &'a Level,
    /// Sum of conductances, sink and screening, by node.
    diagonal: Vec<f64>,
}

/// The largest error of a solution, as its preconditioned residual estimates it.
pub(crate) const TOLERANCE: f64 = 2e-5;

/// More iterations than any graph has needed (about 12).
const MAX_ITERATIONS: usize = 100;

impl<'a> Screened<'a> {
    /// The equations with screening `screening`, > 0.
    pub fn new(hierarchy: &'a Hierarchy, screening: f64) -> Self {
        let levels: Vec<_> =
            hierarchy.levels.iter().map(|level| ScreenedLevel::new(level, screening)).collect();
        let coarsest = &levels[levels.len() - 1];
        let triangle = (coarsest.nodes() <= DIRECT_NODES).then(|| coarsest.decompose());
        Self { levels, triangle }
    }

    /// Solves for x, beginning with the values in it. The result has an error of at most about [`TOLERANCE`].
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn solve(&self, right: &[f64], x: &mut [f64], progress: &dyn Progress) -> Result<(), Cancelled> {
        let fine = &self.levels[0];
        let mut residual = fine.residual(right, x);
        let mut direction: Vec<f64> = Vec::new();
        let mut image: Vec<f64> = Vec::new();
        let mut curvature = 0.0;
        for _ in 0..MAX_ITERATIONS {
            progress.check()?;
            let correction = self.precondition(0, &residual);
            if correction.iter().all(|c| c.abs() <= TOLERANCE) {
                x.iter_mut().zip(&correction).for_each(|(x, c)| *x += c);
                return Ok(());
            }
            // Flexible: the cycle is not a fixed matrix, so that the direction is made orthogonal explicitly.
            let share = if curvature > 0.0 { dot(&correction, &image) / curvature } else { 0.0 };
            direction = if direction.is_empty() {
                correction
            } else {
                correction.iter().zip(&direction).map(|(c, d)| c - share * d).collect()
            };
            image = fine.apply(&direction);
            curvature = dot(&direction, &image);
            if curvature.is_nan() || curvature <= 0.0 {
                return Ok(());
            }
            let step = dot(&direction, &residual) / curvature;
            for i in 0..x.len() {
                x[i] += step * direction[i];
                residual[i] -= step * image[i];
            }
        }
        Ok(())
    }
}

impl<'a> ScreenedLevel<'a> {
    fn new(level: &'a Level, screening: f64) -> Self {
        let diagonal = (0..level.graph.nodes()).map(|node| {
            let links: f64 = level.graph.neighbours_of(node).map(|(_, w)| f64::from(w)).sum();
            links + level.sinks[node] + screening * level.masses[node]
        });
        Self { level, diagonal: diagonal.collect() }
    }

    fn nodes(&self) -> usize {
        self.diagonal.len()
    }

    /// The Cholesky triangle of the whole matrix.
    fn decompose(&self) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.nodes()]; self.nodes()];
        for (node, row) in rows.iter_mut().enumerate() {
            row[node] = self.diagonal[node];
            for (neighbour, w) in self.level.graph.neighbours_of(node) {
                row[neighbour] = -f64::from(w);
            }
        }
        numerics::decompose_positive(&mut rows);
        rows
    }

    /// Σⱼ wᵢⱼ xⱼ.
    #[inline]
    fn inflow(&self, node: usize, x: &[f64]) -> f64 {
        self.level.graph.neighbours_of(node).map(|(neighbour, w)| f64::from(w) * x[neighbour]).sum()
    }

    /// A x.
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        (0..self.nodes()).map(|node| self.diagonal[node] * x[node] - self.inflow(node, x)).collect()
    }

    /// b − A x.
    fn residual(&self, right: &[f64], x: &[f64]) -> Vec<f64> {
        let at = |node: usize| right[node] - (self.diagonal[node] * x[node] - self.inflow(node, x));
        (0..self.nodes()).map(at).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use progress::Unwatched;

    /// A grid of `side` × `side` nodes, every seventh column behind weak links.
    fn grid(side: usize) -> Graph {
        let node = |x: usize, y: usize| (y * side + x) as u32;
        let mut links = Vec::new();
        for y in 0..side {
            for x in 0..side {
                let weak = if x % 7 == 6 { 1e-4 } else { 1.0 };
                if x + 1 < side {
                    links.push((node(x, y), node(x + 1, y), weak));
                }
                if y + 1 < side {
                    links.push((node(x, y), node(x, y + 1), 1.0));
                }
            }
        }
        Graph::new(side * side, &links)
    }

    #[test]
    fn solutions_fulfil_the_equations() {
        let graph = grid(60);
        let nodes = graph.nodes();
        let mut sinks = vec![0.0; nodes];
        (sinks[0], sinks[nodes - 1]) = (1.0, 3.0);
        let mut right = vec![0.0; nodes];
        right[0] = 1.0;
        let hierarchy = Hierarchy::new(graph, sinks, &Unwatched).unwrap();
        assert!(hierarchy.levels.len() > 3, "{}", hierarchy.levels.len());
        for screening in [0.25, 1e-3, 1e-9] {
            let screened = Screened::new(&hierarchy, screening);
            let mut x = vec![0.0; nodes];
            screened.solve(&right, &mut x, &Unwatched).unwrap();
            let residual = screened.levels[0].residual(&right, &x);
            assert!(residual.iter().all(|r| r.abs() < 1e-4), "{screening}");
            assert!(x.iter().all(|x| (-1e-4..=1.0001).contains(x)), "{screening}");
            // A control: another right side is not solved by it.
            right[5] = 1.0;
            assert!(screened.levels[0].residual(&right, &x).iter().any(|r| r.abs() > 0.5));
            right[5] = 0.0;
        }
    }

    #[test]
    fn nodes_without_links_are_solved_too() {
        let graph = Graph::new(200, &[(0, 1, 1.0)]);
        let hierarchy = Hierarchy::new(graph, vec![1.0; 200], &Unwatched).unwrap();
        let mut x = vec![0.0; 200];
        Screened::new(&hierarchy, 1.0).solve(&[1.0; 200], &mut x, &Unwatched).unwrap();
        assert!(x.iter().all(|x| (x - 0.5).abs() < 1e-4));
    }
}
