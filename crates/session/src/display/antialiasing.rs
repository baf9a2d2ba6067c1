//! Antialiasing of pictures with one ray a pixel.

use lens::Picture;
use rayon::prelude::*;

/// The weight of either neighbour, along rows and along columns.
///
/// An edge crosses a pixel at u ∈ [0, ½] from its middle: its ray says 1, its area ½ + u. Filtered by [a, 1 − 2a, a] it has 1 − a, and its
/// neighbour beyond the edge a instead of 0. The mean of (½ − a − u)² + a² is least for a = ⅛: 2.0 dB below that without a filter.
const NEIGHBOR: f32 = 0.125;

/// The picture with softer edges, as if the area of each pixel had been seen.
pub(crate) fn antialiased(picture: &Picture) -> Picture {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let value = |index: usize| rgb_and_coverage(picture, index);
    let mix = |before: [f32; 4], own: [f32; 4], after: [f32; 4]| -> [f32; 4] {
        std::array::from_fn(|c| NEIGHBOR * (before[c] + after[c]) + (1.0 - 2.0 * NEIGHBOR) * own[c])
    };
    let row_of = |row: usize| -> Vec<[f32; 4]> {
        let at = |x: usize| value(row * width + x);
        (0..width).map(|x| mix(at(x.saturating_sub(1)), at(x), at((x + 1).min(width - 1)))).collect()
    };
    let rows: Vec<Vec<[f32; 4]>> = (0..height).into_par_iter().map(row_of).collect();
    let values = (0..height).flat_map(|row| {
        let [before, own, after] =
            [row.saturating_sub(1), row, (row + 1).min(height - 1)].map(|row| &rows[row]);
        (0..width).map(move |x| mix(before[x], own[x], after[x]))
    });
    let (radiance, coverage) = values.map(|[r, g, b, coverage]| ([r, g, b], coverage)).unzip();
    Picture { radiance, coverage, ..picture.clone() }
}

/// Radiance and coverage of a pixel.
pub(crate) fn rgb_and_coverage(picture: &Picture, index: usize) -> [f32; 4] {
    let [r, g, b] = picture.radiance[index];
    [r, g, b, picture.coverage[index]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White above a slanted line; by the middle of each pixel, or by its area.
    fn slanted(side: u32, rays: u32) -> Picture {
        let mut picture = Picture::black(side, side);
        let share = |x: u32, y: u32| {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(rays);
            let grid = (0..rays).flat_map(|i| (0..rays).map(move |j| [i, j]));
            let is_above = |[i, j]: &[u32; 2]| f64::from(y) + at(*j) < 7.3 + 0.31 * (f64::from(x) + at(*i));
            grid.filter(is_above).count() as f32 / (rays * rays) as f32
        };
        for y in 0..side {
            for x in 0..side {
                let (share, index) = (share(x, y), (y * side + x) as usize);
                (picture.radiance[index], picture.coverage[index]) = ([share; 3], share);
            }
        }
        picture
    }

    #[test]
    fn edges_are_nearer_to_those_of_areas() {
        let (rays, areas) = (slanted(32, 1), slanted(32, 16));
        let error = |picture: &Picture| -> f64 {
            let square = |(a, b): (&f32, &f32)| f64::from(a - b).powi(2);
            picture.coverage.iter().zip(&areas.coverage).map(square).sum()
        };
        let gain = 10.0 * (error(&rays) / error(&antialiased(&rays))).log10();
        assert!(gain > 1.5, "{gain} dB");
        let flat = Picture { radiance: vec![[0.5; 3]; 6], coverage: vec![1.0; 6], ..Picture::black(3, 2) };
        assert_eq!(antialiased(&flat), flat);
    }
}
