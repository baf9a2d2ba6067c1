//! How what the picture shows changes over the aperture: gloss that moves from view to view.
//!
//! By blocks of pixels: what other views show of a block, less what the picture does (`sightings`), is told by a polynomial of where in the
//! aperture they were taken (`polynomial`), of the degree by which views that are left out are told best. Where that does not tell them much
//! better than the picture alone, there is none: noise, and what a texture that is a little off explains, are no gloss.

mod polynomial;
mod sightings;

use crate::cells::Grid;
use crate::error::ReliefError;
use crate::look::noise_variance;
use crate::other_view::OtherView;
use crate::other_views::FrontLayer;
use polynomial::{DEGREES, Regression};
use progress::Progress;
use rayon::prelude::*;
use sightings::Observations;

/// Gloss of a picture, as polynomials by blocks of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Gloss {
    /// Pixels that a block is wide and high.
    pub block: usize,
    /// Columns and rows of blocks; the first begins in the picture's upper left corner.
    pub blocks: [usize; 2],
    /// How far views reach from the middle one to the right and downward, steps; ≥ 0.
    pub reach: [f32; 2],
    /// By block, row by row, which of the polynomials it has; [`Gloss::NONE`] where it sends the same through all of the aperture.
    pub numbers: Vec<u32>,
    /// Linear RGB to be added to what the picture shows: coefficients of the polynomial of x and y, the place in the aperture in units of
    /// `reach` to the right and downward, by x, y, x², xy, y², x³ … y⁴.
    pub polynomials: Vec<[[f32; 3]; GLOSS_TERMS]>,
}

/// Terms of polynomials of the fourth degree that is 0 in the middle.
pub const GLOSS_TERMS: usize = polynomial::TERMS - 1;

/// A higher degree is taken if what is left out is told better by this factor of the squared error.
const DEGREE_IMPROVEMENT: f32 = 0.9;
/// Gloss is believed where the squared error of what is left out is at most this share of what it is without.
const MAX_ERROR_SHARE: f32 = 0.6;
/// So far off, px, textures may be in views: disparities and resampling do no better.
const TEXTURE_ERROR_PX: f32 = 0.3;

impl Gloss {
    /// Of a block without.
    pub const NONE: u32 = u32::MAX;
}

/// The gloss of the cells of the first layer that are `whole`: there in the picture, and not in part. None where no block has any.
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
    let sightings = Observations::collect(layer, shown, whole, views, progress)?;
    let place = |view: &OtherView<'_, E>| {
        [0, 1].map(|axis| if reach[axis] > 0.0 { view.offset[axis] / reach[axis] } else { 0.0 })
    };
    let places: Vec<[f32; 2]> = views.iter().map(place).collect();
    let regression = Regression::new(&places);
    let of_block =
        |block: usize| regression.errors(&sightings.of_block(block), noise_floor(&sightings, block));
    let errors: Vec<Option<[f32; DEGREES]>> =
        (0..sightings.blocks.count()).into_par_iter().map(of_block).collect();
    progress.check().map_err(ReliefError::Cancelled)?;
    let degrees: Vec<usize> = (0..sightings.blocks.count())
        .into_par_iter()
        .map(|block| select_degree(&sightings, &errors, block))
        .collect();
    let glossy: Vec<usize> = (0..degrees.len()).filter(|&block| degrees[block] > 0).collect();
    let mut numbers = vec![Gloss::NONE; degrees.len()];
    glossy.iter().enumerate().for_each(|(number, &block)| numbers[block] = number as u32);
    let polynomials = glossy
        .par_iter()
        .map(|&block| regression.fit_coefficients(&sightings.of_block(block), degrees[block]))
        .collect();
    let Grid { width, height } = sightings.blocks;
    let gloss = Gloss { block: sightings.side, blocks: [width, height], reach, numbers, polynomials };
    Ok((!gloss.polynomials.is_empty()).then_some(gloss))
}

/// What squared error is no gloss: that of noise, and of a texture that is off.
fn noise_floor(sightings: &Observations, block: usize) -> f32 {
    noise_variance(sightings.picture[block]) + TEXTURE_ERROR_PX * TEXTURE_ERROR_PX * sightings.steepest[block]
}

/// The degree that tells a block and those around it; 0 for none.
fn select_degree(sightings: &Observations, errors: &[Option<[f32; DEGREES]>], block: usize) -> usize {
    let Some(own) = errors[block] else { return 0 };
    let Grid { width, height } = sightings.blocks;
    let (x, y) = (block % width, block / width);
    let (mut sums, mut doubts) = ([0.0; DEGREES], 0.0);
    for y in y.saturating_sub(1)..(y + 2).min(height) {
        for x in x.saturating_sub(1)..(x + 2).min(width) {
            let other = y * width + x;
            if let Some(errors) = errors[other] {
                (0..DEGREES).for_each(|degree| sums[degree] += errors[degree]);
                doubts += noise_floor(sightings, other);
            }
        }
    }
    let best = (1..DEGREES)
        .fold(0, |best, degree| if sums[degree] < DEGREE_IMPROVEMENT * sums[best] { degree } else { best });
    let is_believed =
        sums[best] <= MAX_ERROR_SHARE * sums[0] && sums[0] - sums[best] > doubts && own[best] < own[0];
    if is_believed { best } else { 0 }
}
