//! The K-cycle: on every coarser level up to two steps of flexible conjugate gradients, preconditioned by the next.

use super::{NO_AGGREGATE, Screened, ScreenedLevel, dot};

/// A second step is made unless the first has reduced the residual to this share (Notay 2010, algorithm 3.2).
const ENOUGH: f64 = 0.25;

/// Sweeps, both ways, of a coarsest level that is too large to be solved directly.
const COARSEST_SWEEPS: usize = 20;

impl Screened<'_> {
    /// An approximation of A⁻¹ b on a level: a sweep, the correction by the coarser levels, and a sweep back.
    pub(super) fn precondition(&self, depth: usize, right: &[f64]) -> Vec<f64> {
        let level = &self.levels[depth];
        let mut x = vec![0.0; level.nodes()];
        if depth + 1 == self.levels.len() {
            self.solve_coarsest(level, right, &mut x);
            return x;
        }
        level.sweep(right, &mut x);
        let residual = level.residual(right, &x);
        let aggregates = &level.level.aggregates;
        let mut coarse_right = vec![0.0; self.levels[depth + 1].nodes()];
        for (node, &aggregate) in aggregates.iter().enumerate().filter(|(_, own)| **own != NO_AGGREGATE) {
            coarse_right[aggregate as usize] += residual[node];
        }
        let correction = self.solve_coarser(depth + 1, coarse_right);
        for (node, &aggregate) in aggregates.iter().enumerate().filter(|(_, own)| **own != NO_AGGREGATE) {
            x[node] += correction[aggregate as usize];
        }
        level.sweep_back(right, &mut x);
        x
    }

    /// Up to two steps of conjugate gradients on a coarser level.
    fn solve_coarser(&self, depth: usize, right: Vec<f64>) -> Vec<f64> {
        let first = self.precondition(depth, &right);
        if depth + 1 == self.levels.len() {
            return first;
        }
        let level = &self.levels[depth];
        let first_image = level.apply(&first);
        let (rho1, alpha1) = (dot(&first, &first_image), dot(&first, &right));
        if rho1.is_nan() || rho1 <= 0.0 {
            return first;
        }
        let step = alpha1 / rho1;
        let residual: Vec<f64> = right.iter().zip(&first_image).map(|(r, v)| r - step * v).collect();
        if dot(&residual, &residual) <= ENOUGH * ENOUGH * dot(&right, &right) {
            return first.into_iter().map(|x| step * x).collect();
        }
        let second = self.precondition(depth, &residual);
        let second_image = level.apply(&second);
        let (gamma, beta) = (dot(&second, &first_image), dot(&second, &second_image));
        let (alpha2, rho2) = (dot(&second, &residual), beta - gamma * gamma / rho1);
        if rho2.is_nan() || rho2 <= 0.0 {
            return first.into_iter().map(|x| step * x).collect();
        }
        let (along_first, along_second) = (step - gamma * alpha2 / (rho1 * rho2), alpha2 / rho2);
        first.iter().zip(&second).map(|(a, b)| along_first * a + along_second * b).collect()
    }

    fn solve_coarsest(&self, level: &ScreenedLevel<'_>, right: &[f64], x: &mut [f64]) {
        if let Some(triangle) = &self.triangle {
            x.copy_from_slice(right);
            let columns = x.as_chunks_mut::<1>().0;
            numerics::forward_substitute(triangle, columns);
            numerics::back_substitute(triangle, columns);
            if x.iter().all(|x| x.is_finite()) {
                return;
            }
            x.fill(0.0);
        }
        for _ in 0..COARSEST_SWEEPS {
            level.sweep(right, x);
            level.sweep_back(right, x);
        }
    }
}

impl ScreenedLevel<'_> {
    /// A Gauss–Seidel sweep, first node first.
    fn sweep(&self, right: &[f64], x: &mut [f64]) {
        (0..self.nodes()).for_each(|node| self.relax(node, right, x));
    }

    /// A Gauss–Seidel sweep, last node first: the transpose of [`Self::sweep`].
    fn sweep_back(&self, right: &[f64], x: &mut [f64]) {
        (0..self.nodes()).rev().for_each(|node| self.relax(node, right, x));
    }

    #[inline]
    fn relax(&self, node: usize, right: &[f64], x: &mut [f64]) {
        x[node] = (right[node] + self.inflow(node, x)) / self.diagonal[node];
    }
}
