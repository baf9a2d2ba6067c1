//! The pixels of the view that a change of the focus map may recolour.

use super::{OrbitCamera, Stale};
use atlas::TexelMap;
use scene::Scene;
use std::ops::Range;

/// How far from the centre of a texel its value has an effect, in texels: values are interpolated, and charts
/// extend by a texel.
const REACH_TEXELS: f64 = 2.0;

/// The pixels of a view of `size` px that show these rectangles of the atlas (columns and rows), with a margin.
pub fn changed_pixels(
    scene: &Scene,
    texels: &TexelMap,
    rectangles: &[[Range<u32>; 2]],
    camera: &OrbitCamera,
    size: [u32; 2],
) -> Stale {
    let [width, height] = size.map(f64::from);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for [columns, rows] in rectangles {
        let wider =
            |range: &Range<u32>, count: u32| range.start.saturating_sub(1)..(range.end + 1).min(count);
        let columns = wider(columns, texels.width);
        for row in wider(rows, texels.height) {
            let first = row as usize * texels.width as usize;
            let row_texels = &texels.index[first + columns.start as usize..first + columns.end as usize];
            for &index in row_texels {
                let Some(texel) = texels.texels.get(index as usize) else { continue };
                let position = texel.centroid.position(scene);
                // A texel beside the eye may cover much of the view.
                let Some(at) = camera.project(position, width / height) else { return Stale::AllColors };
                let reach = REACH_TEXELS * texel.area.sqrt() * camera.pixels_per_unit(position, height);
                let at = [(at.x + 1.0) / 2.0 * width, (1.0 - at.y) / 2.0 * height];
                for axis in [0, 1] {
                    low[axis] = low[axis].min(at[axis] - reach);
                    high[axis] = high[axis].max(at[axis] + reach);
                }
            }
        }
    }
    // Casts saturate: positions outside the view are clamped.
    let range = |axis: usize| {
        let start = (low[axis].floor() as u32).min(size[axis]);
        start..(high[axis].ceil() as u32).min(size[axis]).max(start)
    };
    let ranges = [range(0), range(1)];
    if ranges.iter().any(Range::is_empty) { Stale::Nothing } else { Stale::Colors(ranges) }
}
