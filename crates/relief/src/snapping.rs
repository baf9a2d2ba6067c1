//! Alignment of edges of depth with those of the picture.
//!
//! Pixels whose colour is only that of the other side of their jump belong there (`matte`). Other views can veto: a pixel that keeps its
//! colour where its own depth puts it, rather than where the other side's depth would, stays.

use crate::color_stats::{ColorStats, squared_distance};
use crate::edges::covers::MattedLayer;
use crate::edges::jumps;
use crate::edges::matte::{self, MixedPixel};
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::mesh::cells::Links;
use crate::other_view::OtherView;
use crate::resampling::{FrontLayer, TexelQuery};
use progress::Progress;

/// The most pixels by which edges of depth differ from the picture's.
const ROUNDS: usize = 2;
/// The most views that are compared: the farthest from each other in their order.
const MAX_VIEWS: usize = 8;

/// A pixel stays if the squared error of views is so many times as large at the other side's depth.
const MIN_ERROR_RATIO: f32 = 4.0;

/// Moves edges of depth to where the picture and the views have them, in rounds. Returns by cell which pixels look like the other side of
/// their jump and stay, and the resulting connections.
pub(crate) fn snap_edges<E: Send>(
    frame: &Frame,
    disparity: &mut [f32],
    shown: &[[f32; 3]],
    views: &[OtherView<'_, E>],
    jump: f32,
    progress: &dyn Progress,
) -> Result<(Vec<bool>, Links), ReliefError<E>> {
    let grid = frame.grid;
    let mut links = jumps::links(grid, disparity, jump);
    let mut stays = vec![false; grid.count()];
    for _ in 0..ROUNDS {
        let misplaced = matte::find_misplaced(grid, disparity, &links, shown, jump);
        let misplaced: Vec<MixedPixel> = misplaced.into_iter().filter(|pixel| !stays[pixel.cell]).collect();
        let across = matte::disparity_across(grid, disparity, &links, &misplaced, jump);
        let contradicted =
            find_contradicted(frame, [disparity, &across], shown, &misplaced, views, jump, progress)?;
        for (pixel, is_contradicted) in misplaced.iter().zip(&contradicted) {
            match is_contradicted {
                true => stays[pixel.cell] = true,
                false => disparity[pixel.cell] = across[pixel.cell],
            }
        }
        if contradicted.iter().all(|is_contradicted| *is_contradicted) {
            break;
        }
        links = jumps::links(grid, disparity, jump);
    }
    Ok((stays, links))
}

/// By pixel, whether views show it where it is rather than `across` its jump.
fn find_contradicted<E: Send>(
    frame: &Frame,
    [here, across]: [&[f32]; 2],
    shown: &[[f32; 3]],
    misplaced: &[MixedPixel],
    views: &[OtherView<'_, E>],
    jump: f32,
    progress: &dyn Progress,
) -> Result<Vec<bool>, ReliefError<E>> {
    let queries_at = |disparity: &[f32]| -> Vec<TexelQuery> {
        let query = |pixel: &MixedPixel| TexelQuery { cell: pixel.cell, disparity: disparity[pixel.cell] };
        misplaced.iter().map(query).collect()
    };
    let queries = [queries_at(here), queries_at(across)].concat();
    let views: Vec<&OtherView<'_, E>> =
        views.iter().step_by(views.len().div_ceil(MAX_VIEWS).max(1)).collect();
    let opacity = vec![1.0; here.len()];
    let color_stats = {
        let layer = MattedLayer { disparity: here, opacity: &opacity, colors: shown };
        FrontLayer { frame, front: here, jump }.collect_color_stats(&queries, layer, &views, progress)?
    };
    let is_contradicted = |(number, pixel): (usize, &MixedPixel)| {
        let error = |observed: Option<ColorStats>| {
            observed.map(|stats| stats.variance + squared_distance(stats.color, shown[pixel.cell]))
        };
        let (here, there) = (error(color_stats[number]), error(color_stats[misplaced.len() + number]));
        here.zip(there).is_some_and(|(here, there)| there >= MIN_ERROR_RATIO * here)
    };
    Ok(misplaced.iter().enumerate().map(is_contradicted).collect())
}
