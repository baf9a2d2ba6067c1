//! Normal equations, solved.

use rayon::prelude::*;

/// Rows that a thread takes at once: fewer are not worth waking one.
const ROWS: usize = 64;

/// Solves a symmetric positive definite system in place by Cholesky's decomposition: the solution is in `right` afterwards.
///
/// `matrix` is row by row, as many rows as `right` has numbers; it is lost.
pub(crate) fn solve_positive(matrix: &mut [f64], right: &mut [f64]) {
    let n = right.len();
    for j in 0..n {
        let square: f64 = matrix[j * n..j * n + j].iter().map(|x| x * x).sum();
        matrix[j * n + j] -= square;
        let pivot = matrix[j * n + j].sqrt();
        matrix[j * n + j] = pivot;
        let (head, below) = matrix.split_at_mut((j + 1) * n);
        let pivot_row = &head[j * n..j * n + j];
        below.par_chunks_mut(n).with_min_len(ROWS).for_each(|row| {
            let sum: f64 = pivot_row.iter().zip(&row[..j]).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - sum) / pivot;
        });
    }
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| matrix[i * n + k] * right[k]).sum();
        right[i] = (right[i] - sum) / matrix[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| matrix[k * n + i] * right[k]).sum();
        right[i] = (right[i] - sum) / matrix[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved() {
        let matrix = [4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 2.0];
        let expected = [1.0, -2.0, 3.0];
        let mut right: Vec<f64> =
            (0..3).map(|i| (0..3).map(|j| matrix[3 * i + j] * expected[j]).sum()).collect();
        solve_positive(&mut matrix.clone(), &mut right);
        for (solution, expected) in right.iter().zip(expected) {
            assert!((solution - expected).abs() < 1e-12, "{right:?}");
        }
    }
}
