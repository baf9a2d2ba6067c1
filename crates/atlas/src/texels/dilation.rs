//! Filling the gutter: texels beside a chart take the value of the nearest covered texel, so that bilinear lookups,
//! mip levels and image editors never mix in a foreign colour at a chart's border.

use rayon::prelude::*;
use std::sync::LazyLock;

/// How far from a chart gutter texels are filled, in texels.
pub const DILATION_RADIUS: u32 = 3;

/// A gutter texel and where its value comes from; both are `y · width + x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dilation {
    /// The gutter texel.
    pub texel: u32,
    /// The nearest covered texel.
    pub source: u32,
}

/// Offsets to the texels within the radius, nearest first.
static STEPS: LazyLock<Vec<(i32, i32)>> = LazyLock::new(|| {
    let r = DILATION_RADIUS as i32;
    let mut steps: Vec<_> = (-r..=r)
        .flat_map(|y| (-r..=r).map(move |x| (x, y)))
        .filter(|&(x, y)| (1..=r * r).contains(&(x * x + y * y)))
        .collect();
    // Ties are broken by row, then column, so that the result is deterministic.
    steps.sort_by_key(|&(x, y)| (x * x + y * y, y, x));
    steps
});

/// Every gutter texel within [`DILATION_RADIUS`] of a covered one, sorted by source, then texel. `covers` returns
/// whether the texel `y · width + x` is covered.
pub(crate) fn dilations(width: u32, height: u32, covers: impl Fn(usize) -> bool + Sync) -> Vec<Dilation> {
    let is_covered = |x: i32, y: i32| {
        let inside = (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
        inside && covers(y as usize * width as usize + x as usize)
    };
    let row = |y: u32| {
        (0..width).filter_map(move |x| {
            let (x, y) = (x as i32, y as i32);
            if is_covered(x, y) {
                return None;
            }
            let &(dx, dy) = STEPS.iter().find(|(dx, dy)| is_covered(x + dx, y + dy))?;
            let source = (y + dy) as u32 * width + (x + dx) as u32;
            Some(Dilation { texel: y as u32 * width + x as u32, source })
        })
    };
    let mut list: Vec<Dilation> = (0..height).into_par_iter().flat_map_iter(row).collect();
    list.par_sort_unstable_by_key(|d| (d.source, d.texel));
    list
}
