//! Extrapolation of colours: near the known area those of its border, farther away only their blurred mean.
//!
//! The surroundings of a picture are like its border for a few pixels; farther away only a mean can be predicted, over about the distance.
//! Compared with extending the border, mirroring the picture and a pyramid's smooth filling, this has the least error where the frame of
//! pictures was reduced and the result compared with what was cut off.

use crate::mesh::cells::Grid;
use rayon::prelude::*;

/// The number of box filters that approximate a Gaussian.
const BOXES: usize = 3;

/// Gives cells without a colour that of the nearest cell that has one, blurred by a Gaussian as wide as the distance.
pub(crate) fn fade(grid: Grid, colors: &mut [[f32; 3]], has_color: &[bool]) {
    let distance = extend_colors(grid, colors, has_color);
    let farthest = distance.iter().copied().max().unwrap_or(0) as f32;
    let mut blurred = colors.to_vec();
    let mut sigma = 0.0f32;
    // Blurs of σ = 1, 2, 4 …, each from the last; distances between two of them interpolate both.
    while sigma < farthest {
        let wider = if sigma > 0.0 { 2.0 * sigma } else { 1.0 };
        let narrow = blurred.clone();
        blur(grid, &mut blurred, (wider * wider - sigma * sigma).sqrt());
        let pairs = narrow.par_iter().zip(&blurred);
        colors.par_iter_mut().zip(&distance).zip(pairs).for_each(|((color, far), (narrow, wide))| {
            let share = (*far as f32 - sigma) / (wider - sigma);
            if share > 0.0 && share <= 1.0 {
                *color = std::array::from_fn(|c| narrow[c] + (wide[c] - narrow[c]) * share);
            }
        });
        sigma = wider;
    }
}

/// Extends colours outward from the cells that have one; returns the distance in cells. Without any such cell nothing
/// changes.
fn extend_colors(grid: Grid, colors: &mut [[f32; 3]], has_color: &[bool]) -> Vec<u32> {
    let mut distance: Vec<u32> =
        has_color.iter().map(|has_color| if *has_color { 0 } else { u32::MAX }).collect();
    let mut border: Vec<usize> = (0..grid.count()).filter(|&cell| has_color[cell]).collect();
    while !border.is_empty() {
        let mut next = Vec::new();
        for cell in border {
            for (_, other) in grid.around(cell) {
                if distance[other] != u32::MAX {
                    continue;
                }
                distance[other] = distance[cell] + 1;
                colors[other] = colors[cell];
                next.push(other);
            }
        }
        border = next;
    }
    distance.iter_mut().filter(|far| **far == u32::MAX).for_each(|far| *far = 0);
    distance
}

/// Three box filters along rows and columns: a Gaussian of about this standard deviation.
fn blur(grid: Grid, colors: &mut Vec<[f32; 3]>, sigma: f32) {
    // A box of 2 r + 1 cells has the variance (r² + r) / 3.
    let radius = ((0.25 + sigma * sigma).sqrt() - 0.5).round().max(1.0) as usize;
    for _ in 0..BOXES {
        *colors = boxed(colors, grid.width, radius);
        *colors = boxed(colors, grid.height, radius);
    }
}

/// Means over 2 `radius` + 1 cells along lines of `length`, clamped at their ends; the lines come out as columns.
fn boxed(colors: &[[f32; 3]], length: usize, radius: usize) -> Vec<[f32; 3]> {
    let lines: Vec<Vec<[f32; 3]>> =
        colors.par_chunks(length).map(|line| means(line, radius as isize)).collect();
    let mut turned = vec![[0.0; 3]; colors.len()];
    turned.par_chunks_mut(lines.len()).enumerate().for_each(|(i, column)| {
        column.iter_mut().zip(&lines).for_each(|(mean, line)| *mean = line[i]);
    });
    turned
}

fn means(line: &[[f32; 3]], radius: isize) -> Vec<[f32; 3]> {
    let last = line.len() as isize - 1;
    let at = |i: isize| line[i.clamp(0, last) as usize].map(f64::from);
    let mut sum = [0.0; 3];
    (-radius..=radius).for_each(|i| (0..3).for_each(|c| sum[c] += at(i)[c]));
    let count = (2 * radius + 1) as f64;
    (0..=last)
        .map(|i| {
            let mean = sum.map(|sum| (sum / count) as f32);
            (0..3).for_each(|c| sum[c] += at(i + radius + 1)[c] - at(i - radius)[c]);
            mean
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stripes_go_on_nearby_and_fade_to_their_mean() {
        let grid = Grid { width: 60, height: 40 };
        let has_color: Vec<bool> = (0..grid.count()).map(|cell| cell / 60 < 20).collect();
        let striped: Vec<[f32; 3]> =
            (0..grid.count()).map(|cell| [f32::from(cell / 6 % 2 == 0), 0.3, 0.0]).collect();
        let mut faded = striped.clone();
        fade(grid, &mut faded, &has_color);
        assert_eq!(faded[..20 * 60], striped[..20 * 60]);
        assert!(faded.iter().all(|color| (color[1] - 0.3).abs() < 1e-4));
        let contrast = |y: usize| (15..45).map(|x| (faded[grid.at(x, y)][0] - 0.5).abs()).fold(0.0, f32::max);
        assert!(contrast(20) > 0.45 && contrast(38) < 0.1, "{} {}", contrast(20), contrast(38));
        let mut none = striped.clone();
        fade(grid, &mut none, &vec![false; grid.count()]);
        assert_eq!(none, striped);
    }
}
