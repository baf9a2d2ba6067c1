//! The colours of the hidden layer and of the margin: from other views; where none shows them, from around, marked as
//! invented.

mod fading;

use crate::color_stats::ColorStats;
use crate::edges::matte::{MixedPixel, unmix};
use crate::hidden::HiddenLayer;
use crate::mesh::cells::{Grid, side_index};
use crate::texture::fading::fade;
use rayon::prelude::*;

/// Texels around the second layer that are filled from it, for interpolation.
const RIM: usize = 2;
/// Rounds in which invented colours are smoothed.
const ROUNDS: usize = 32;

/// The colours of both layers.
pub(crate) struct Texture {
    pub colors: [Vec<[f32; 3]>; 2],
    /// By layer and cell, whether some view shows it.
    pub is_observed: Vec<bool>,
    /// By cell, the opacity of the first layer.
    pub opacity: Vec<f32>,
}

/// Completes the picture: `observed_colors` are those of other views by cell, for the margin and for the hidden
/// layer.
pub(crate) fn build_texture(
    grid: Grid,
    mut shown: Vec<[f32; 3]>,
    is_in_picture: impl Fn(usize) -> bool,
    hidden: &HiddenLayer,
    mixed: &[MixedPixel],
    observed_colors: &[Option<ColorStats>],
) -> Texture {
    let mut colors = vec![[f32::NAN; 3]; grid.count()];
    let mut is_observed = [vec![true; grid.count()], vec![false; grid.count()]].concat();
    for cell in (0..grid.count()).filter(|&cell| !is_in_picture(cell)) {
        is_observed[cell] = observed_colors[cell].is_some();
        shown[cell] = observed_colors[cell].map_or(shown[cell], |stats| stats.color);
    }
    for &cell in &hidden.order {
        if let Some(stats) = observed_colors[grid.count() + cell] {
            is_observed[grid.count() + cell] = true;
            colors[cell] = stats.color;
        }
    }
    let mut opacity = vec![1.0; grid.count()];
    for mixed in mixed.iter().filter(|mixed| !hidden.disparity[mixed.cell].is_nan()) {
        let cell = mixed.cell;
        let (share, [before, behind]) = unmix(shown[cell], mixed);
        (opacity[cell], shown[cell], colors[cell]) = (share, before, behind);
        // Most of what the picture shows there is the background.
        is_observed[grid.count() + cell] |= share <= 0.5;
    }
    fade(grid, &mut shown, &is_observed[..grid.count()]);
    invent(grid, &shown, hidden, &mut colors);
    fill_rim(grid, &hidden.order, &mut colors);
    Texture { colors: [shown, colors], is_observed, opacity }
}

/// Fills colours that no view shows, from the farther side inward.
fn invent(grid: Grid, picture: &[[f32; 3]], hidden: &HiddenLayer, colors: &mut [[f32; 3]]) {
    let unseen: Vec<usize> = hidden.order.iter().copied().filter(|&cell| colors[cell][0].is_nan()).collect();
    let around = |colors: &[[f32; 3]], cell: usize| {
        let (mut sum, mut count) = ([0.0; 3], 0.0f32);
        for (side, other) in grid.around(cell) {
            let neighbour =
                if hidden.onward[cell][side_index(side)] { picture[other] } else { colors[other] };
            if !neighbour[0].is_nan() {
                (0..3).for_each(|c| sum[c] += neighbour[c]);
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum.map(|sum| sum / count))
    };
    // Inward, until no cell is left that has a neighbour.
    let mut left = unseen.clone();
    while !left.is_empty() {
        let before = left.len();
        left.retain(|&cell| match around(colors, cell) {
            Some(color) => {
                colors[cell] = color;
                false
            }
            None => true,
        });
        if left.len() == before {
            // No colour around is known: the occluder's is all there is.
            left.drain(..).for_each(|cell| colors[cell] = picture[cell]);
        }
    }
    for _ in 0..ROUNDS {
        let next: Vec<[f32; 3]> =
            unseen.iter().map(|&cell| around(colors, cell).unwrap_or(colors[cell])).collect();
        unseen.iter().zip(next).for_each(|(&cell, next)| colors[cell] = next);
    }
}

/// Gives texels next to the layer the colours of its border, and all others black.
fn fill_rim(grid: Grid, order: &[usize], colors: &mut [[f32; 3]]) {
    let mut border: Vec<usize> = order.to_vec();
    for _ in 0..RIM {
        let mut rim: Vec<(usize, [f32; 3])> = Vec::new();
        for &cell in &border {
            let outside = grid.around(cell).filter(|(_, other)| colors[*other][0].is_nan());
            rim.extend(outside.map(|(_, other)| (other, colors[cell])));
        }
        border = rim.iter().map(|(cell, _)| *cell).collect();
        for (cell, color) in rim {
            colors[cell] = color;
        }
    }
    colors.par_iter_mut().filter(|color| color[0].is_nan()).for_each(|color| *color = [0.0; 3]);
}
