//! Edges of depth put where the picture has them.
//!
//! Pixels that show only what is on the other side of their jump belong there, by their colour (`matte`). Where there are other views, they
//! have a say: one that goes on being what it is where its own depth puts it, rather than where the other side's does, stays.

use crate::cells::Links;
use crate::covers::Layer;
use crate::error::ReliefError;
use crate::frame::Frame;
use crate::jumps;
use crate::look::{Look, distance};
use crate::matte::{self, Mixed};
use crate::other_view::OtherView;
use crate::other_views::{Asked, Seen};
use progress::Progress;

/// Edges of depth are off the picture's by so many pixels at most.
const ROUNDS: usize = 2;
/// Views that are asked at most: those farthest from each other in their order.
const ASKED: usize = 8;

/// A pixel stays if views are so many times as far off, squared, where the other side is.
const SURELY: f32 = 4.0;

/// Puts edges of depth where the picture and the views have them, in so many rounds at most. Tells by cell which look like the other side of
/// their jump and stay, and what hangs together then.
pub(crate) fn snap<E: Send>(
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
        let wrong = matte::wrong(grid, disparity, &links, shown, jump);
        let wrong: Vec<Mixed> = wrong.into_iter().filter(|pixel| !stays[pixel.cell]).collect();
        let across = matte::across(grid, disparity, &links, &wrong, jump);
        let contradicted = contradicted(frame, [disparity, &across], shown, &wrong, views, jump, progress)?;
        for (pixel, is_contradicted) in wrong.iter().zip(&contradicted) {
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
fn contradicted<E: Send>(
    frame: &Frame,
    [here, across]: [&[f32]; 2],
    shown: &[[f32; 3]],
    wrong: &[Mixed],
    views: &[OtherView<'_, E>],
    jump: f32,
    progress: &dyn Progress,
) -> Result<Vec<bool>, ReliefError<E>> {
    let asked = |disparity: &[f32]| -> Vec<Asked> {
        let asked = |pixel: &Mixed| Asked { cell: pixel.cell, disparity: disparity[pixel.cell] };
        wrong.iter().map(asked).collect()
    };
    let asked = [asked(here), asked(across)].concat();
    let views: Vec<&OtherView<'_, E>> = views.iter().step_by(views.len().div_ceil(ASKED).max(1)).collect();
    let opacity = vec![1.0; here.len()];
    let looks = {
        let layer = Layer { disparity: here, opacity: &opacity, colors: shown };
        Seen { frame, front: here, jump }.looks(&asked, layer, &views, progress)?
    };
    let is_contradicted = |(number, pixel): (usize, &Mixed)| {
        let off =
            |look: Option<Look>| look.map(|look| look.variance + distance(look.color, shown[pixel.cell]));
        let (here, there) = (off(looks[number]), off(looks[wrong.len() + number]));
        here.zip(there).is_some_and(|(here, there)| there >= SURELY * here)
    };
    Ok(wrong.iter().enumerate().map(is_contradicted).collect())
}
