//! The roughness of a disparity map.

use crate::mesh::cells::Grid;
use numerics::order_statistic;

/// The share of the pixels that is ignored: edges.
const EDGES: f64 = 0.1;

/// The deviation of disparities from the middle of their neighbours, left and right, above and below: the 90th percentile. Nearly 0 for a
/// rendered map, in which planes are linear; larger for an estimated one, whose noise it measures.
pub fn measure_roughness([width, height]: [usize; 2], disparity: &[f32]) -> f32 {
    let grid = Grid { width, height };
    let deviation_at = |a: usize, middle: usize, b: usize| {
        let deviation = (0.5 * (disparity[a] + disparity[b]) - disparity[middle]).abs();
        (!deviation.is_nan()).then_some(deviation)
    };
    let mut all = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let cell = grid.at(x, y);
            if x > 0 && x + 1 < width {
                all.extend(deviation_at(cell - 1, cell, cell + 1));
            }
            if y > 0 && y + 1 < height {
                all.extend(deviation_at(cell - width, cell, cell + width));
            }
        }
    }
    let rank = ((1.0 - EDGES) * all.len() as f64) as usize;
    order_statistic(&mut all, rank).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_with_an_edge_are_even_and_noise_is_not() {
        let size = [40, 30];
        let at = |k: usize| (k % 40, k / 40);
        let plane = |k: usize| {
            let (x, y) = at(k);
            0.03 * x as f32 - 0.05 * y as f32 + if x > 20 { 2.0 } else { 0.0 }
        };
        let even: Vec<f32> = (0..1200).map(plane).collect();
        assert!(measure_roughness(size, &even) < 1e-5);
        let noisy: Vec<f32> = (0..1200)
            .map(|k| plane(k) + if k.wrapping_mul(2_654_435_761) >> 9 & 1 == 0 { 0.1 } else { 0.0 })
            .collect();
        assert!(measure_roughness(size, &noisy) > 0.04, "{}", measure_roughness(size, &noisy));
        assert_eq!(measure_roughness([1, 1], &[0.5]), 0.0);
    }
}
