//! Edges of depth put where the picture has them.
//!
//! Pixels that show only what is on the other side of their jump belong there, by their colour (`matte`). Where there are other views, they
//! have a say: one that goes on being what it is where its own depth puts it, rather than where the other side's does, stays.

use crate::cells::Links;
use crate::covers::MattedLayer;
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::jumps;
use crate::look::{ColorStats, squared_distance};
use crate::matte::{self, MixedPixel};
use crate::other_view::OtherView;
use crate::other_views::{FrontLayer, TexelQuery};
use progress::Progress;

/// Edges of depth are off the picture's by so many pixels at most.
const ROUNDS: usize = 2;
/// Views that are asked at most: those farthest from each other in their order.
const MAX_VIEWS: usize = 8;

/// A pixel stays if views are so many times as far off, squared, where the other side is.
const MIN_ERROR_RATIO: f32 = 4.0;

/// Puts edges of depth where the picture and the views have them, in so many rounds at most. Tells by cell which look like the other side of
/// their jump and stay, and what hangs together then.
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

/// By pixel, whether views show it where it is rather than where it would be `across` its jump.
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
