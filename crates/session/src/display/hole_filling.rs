//! Holes in what is seen through one point of the aperture.
//!
//! Where paint makes something sharp, its image does not move with the point that is looked through, while what lies around it does: between
//! them nothing lands (the conserved sum is not covered there). The screen shows such holes filled smoothly from what surrounds them, by
//! averages over ever larger squares (push and pull; Gortler et al. 1996, *The Lumigraph*).

use lens::Picture;

/// A level of averages: light and how much of it was covered, row by row.
struct Level {
    size: [usize; 2],
    /// Light (three channels) and coverage, both already weighted by coverage of at most 1.
    sums: Vec<[f32; 4]>,
}

/// The picture with what is not covered filled from around it. Its coverage is at least 1 wherever there is any light to fill from.
pub fn filled(picture: &Picture) -> Picture {
    let size = [picture.width, picture.height].map(|side| side as usize);
    let weighted = |(radiance, &coverage): (&[f32; 3], &f32)| {
        // Where images overlap, their mean counts once.
        let share = if coverage > 1.0 { 1.0 / coverage } else { 1.0 };
        let [r, g, b] = radiance.map(|value| value * share);
        [r, g, b, coverage.max(0.0) * share]
    };
    let finest = picture.radiance.iter().zip(&picture.coverage).map(weighted).collect();
    if picture.radiance.is_empty() {
        return picture.clone();
    }
    let mut levels = vec![Level { size, sums: finest }];
    while let Some(coarser) = levels.last().and_then(Level::coarser) {
        levels.push(coarser);
    }
    // The coarsest level is one pixel.
    let coarsest = levels.last().map_or([0.0; 3], |level| mean(level.sums[0]));
    let (mut fill, mut fill_size) = (coarsest.to_vec(), [1, 1]);
    for level in levels.iter().rev() {
        fill = level.pulled(&fill, fill_size);
        fill_size = level.size;
    }
    let mut result = picture.clone();
    let is_empty = fill.iter().all(|&value| value == 0.0);
    for (index, coverage) in result.coverage.iter_mut().enumerate().filter(|_| !is_empty) {
        if *coverage < 1.0 {
            let missing = 1.0 - coverage.max(0.0);
            for (channel, value) in result.radiance[index].iter_mut().enumerate() {
                *value += missing * fill[3 * index + channel];
            }
            *coverage = 1.0;
        }
    }
    result
}

/// The mean light of a sum; black where nothing is covered.
fn mean([r, g, b, coverage]: [f32; 4]) -> [f32; 3] {
    if coverage > 0.0 { [r, g, b].map(|value| value / coverage) } else { [0.0; 3] }
}

impl Level {
    /// The means of squares of four; `None` if there is one pixel alone.
    fn coarser(&self) -> Option<Self> {
        let [width, height] = self.size;
        if width <= 1 && height <= 1 {
            return None;
        }
        let size = [width.div_ceil(2), height.div_ceil(2)];
        let mut sums = vec![[0.0; 4]; size[0] * size[1]];
        for (index, own) in self.sums.iter().enumerate() {
            let [x, y] = [index % width / 2, index / width / 2];
            let sum = &mut sums[y * size[0] + x];
            *sum = [0, 1, 2, 3].map(|k| sum[k] + own[k] / 4.0);
        }
        Some(Self { size, sums })
    }

    /// The light of each pixel: its own where it is covered, the rest from `coarser`, enlarged bilinearly.
    fn pulled(&self, coarser: &[f32], coarser_size: [usize; 2]) -> Vec<f32> {
        let [width, height] = self.size;
        let mut light = Vec::with_capacity(3 * width * height);
        for (index, &sum) in self.sums.iter().enumerate() {
            let around = bilinear(coarser, coarser_size, [index % width, index / width]);
            let own = sum[3].clamp(0.0, 1.0);
            let [r, g, b] = mean(sum);
            light.extend(
                [r, g, b]
                    .into_iter()
                    .zip(around)
                    .map(|(own_light, other)| own * own_light + (1.0 - own) * other),
            );
        }
        light
    }
}

/// The light of `coarser` at the pixel `at` of the next finer level.
fn bilinear(coarser: &[f32], [width, height]: [usize; 2], at: [usize; 2]) -> [f32; 3] {
    let place = |at: usize, size: usize| {
        let middle = ((at as f32 + 0.5) / 2.0 - 0.5).clamp(0.0, (size - 1) as f32);
        let low = middle.floor() as usize;
        (low, (low + 1).min(size - 1), middle.fract())
    };
    let ((left, right, u), (top, bottom, v)) = (place(at[0], width), place(at[1], height));
    [0, 1, 2].map(|channel| {
        let value = |x: usize, y: usize| coarser[3 * (y * width + x) + channel];
        let row = |y: usize| value(left, y) + (value(right, y) - value(left, y)) * u;
        row(top) + (row(bottom) - row(top)) * v
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of one colour with a hole of `side` pixels in its middle.
    fn holed(size: [u32; 2], side: u32) -> Picture {
        let mut picture = Picture::black(size[0], size[1]);
        for index in 0..picture.radiance.len() {
            let [x, y] = [index as u32 % size[0], index as u32 / size[0]];
            let is_hole = x.abs_diff(size[0] / 2) < side && y.abs_diff(size[1] / 2) < side;
            if !is_hole {
                (picture.radiance[index], picture.coverage[index]) = ([0.6, 0.3, 0.1], 1.0);
            }
        }
        picture
    }

    #[test]
    fn a_hole_gets_the_colour_around_it_and_nothing_else_changes() {
        for size in [[37, 21], [64, 64], [1, 9], [5, 1]] {
            let picture = holed(size, 4);
            let result = filled(&picture);
            let has_light = picture.coverage.iter().any(|&coverage| coverage > 0.0);
            for (light, coverage) in result.radiance.iter().zip(&result.coverage).filter(|_| has_light) {
                assert!(
                    light.iter().zip([0.6, 0.3, 0.1]).all(|(a, b)| (a - b).abs() < 1e-5),
                    "{size:?}: {light:?}"
                );
                assert_eq!(*coverage, 1.0);
            }
        }
    }

    #[test]
    fn what_overlaps_stays_and_a_black_picture_stays_black() {
        let mut picture = holed([16, 16], 0);
        (picture.radiance[5], picture.coverage[5]) = ([2.0, 2.0, 2.0], 2.5);
        let result = filled(&picture);
        assert_eq!(result, picture, "there is no hole");
        let black = Picture::black(8, 8);
        assert_eq!(filled(&black), black, "nothing to fill from");
        let empty = Picture::black(0, 0);
        assert_eq!(filled(&empty), empty);
    }

    #[test]
    fn the_fill_leads_smoothly_from_one_side_to_the_other() {
        let mut picture = Picture::black(64, 4);
        for y in 0..4 {
            for x in (0..16).chain(48..64) {
                let index = y * 64 + x;
                let light = if x < 32 { 1.0 } else { 0.0 };
                (picture.radiance[index], picture.coverage[index]) = ([light; 3], 1.0);
            }
        }
        let result = filled(&picture);
        let row: Vec<f32> = (0..64).map(|x| result.radiance[2 * 64 + x][1]).collect();
        assert!(row.windows(2).all(|pair| pair[1] <= pair[0] + 1e-5), "{row:?}");
        assert!(row.windows(2).all(|pair| pair[0] - pair[1] < 0.25), "no step: {row:?}");
        assert!((row[32] - 0.5).abs() < 0.2, "{}", row[32]);
    }
}
