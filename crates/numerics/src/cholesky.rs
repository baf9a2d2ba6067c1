//! Symmetric positive definite systems, as normal equations are: A = L Lᵀ with L a lower triangle (Golub and Van Loan,
//! *Matrix Computations*, 4.2).
//!
//! Matrices are lists of rows (`[[f64; N]; N]`, or slices into one block); only the lower triangle with the diagonal is
//! read or written. Every element is a sum of products in ascending order of the inner index, taken from the element of
//! A as a whole, whatever the number of threads.

use rayon::prelude::*;

/// Rows that a thread takes at once; fewer are computed on the spot.
const ROWS_PER_TASK: usize = 64;

/// Replaces the lower triangle of A by L: lⱼⱼ = √(aⱼⱼ − Σ lⱼₖ²), lᵢⱼ = (aᵢⱼ − Σ lᵢₖ lⱼₖ) / lⱼⱼ, sums over k < j.
///
/// Where A is not positive definite, but for rounding, what follows in L is NaN or infinite; nothing panics. Rows have
/// at least as many elements as there are rows.
///
/// # Panics
/// A row is shorter.
#[inline]
pub fn decompose_positive<R: AsRef<[f64]> + AsMut<[f64]> + Send + Sync>(rows: &mut [R]) {
    for j in 0..rows.len() {
        let (head, below) = rows.split_at_mut(j + 1);
        let pivot_row = head[j].as_mut();
        let square: f64 = pivot_row[..j].iter().map(|x| x * x).sum();
        let pivot = (pivot_row[j] - square).sqrt();
        pivot_row[j] = pivot;
        let pivot_row = &pivot_row[..j];
        let finish_row = |row: &mut R| {
            let row = row.as_mut();
            let sum: f64 = pivot_row.iter().zip(&row[..j]).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - sum) / pivot;
        };
        if below.len() > ROWS_PER_TASK {
            below.par_iter_mut().with_min_len(ROWS_PER_TASK).for_each(finish_row);
        } else {
            below.iter_mut().for_each(finish_row);
        }
    }
}

/// Solves L x = b in place, for `C` right-hand sides at once: xᵢ = (bᵢ − Σ_{k<i} lᵢₖ xₖ) / lᵢᵢ.
///
/// For a single side see [`as_chunks_mut::<1>`](slice::as_chunks_mut). `right` has as many elements as are to be solved
/// for, at most as many as there are rows.
///
/// # Panics
/// There are fewer rows, or a row is too short.
#[inline]
pub fn forward_substitute<R: AsRef<[f64]>, const C: usize>(triangle: &[R], right: &mut [[f64; C]]) {
    for i in 0..right.len() {
        let row = &triangle[i].as_ref()[..=i];
        let (solved, rest) = right.split_at_mut(i);
        for c in 0..C {
            let sum: f64 = row.iter().zip(&*solved).map(|(l, x)| l * x[c]).sum();
            rest[0][c] = (rest[0][c] - sum) / row[i];
        }
    }
}

/// Solves Lᵀ x = b in place, for `C` right-hand sides at once: xᵢ = (bᵢ − Σ_{i<k<n} lₖᵢ xₖ) / lᵢᵢ, from the last to the
/// first.
///
/// `right` may have fewer elements n than there are rows: then the system is that of the first n rows and columns,
/// whose triangle is the beginning of L.
///
/// # Panics
/// There are fewer rows, or a row is too short.
#[inline]
#[allow(clippy::needless_range_loop, reason = "the column also indexes the rows that are solved already")]
pub fn back_substitute<R: AsRef<[f64]>, const C: usize>(triangle: &[R], right: &mut [[f64; C]]) {
    let count = right.len();
    for i in (0..count).rev() {
        for c in 0..C {
            let sum: f64 = (i + 1..count).map(|k| triangle[k].as_ref()[i] * right[k][c]).sum();
            right[i][c] = (right[i][c] - sum) / triangle[i].as_ref()[i];
        }
    }
}

