//! Gloss: how the colour of the surface changes over the aperture, from view to view.
//!
//! By blocks of pixels: the difference between other views and the picture (`observations`) is fitted by a polynomial of the position in
//! the aperture (`polynomial`), of the degree with the least cross-validation error. Where that is not much better than the picture
//! alone, there is no gloss: noise and slight misregistration of texture are not taken for it.

mod observations;
mod polynomial;

use crate::color_stats::noise_variance;
use crate::error::ReliefError;
use crate::mesh::cells::Grid;
use crate::other_view::OtherView;
use crate::resampling::FrontLayer;
use observations::Observations;
use polynomial::{DEGREES, Regression};
use progress::Progress;
use rayon::prelude::*;

/// Gloss of a picture, as polynomials by blocks of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Gloss {
    /// Width and height of a block, pixels.
    pub block: usize,
    /// Columns and rows of blocks; the first begins in the picture's upper left corner.
    pub blocks: [usize; 2],
    /// How far views extend from the middle one to the right and downward, steps; ≥ 0.
    pub reach: [f32; 2],
    /// By block, row by row, the index of its polynomial; [`Gloss::NONE`] where it sends the same light through all
    /// of the aperture.
    pub numbers: Vec<u32>,
    /// Linear RGB to be added to the picture: coefficients of the polynomial of x and y, the position in the aperture in units of
    /// `reach` to the right and downward, by x, y, x², xy, y², x³ … y⁴.
    pub polynomials: Vec<[[f32; 3]; GLOSS_TERMS]>,
}

/// Number of terms of a polynomial of the fourth degree that is 0 in the middle.
pub const GLOSS_TERMS: usize = polynomial::TERMS - 1;

/// A higher degree must reduce the squared cross-validation error by this factor.
const DEGREE_IMPROVEMENT: f32 = 0.9;
/// Gloss needs a squared cross-validation error of at most this share of the error without gloss.
const MAX_ERROR_SHARE: f32 = 0.6;
/// Misregistration of texture in views, px: the accuracy of disparities and resampling.
const TEXTURE_ERROR_PX: f32 = 0.3;

impl Gloss {
    /// The index of a block without gloss.
    pub const NONE: u32 = u32::MAX;
}

/// Fits gloss to the cells of the first layer that are `whole`: in the picture, and opaque. `None` where no block has
/// any.
pub(crate) fn fit_gloss<E: Send>(
    layer: &FrontLayer<'_>,
    shown: &[[f32; 3]],
    whole: &[bool],
    views: &[OtherView<'_, E>],
    progress: &dyn Progress,
) -> Result<Option<Gloss>, ReliefError<E>> {
    let reach = [0, 1].map(|axis| views.iter().map(|view| view.offset[axis].abs()).fold(0.0, f32::max));
    if views.is_empty() || reach == [0.0; 2] {
        return Ok(None);
    }
    let observations = Observations::collect(layer, shown, whole, views, progress)?;
    let place = |view: &OtherView<'_, E>| {
        [0, 1].map(|axis| if reach[axis] > 0.0 { view.offset[axis] / reach[axis] } else { 0.0 })
    };
    let places: Vec<[f32; 2]> = views.iter().map(place).collect();
    let regression = Regression::new(&places);
    let of_block =
        |block: usize| regression.errors(&observations.of_block(block), noise_floor(&observations, block));
    let errors: Vec<Option<[f32; DEGREES]>> =
        (0..observations.blocks.count()).into_par_iter().map(of_block).collect();
    progress.check().map_err(ReliefError::Cancelled)?;
    let degrees: Vec<usize> = (0..observations.blocks.count())
        .into_par_iter()
        .map(|block| select_degree(&observations, &errors, block))
        .collect();
    let glossy: Vec<usize> = (0..degrees.len()).filter(|&block| degrees[block] > 0).collect();
    let mut numbers = vec![Gloss::NONE; degrees.len()];
    glossy.iter().enumerate().for_each(|(number, &block)| numbers[block] = number as u32);
    let polynomials = glossy
        .par_iter()
        .map(|&block| regression.fit_coefficients(&observations.of_block(block), degrees[block]))
        .collect();
    let Grid { width, height } = observations.blocks;
    let gloss = Gloss { block: observations.side, blocks: [width, height], reach, numbers, polynomials };
    Ok((!gloss.polynomials.is_empty()).then_some(gloss))
}

/// The squared error that is not gloss: that of noise, and of misregistered texture.
fn noise_floor(observations: &Observations, block: usize) -> f32 {
    noise_variance(observations.picture[block])
        + TEXTURE_ERROR_PX * TEXTURE_ERROR_PX * observations.steepest[block]
}

/// The degree for a block, from its errors and those around it; 0 for none.
fn select_degree(observations: &Observations, errors: &[Option<[f32; DEGREES]>], block: usize) -> usize {
    let Some(own) = errors[block] else { return 0 };
    let Grid { width, height } = observations.blocks;
    let (x, y) = (block % width, block / width);
    let (mut sums, mut doubts) = ([0.0; DEGREES], 0.0);
    for y in y.saturating_sub(1)..(y + 2).min(height) {
        for x in x.saturating_sub(1)..(x + 2).min(width) {
            let other = y * width + x;
            if let Some(errors) = errors[other] {
                (0..DEGREES).for_each(|degree| sums[degree] += errors[degree]);
                doubts += noise_floor(observations, other);
            }
        }
    }
    let best = (1..DEGREES)
        .fold(0, |best, degree| if sums[degree] < DEGREE_IMPROVEMENT * sums[best] { degree } else { best });
    let is_believed =
        sums[best] <= MAX_ERROR_SHARE * sums[0] && sums[0] - sums[best] > doubts && own[best] < own[0];
    if is_believed { best } else { 0 }
}
