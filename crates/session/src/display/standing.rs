//! What a picture through another lens, which stood before, knows better than the draft of a new one: where both look the same in the draft's
//! pixels, what stood is shown itself.

use crate::display::layer::{PictureLayer, share_below};
use lens::Picture;
use rayon::prelude::*;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// A draft takes the place of the picture that stood before where they differ by more than so many times what a pixel of the draft loses in
/// detail, or the least of it.
const CHANGES: RangeInclusive<f32> = 1.0..=2.5;
/// The least, as a share of white: drafts are so far from the means of the pixels that they stand for.
const LEAST_LOSS: f32 = 0.03;

/// A picture that stood before drafts of others.
pub(crate) struct StandingPicture {
    picture: Arc<Picture>,
    /// What a draft of the last size shows of it, and loses.
    reduced: Reduced,
}

/// A picture in the pixels of another with fewer.
#[derive(Default)]
struct Reduced {
    size: [u32; 2],
    /// For each pixel, as eyes see it, the mean, and its standard deviation.
    pixels: Vec<[[f32; 3]; 2]>,
}

impl StandingPicture {
    /// `picture`, as one that stands.
    pub fn new(picture: Arc<Picture>) -> Self {
        Self { picture, reduced: Reduced::default() }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.picture.width, self.picture.height]
    }

    /// What lies over `draft` when it is enlarged to the size of what stood: that, where the lens changes less than a draft loses in detail.
    pub fn layer_over(&mut self, draft: &Picture) -> PictureLayer {
        let size = [draft.width, draft.height];
        if self.reduced.size != size {
            self.reduced = Reduced::new(&self.picture, size);
        }
        let [columns, rows] = size.map(|side| side as usize);
        let changes: Vec<f32> = self.reduced.changes(draft);
        // The largest of a pixel and those beside it.
        let largest_near = |index: usize| {
            let (x, y) = (index % columns, index / columns);
            let beside = x.saturating_sub(1)..(x + 2).min(columns);
            let rows = y.saturating_sub(1)..(y + 2).min(rows);
            rows.flat_map(|row| &changes[row * columns..][beside.clone()]).copied().fold(0.0, f32::max)
        };
        let share = |index: usize| share_below(largest_near(index), &CHANGES);
        let shares = (0..changes.len()).into_par_iter().map(share).collect();
        PictureLayer::new(self.picture.clone(), size, shares)
    }
}

impl Reduced {
    fn new(picture: &Picture, size: [u32; 2]) -> Self {
        let within = |at: u32, axis: usize| {
            let own = [picture.width, picture.height][axis];
            let start = at * own / size[axis];
            start..((at + 1) * own / size[axis]).max(start + 1)
        };
        let pixel = |index: u32| {
            let columns = within(index % size[0], 0);
            let (mut sum, mut squares, mut count) = ([0.0; 3], [0.0; 3], 0.0);
            for y in within(index / size[0], 1) {
                for x in columns.clone() {
                    let pixel = seen(picture, (y * picture.width + x) as usize);
                    for c in 0..3 {
                        sum[c] += pixel[c];
                        squares[c] += pixel[c] * pixel[c];
                    }
                    count += 1.0;
                }
            }
            let means = sum.map(|sum| sum / count);
            let deviation = |c: usize| (squares[c] / count - means[c] * means[c]).max(0.0).sqrt();
            [means, std::array::from_fn(deviation)]
        };
        Self { size, pixels: (0..size[0] * size[1]).into_par_iter().map(pixel).collect() }
    }

    /// For each pixel of a draft, by how much it differs from the mean of what stands there, as a multiple of the standard deviation within
    /// it.
    fn changes(&self, draft: &Picture) -> Vec<f32> {
        let change = |(index, [means, deviations]): (usize, &[[f32; 3]; 2])| {
            let of_draft = seen(draft, index);
            let of_colour = |c: usize| (of_draft[c] - means[c]).abs() / deviations[c].max(LEAST_LOSS);
            (0..3).map(of_colour).fold(0.0, f32::max)
        };
        self.pixels.par_iter().enumerate().map(change).collect()
    }
}

/// A pixel as it is shown, and as eyes see that, roughly: its root.
fn seen(picture: &Picture, index: usize) -> [f32; 3] {
    let per_coverage = 1.0 / picture.coverage[index].max(f32::MIN_POSITIVE);
    let root = |channel: f32| (channel * per_coverage).clamp(0.0, 1.0).sqrt();
    let [r, g, b] = picture.radiance[index];
    [root(r), root(g), root(b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::enlarging::enlarged;
    use crate::display::layer::Layer;

    #[test]
    fn what_stood_stays_where_a_draft_shows_the_same() {
        // Fine stripes, which the draft shows as grey; it has another light on the right.
        let size = [160, 80];
        let mut standing = Picture::black(size[0], size[1]);
        standing.coverage.fill(1.0);
        let stripes = |index: usize| [if index.is_multiple_of(2) { 0.3 } else { 0.5 }; 3];
        standing.radiance = (0..standing.radiance.len()).map(stripes).collect();
        let mut draft = standing.averaged(4);
        let of_right = draft.radiance.iter_mut().enumerate().filter(|(index, _)| index % 40 >= 20);
        of_right.for_each(|(_, rgb)| *rgb = [0.8; 3]);
        let mut shown = enlarged(&draft, size);
        let layer = StandingPicture::new(Arc::new(standing.clone())).layer_over(&draft);
        layer.lay_over(&mut shown, &size.map(|side| 0..side));
        let row = 40 * size[0] as usize;
        let [left, right] = [0..70, 90..160].map(|columns| row + columns.start..row + columns.end);
        assert_eq!(shown.radiance[left.clone()], standing.radiance[left]);
        assert!(shown.radiance[right].iter().all(|rgb| (rgb[0] - 0.8).abs() < 1e-3));
    }
}