/// Solves a symmetric positive definite system in place: `right` becomes the solution.
///
/// `matrix` is row by row, n² numbers for n in `right`; its upper triangle is not read, the lower one becomes L. Where
/// the matrix is singular or not positive definite, the solution is not finite; of NaN it is NaN. Large systems are
/// decomposed by all threads, with the same result.
///
/// # Panics
/// `matrix` has not n² numbers.
pub fn solve_positive(matrix: &mut [f64], right: &mut [f64]) {
    let n = right.len();
    assert_eq!(matrix.len(), n * n, "a square matrix");
    if n == 0 {
        return;
    }
    let mut rows: Vec<&mut [f64]> = matrix.chunks_exact_mut(n).collect();
    decompose_positive(&mut rows);
    let (right, _) = right.as_chunks_mut::<1>();
    forward_substitute(&rows, right);
    back_substitute(&rows, right);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix with a known solution, n × n: a Gram matrix and a ridge.
    fn system(n: usize, ridge: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let factor = |i: usize, k: usize| ((i * 7 + k * 13) % 11) as f64 / 11.0 - 0.4;
        let mut matrix = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                matrix[i * n + j] = (0..n).map(|k| factor(i, k) * factor(j, k)).sum();
            }
            matrix[i * n + i] += ridge;
        }
        let expected: Vec<f64> = (0..n).map(|i| (i % 5) as f64 - 2.0).collect();
        let right =
            matrix.chunks_exact(n).map(|row| row.iter().zip(&expected).map(|(a, x)| a * x).sum()).collect();
        (matrix, right, expected)
    }

    #[test]
    fn systems_of_all_sizes_are_solved() {
        for n in [1, 2, 3, 15, 64, 65, 66, 200] {
            let (mut matrix, mut right, expected) = system(n, 1.0);
            solve_positive(&mut matrix, &mut right);
            for (solution, expected) in right.iter().zip(expected) {
                assert!((solution - expected).abs() < 1e-9, "{n}: {solution} {expected}");
            }
        }
        solve_positive(&mut [], &mut []);
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let n = 150;
        let (matrix, _, _) = system(n, 0.1);
        let mut expected = matrix.clone();
        for i in 0..n {
            for j in 0..=i {
                let sum: f64 = (0..j).map(|k| expected[i * n + k] * expected[j * n + k]).sum();
                let rest = expected[i * n + j] - sum;
                expected[i * n + j] = if i == j { rest.sqrt() } else { rest / expected[j * n + j] };
            }
        }
        let mut decomposed = matrix;
        decompose_positive(&mut decomposed.chunks_exact_mut(n).collect::<Vec<_>>());
        assert!(decomposed.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn only_the_lower_triangle_is_read() {
        let mut right = [8.0, 6.0];
        solve_positive(&mut [4.0, f64::NAN, 2.0, 2.0], &mut right);
        assert_eq!(right, [1.0, 2.0]);
    }

    #[test]
    fn an_ill_conditioned_system_is_solved_to_its_condition() {
        // Hilbert's matrix of order 6, condition 1.5e7.
        let n = 6;
        let mut matrix: Vec<f64> = (0..n * n).map(|k| 1.0 / ((k / n + k % n) as f64 + 1.0)).collect();
        let mut right: Vec<f64> = matrix.chunks_exact(n).map(|row| row.iter().sum()).collect();
        solve_positive(&mut matrix, &mut right);
        assert!(right.iter().all(|x| (x - 1.0).abs() < 1e-8), "{right:?}");
    }

    #[test]
    fn what_is_not_positive_definite_has_no_finite_solution() {
        for mut matrix in [[0.0, 0.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 1.0], [1.0, 2.0, 2.0, 1.0], [f64::NAN; 4]] {
            let mut right = [1.0, 1.0];
            solve_positive(&mut matrix, &mut right);
            assert!(right.iter().any(|x| !x.is_finite()), "{right:?}");
        }
    }

    #[test]
    #[should_panic(expected = "a square matrix")]
    fn a_matrix_of_another_size_is_refused() {
        solve_positive(&mut [1.0; 3], &mut [1.0; 2]);
    }

    #[test]
    fn several_sides_and_leading_systems_are_solved_at_once() {
        let mut triangle = [[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [1.0, 0.5, 3.0]];
        decompose_positive(&mut triangle);
        // The first two unknowns alone, by the beginning of the same triangle.
        let mut leading = [[6.0, 4.0], [7.0, 2.0]];
        forward_substitute(&triangle, &mut leading);
        back_substitute(&triangle, &mut leading);
        for (solved, expected) in leading.iter().flatten().zip([1.0, 1.0, 1.0, 0.0]) {
            assert!((solved - expected).abs() < 1e-14, "{leading:?}");
        }
    }
}
