//! What does not belong in a photograph: who walked by, a card, a leaf.
//!
//! A photograph is looked at by tiles. A tile is odd where what it shows is neither what all photographs of the same texels show on the
//! whole, as it is where something stands before the surface, nor what photographs from near lead to expect, as it is of a highlight.
//!
//! ```text
//! s = min(|r|/σ, |r − r̂|/σ̂)        b = 1/(1 + (s̄/S)⁸)
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | r | what a sighting shows less the texel's constant part | radiance |
//! | r̂ | the same as the texel's other photographs tell it ([`Work::leave_out`]) | radiance |
//! | σ, σ̂ | the medians of \|r\| and \|r − r̂\| around the texel | radiance |
//! | s̄ | the mean of s over a tile | 1 |
//! | b | how far the tile belongs | 1 |

mod belonging;

pub(crate) use belonging::Belonging;

use super::numbers::median;
use super::places::Blocks;
use super::telling::{Calibrated, Kernel, Known, LEAST_ERROR, Work, robust_mean, toward};
use belonging::Grid;
use glam::DVec2;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// One texel of so many is asked.
const ASKED: usize = 8;
/// Sightings that a tile is judged by at least.
const FEWEST: f32 = 4.0;
/// A texel that fewer photographs see says nothing: none of them can be called odd.
const FEWEST_VIEWS: usize = 5;
/// What others lead to expect: near photographs, much noise.
pub(crate) const KERNEL: Kernel = Kernel { reach: 0.6, noise: 0.5 };
/// S.
const ODD: f32 = 2.6;
/// One sighting says no more than this.
const MOST: f32 = 8.0;
/// Tiles that belong less leave nothing of those beside them, which they reach into.
const GONE: f32 = 0.5;

/// What a sighting says of its tile.
struct Said {
    view: u16,
    weight: f32,
    off_constant: f32,
    off_others: f32,
}

/// How far the places of each view belong.
pub(crate) fn belonging(
    radiance: &Calibrated<'_>,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<Belonging>, Cancelled> {
    let texels = radiance.texels;
    let blocks = Blocks::of(texels.size());
    let said: Vec<(usize, Vec<Said>)> = (0..texels.count())
        .into_par_iter()
        .step_by(ASKED)
        .filter(|&texel| radiance.sightings.range(texel).len() >= FEWEST_VIEWS && !progress.cancelled())
        .map_init(Work::new, |work, texel| (texel, said(radiance, texel, work)))
        .collect();
    progress.check()?;
    let scale = |off: fn(&Said) -> f32| -> Vec<f32> {
        let mut all = vec![Vec::new(); blocks.count()];
        for (texel, said) in &said {
            all[blocks.of_texel(texels, *texel)].extend(said.iter().map(off));
        }
        all.iter_mut().map(|all| median(all, f32::total_cmp).unwrap_or(0.0).max(LEAST_ERROR)).collect()
    };
    let (constants, others) = (scale(|said| said.off_constant), scale(|said| said.off_others));
    let mut sums: Vec<Sums> = views.iter().map(Sums::of).collect();
    for (texel, said) in &said {
        let block = blocks.of_texel(texels, *texel);
        for said in said {
            let number = usize::from(said.view);
            let score = (said.off_constant / constants[block]).min(said.off_others / others[block]).min(MOST);
            // It was projected before, by the same lens.
            let pixel = views[number].project(texels.position(*texel)).unwrap_or_default();
            sums[number].add(pixel, score, said.weight);
        }
    }
    Ok(sums.into_par_iter().map(Sums::belonging).collect())
}

fn said(radiance: &Calibrated<'_>, texel: usize, work: &mut Work) -> Vec<Said> {
    radiance.samples_into(texel, &mut work.samples);
    let constant = robust_mean(&work.samples, &mut Vec::new());
    let sightings = radiance.sightings.of_texel(texel);
    let from = radiance.texels.position(texel);
    work.known.clear();
    for (place, (sample, sighting)) in work.samples.iter().zip(sightings).enumerate() {
        let direction = toward(from, radiance.eye(sighting));
        let residual = sample.light - constant;
        work.known.push(Known { place, direction, residual, weight: sample.counts(constant) });
    }
    work.keep_best();
    work.leave_out(&KERNEL);
    let said = work.known.iter().zip(work.errors()).map(|(known, error)| Said {
        view: sightings[known.place].view,
        weight: known.weight,
        off_constant: known.residual.length(),
        off_others: error.length(),
    });
    said.collect()
}

/// Scores of a view's tiles, summed, and their weights and number.
struct Sums {
    grid: Grid,
    tiles: Vec<[f32; 3]>,
}

impl Sums {
    fn of(view: &View) -> Self {
        let grid = Grid::of(view);
        Self { grid, tiles: vec![[0.0; 3]; grid.columns * grid.rows] }
    }

    fn add(&mut self, pixel: DVec2, score: f32, weight: f32) {
        let Grid { columns, rows, side_px } = self.grid;
        let (column, row) = ((pixel.x / side_px) as usize, (pixel.y / side_px) as usize);
        if column < columns && row < rows {
            let tile = &mut self.tiles[row * columns + column];
            *tile = [tile[0] + score * weight, tile[1] + weight, tile[2] + 1.0];
        }
    }

    fn belonging(self) -> Belonging {
        let of_tile = |&[score, weight, count]: &[f32; 3]| {
            let is_judged = count >= FEWEST && weight > 0.0;
            let belongs = if is_judged { 1.0 / (1.0 + (score / weight / ODD).powi(8)) } else { 1.0 };
            // A thousandth is nothing.
            if belongs > 0.999 { 1.0 } else { belongs }
        };
        let own: Vec<f32> = self.tiles.iter().map(of_tile).collect();
        let Grid { columns, rows, .. } = self.grid;
        let tiles = (0..own.len()).map(|tile| {
            let (x, y) = (tile % columns, tile / columns);
            let around = (y.saturating_sub(1)..(y + 2).min(rows)).flat_map(|row| {
                (x.saturating_sub(1)..(x + 2).min(columns)).map(move |column| row * columns + column)
            });
            let least = around.map(|tile| own[tile]).fold(1.0, f32::min);
            if least < GONE { own[tile].min(least) } else { own[tile] }
        });
        Belonging { grid: self.grid, tiles: tiles.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_tiles_are_gone_with_what_they_reach_into() {
        let sums = |odd: usize| {
            let mut tiles = vec![[8.0, 10.0, 10.0]; 50];
            tiles[odd] = [50.0, 10.0, 10.0];
            Sums { grid: Grid { columns: 10, rows: 5, side_px: 12.0 }, tiles }.belonging()
        };
        let belonging = sums(22);
        let at = |column: f64, row: f64| belonging.at(DVec2::new(column, row) * 12.0 + 6.0);
        assert!(at(2.0, 2.0) < 0.01 && at(3.0, 1.0) < 0.01 && at(1.0, 3.0) < 0.01);
        assert_eq!([at(4.0, 2.0), at(0.0, 2.0), at(9.0, 4.0)], [1.0; 3]);
        assert!(!belonging.is_whole());
        let grid = Grid { columns: 1, rows: 1, side_px: 12.0 };
        let few = Sums { grid, tiles: vec![[50.0, 1.0, 2.0]] };
        assert!(few.belonging().is_whole(), "few say nothing");
    }
}
