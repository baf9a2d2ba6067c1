//! Which views a point of the reference is hidden from, by the disparities around it.
//!
//! A point (x, d) and another (x′, d′) of the reference lie on one ray of the view at offset b if x′ = x + (d′ − d) b. So the point is
//! occluded there if, walking from x along b, some pixel is nearer by just as much as has been walked: the ray that leaves the point
//! then meets that pixel. Surfaces that the ray passes behind or in front of do not occlude, so that views see past thin objects.

/// Side of a tile, pixels; each stores the largest disparity around it.
const TILE: usize = 8;

/// The disparities of a picture, for occlusion queries.
pub struct OcclusionTest<'a> {
    disparity: &'a [f32],
    width: usize,
    height: usize,
    /// For every tile, the largest disparity that is close enough to occlude anything in it.
    nearest: Vec<f32>,
    tiles_across: usize,
    /// Surfaces that are not nearer than this do not occlude: half a pixel in the farthest view.
    margin: f32,
}

impl<'a> OcclusionTest<'a> {
    /// Prepares the test for a disparity map with rows of `width`, seen by views at these offsets.
    pub fn new(disparity: &'a [f32], width: usize, offsets: &[[f32; 2]]) -> Self {
        let height = disparity.len() / width;
        let reach = offsets.iter().flatten().fold(0.0f32, |reach, o| reach.max(o.abs()));
        let (across, down) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let mut own = vec![f32::MIN; across * down];
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for (index, &d) in disparity.iter().enumerate() {
            let (x, y) = (index % width, index / width);
            let tile = &mut own[y / TILE * across + x / TILE];
            *tile = tile.max(d);
            (low, high) = (low.min(d), high.max(d));
        }
        let around = (((high - low) * reach) as usize + 1).div_ceil(TILE);
        let rows = largest_around(&own, across, down, |x, y| {
            (x.saturating_sub(around)..(x + around + 1).min(across)).map(move |x| (x, y))
        });
        let nearest = largest_around(&rows, across, down, |x, y| {
            (y.saturating_sub(around)..(y + around + 1).min(down)).map(move |y| (x, y))
        });
        Self {
            disparity,
            width,
            height,
            nearest,
            tiles_across: across,
            margin: 0.5 / reach.max(f32::MIN_POSITIVE),
        }
    }

    /// The largest disparity around the pixel in column `x` and row `y` that could occlude it.
    pub fn nearest_occluder(&self, x: usize, y: usize) -> f32 {
        self.nearest[y / TILE * self.tiles_across + x / TILE]
    }

    /// Neighbours that do not occlude the pixel at this disparity, or else the pixel itself: columns to the left and right and the row, rows
    /// above and below and the column.
    pub fn unoccluded_neighbours(
        &self,
        (x, y): (usize, usize),
        disparity: f32,
    ) -> [(usize, usize, usize); 2] {
        let limit = disparity + self.margin;
        // The second neighbour counts, too: an edge is blurred over two pixels.
        let side = |own: usize, last: usize, step: isize, at: &dyn Fn(usize) -> usize| {
            let next = |k: isize| (own as isize + k * step).clamp(0, last as isize) as usize;
            if [1, 2].iter().all(|k| self.disparity[at(next(*k))] <= limit) { next(1) } else { own }
        };
        let in_row = |x: usize| y * self.width + x;
        let in_column = |y: usize| y * self.width + x;
        let (right, bottom) = (self.width - 1, self.height - 1);
        [
            (side(x, right, -1, &in_row), side(x, right, 1, &in_row), y),
            (side(y, bottom, -1, &in_column), side(y, bottom, 1, &in_column), x),
        ]
    }

    /// Whether the pixel, at this disparity, is hidden from the view at `offset`; `nearest` is that of
    /// [`Self::nearest_occluder`].
    pub fn is_occluded(
        &self,
        (x, y): (usize, usize),
        disparity: f32,
        nearest: f32,
        offset: [f32; 2],
    ) -> bool {
        if nearest - disparity <= self.margin {
            return false;
        }
        // One step of the walk is one pixel along the longer side; then the ray has come nearer by `step`.
        let longer = offset[0].abs().max(offset[1].abs());
        let step = 1.0 / longer;
        let steps = ((nearest - disparity) * longer).ceil() as usize;
        for k in 1..=steps {
            let risen = k as f32 * step;
            let column = (x as f32 + risen * offset[0]).round();
            let row = (y as f32 + risen * offset[1]).round();
            if column < 0.0 || row < 0.0 || column >= self.width as f32 || row >= self.height as f32 {
                return false;
            }
            let nearer = self.disparity[row as usize * self.width + column as usize] - disparity;
            // Three quarters of a step to either side: two adjacent pixels leave no gap.
            if nearer > self.margin && (nearer - risen).abs() <= 0.75 * step {
                return true;
            }
        }
        false
    }
}

/// For every tile the largest of those that `around` lists.
fn largest_around<I: Iterator<Item = (usize, usize)>>(
    tiles: &[f32],
    across: usize,
    down: usize,
    around: impl Fn(usize, usize) -> I,
) -> Vec<f32> {
    (0..across * down)
        .map(|tile| {
            around(tile % across, tile / across).map(|(x, y)| tiles[y * across + x]).fold(f32::MIN, f32::max)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_post_occludes_what_is_beside_it_and_views_see_past_it() {
        // A post of four columns, two pixels a step nearer than the wall.
        let (width, height) = (64, 16);
        let disparity: Vec<f32> =
            (0..width * height).map(|i| if (30..34).contains(&(i % width)) { 2.0 } else { 0.0 }).collect();
        let offsets: Vec<[f32; 2]> = (-4..=4).filter(|u| *u != 0).map(|u| [u as f32, 0.0]).collect();
        let occlusion = OcclusionTest::new(&disparity, width, &offsets);
        let hidden =
            |x: usize, u: f32| occlusion.is_occluded((x, 8), 0.0, occlusion.nearest_occluder(x, 8), [u, 0.0]);
        for x in (4..60).filter(|x| !(30..34).contains(x)) {
            for offset in &offsets {
                // In view u the post lies at 30 − 2u … 33 − 2u, and the wall does not move.
                let over = (30.0 - 2.0 * offset[0]..=33.0 - 2.0 * offset[0]).contains(&(x as f32));
                assert_eq!(hidden(x, offset[0]), over, "pixel {x}, view {}", offset[0]);
            }
        }
        // Its edges are not the wall's.
        assert_eq!(occlusion.unoccluded_neighbours((28, 8), 0.0)[0], (27, 28, 8));
        assert_eq!(occlusion.unoccluded_neighbours((28, 8), 2.0), [(27, 29, 8), (7, 9, 28)]);
        // The post itself is hidden from nowhere.
        assert!(offsets.iter().all(|o| !occlusion.is_occluded(
            (31, 8),
            2.0,
            occlusion.nearest_occluder(31, 8),
            *o
        )));
    }
}
