//! What a picture of one ray a pixel knows better than a rough picture that is enlarged.
//!
//! A rough picture has few pixels, and shows what is in focus, or nearly, as blocks. The picture without blur has that detail: where the
//! circle of confusion is small, and no blur of something nearer reaches, it is shown itself; where the circle is a few pixels of the rough
//! picture, the detail that is left of it in a blur over that circle is added to the rough picture. What is blurred more has no detail.

use crate::display::antialiasing::{antialiased, rgb_and_coverage};
use crate::display::enlarging::{enlarged, reduced};
use crate::display::layer::{Layer, lay_over_each, share_below};
use crate::display::picture_ring::Rectangle;
use baselines::FirstHits;
use lens::{Camera, FocusOffset, Picture};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Between these diameters of the circle of confusion, in pixels of the rough picture, the light of the rough picture takes the place of
/// the sharp one's.
const ROUGH_CIRCLES: RangeInclusive<f32> = 1.0..=2.0;
/// Between these, detail fades.
const FADING_CIRCLES: RangeInclusive<f32> = 2.0..=6.0;
/// So many points of a circle of confusion are looked at for its detail.
const DETAIL_POINTS: usize = 32;
/// A surface hides another if it is nearer by this share of the depth.
const NEARER_SHARE: f32 = 0.01;
/// Blur reaches no farther than this many pixels of the rough picture: beyond that, all is blurred.
const MAX_REACH: i32 = 24;

/// What is laid over an enlarged rough picture; values are radiance in RGB, and coverage.
#[derive(Debug)]
pub(crate) struct SharpLayer {
    width: usize,
    /// The light that the rough picture should have, and how much of its own this replaces.
    base: Vec<([f32; 4], f32)>,
    /// What is added to that.
    detail: Vec<[f32; 4]>,
}

impl SharpLayer {
    /// The layer over a picture of `rough` columns and rows that is enlarged to `size`, from the first hits of the same view with the lens of
    /// `camera`, whose picture has the hits' size.
    pub fn new(hits: &FirstHits, camera: &Camera, rough: [u32; 2], size: [u32; 2]) -> Self {
        let own = [hits.width, hits.height];
        let per_hit = rough[0] as f32 / hits.width as f32;
        let optics = camera.optics();
        let circle = |(&depth, &focus): (&f32, &FocusOffset)| {
            let kappa = optics.kappa(1.0 / f64::from(depth), focus);
            2.0 * optics.splat_radius_px(kappa).abs() as f32 * per_hit
        };
        let circles: Vec<f32> = hits.depth.par_iter().zip(&hits.focus).map(circle).collect();
        let reaching = reaching_circles(hits, &circles, rough);
        let sharp = antialiased(&hits.picture());
        let blurred = slightly_blurred(&sharp, hits, &circles, per_hit);
        let blurred = if own == size { blurred } else { enlarged(&blurred, size) };
        let smooth = enlarged(&reduced(&blurred, rough), size);
        let at = |index: usize, from: [u32; 2]| {
            let [x, y] = [index as u32 % size[0], index as u32 / size[0]];
            let [column, row] = [x * from[0] / size[0], y * from[1] / size[1]];
            row as usize * from[0] as usize + column as usize
        };
        let layer = |index: usize| {
            let circle = circles[at(index, own)].max(reaching[at(index, rough)]);
            let [base, value] = [&smooth, &blurred].map(|picture| rgb_and_coverage(picture, index));
            let weight = share_below(circle, &FADING_CIRCLES);
            let detail = std::array::from_fn(|c| (value[c] - base[c]) * weight);
            ((base, share_below(circle, &ROUGH_CIRCLES)), detail)
        };
        let pixels = size[0] as usize * size[1] as usize;
        let (base, detail) = (0..pixels).into_par_iter().map(layer).unzip();
        Self { width: size[0] as usize, base, detail }
    }
}

impl Layer for SharpLayer {
    fn lay_over(&self, part: &mut Picture, rectangle: &Rectangle) {
        lay_over_each(
            part,
            rectangle,
            self.width,
            |_| (),
            |(), _, index| {
                let (base, share) = self.base[index];
                (base, share, self.detail[index])
            },
        );
    }
}

/// A picture without blur, blurred where circles are so small that detail is left: every pixel by its own circle, of what is not nearer.
fn slightly_blurred(sharp: &Picture, hits: &FirstHits, circles: &[f32], per_hit: f32) -> Picture {
    // Vogel's spiral (1979): points of equal density in the unit disc.
    let golden_angle = std::f32::consts::PI * (3.0 - 5.0f32.sqrt());
    let points: [[f32; 2]; DETAIL_POINTS] = std::array::from_fn(|k| {
        let (angle, radius) = (k as f32 * golden_angle, ((k as f32 + 0.5) / DETAIL_POINTS as f32).sqrt());
        [radius * angle.cos(), radius * angle.sin()]
    });
    let (width, height) = (hits.width as usize, hits.height as usize);
    let value = |index: usize| {
        let radius = circles[index] / 2.0 / per_hit;
        let is_wanted = circles[index] < *FADING_CIRCLES.end();
        if radius <= 0.5 || !is_wanted {
            return rgb_and_coverage(sharp, index);
        }
        let (x, y) = ((index % width) as f32, (index / width) as f32);
        let nearest = hits.depth[index] * (1.0 - NEARER_SHARE);
        let (mut sum, mut count) = (rgb_and_coverage(sharp, index), 1.0);
        for [u, v] in points {
            let column = ((x + u * radius).round().max(0.0) as usize).min(width - 1);
            let row = ((y + v * radius).round().max(0.0) as usize).min(height - 1);
            let other = row * width + column;
            if hits.depth[other] >= nearest {
                let value = rgb_and_coverage(sharp, other);
                (0..4).for_each(|c| sum[c] += value[c]);
                count += 1.0;
            }
        }
        sum.map(|c| c / count)
    };
    let values = (0..circles.len()).into_par_iter().map(value);
    let (radiance, coverage) = values.map(|[r, g, b, covered]| ([r, g, b], covered)).unzip();
    Picture { radiance, coverage, ..Picture::black(hits.width, hits.height) }
}

/// For every pixel of the rough picture the largest circle, in its pixels, of a nearer surface whose blur reaches it; 0 for none.
fn reaching_circles(hits: &FirstHits, circles: &[f32], [columns, rows]: [u32; 2]) -> Vec<f32> {
    let count = columns as usize * rows as usize;
    // The nearest surface in each, with its circle, and the depth of the farthest.
    let (mut nearest, mut farthest) = (vec![(f32::INFINITY, 0.0f32); count], vec![0.0f32; count]);
    for (index, (&depth, &circle)) in hits.depth.iter().zip(circles).enumerate() {
        let [x, y] = [index as u32 % hits.width, index as u32 / hits.width];
        let cell = (y * rows / hits.height * columns + x * columns / hits.width) as usize;
        if depth < nearest[cell].0 {
            nearest[cell] = (depth, circle);
        }
        farthest[cell] = farthest[cell].max(depth);
    }
    let mut reaching = vec![0.0f32; count];
    for (cell, &(depth, circle)) in nearest.iter().enumerate() {
        if circle <= *ROUGH_CIRCLES.start() {
            continue;
        }
        let [x, y] = [cell as i32 % columns as i32, cell as i32 / columns as i32];
        // Half a pixel on either side.
        let radius = circle / 2.0 + 1.0;
        let reach = (radius as i32).min(MAX_REACH);
        for row in (y - reach).max(0)..=(y + reach).min(rows as i32 - 1) {
            for column in (x - reach).max(0)..=(x + reach).min(columns as i32 - 1) {
                let distance_squared = ((row - y).pow(2) + (column - x).pow(2)) as f32;
                let other = row as usize * columns as usize + column as usize;
                if distance_squared <= radius * radius && depth < farthest[other] * (1.0 - NEARER_SHARE) {
                    reaching[other] = reaching[other].max(circle);
                }
            }
        }
    }
    reaching
}

#[cfg(test)]
mod tests {
    use super::*;
    use baselines::gather_blur;
    use progress::Unwatched;

    const SIZE: [u32; 2] = [160, 80];
    const ROUGH: [u32; 2] = [40, 20];

    /// First hits whose left half is in focus at a depth of 2, and whose right half, at `depth`, has a circle of 8 pixels of
    /// the rough picture.
    fn halves(depth: f32) -> (FirstHits, Camera) {
        let lens = Camera { width: SIZE[0], height: SIZE[1], focus_distance: 2.0, ..Camera::default() };
        let circle = |camera: &Camera| {
            let optics = camera.optics();
            2.0 * optics.splat_radius_px(optics.kappa(1.0 / f64::from(depth), FocusOffset::STANDARD)).abs()
        };
        let unit = Camera { aperture_radius: 1e-3, ..lens };
        let camera = Camera { aperture_radius: 1e-3 * 32.0 / circle(&unit), ..unit };
        let mut hits = FirstHits::background(SIZE[0], SIZE[1]);
        for index in 0..hits.depth.len() {
            hits.depth[index] = if index % 160 >= 80 { depth } else { 2.0 };
            hits.radiance[index] = [1.0; 3];
        }
        (hits, camera)
    }

    /// By column of the middle row: the share of the sharp picture.
    fn shares(depth: f32) -> Vec<f32> {
        let (hits, camera) = halves(depth);
        let layer = SharpLayer::new(&hits, &camera, ROUGH, SIZE);
        let mut part = Picture::black(SIZE[0], 1);
        layer.lay_over(&mut part, &[0..SIZE[0], 40..41]);
        part.radiance.iter().map(|rgb| rgb[0]).collect()
    }

    #[test]
    fn blur_behind_does_not_reach_what_is_sharp() {
        let shares = shares(5.0);
        assert!(shares[..80].iter().all(|&share| share == 1.0), "{shares:?}");
        assert!(shares[80..].iter().all(|&share| share == 0.0));
    }

    #[test]
    fn blur_in_front_does() {
        let shares = shares(1.0);
        // A radius of 4 pixels of the rough picture, 16 px, and one more.
        assert!(shares[..56].iter().all(|&share| share == 1.0), "{shares:?}");
        assert!(shares[66..].iter().all(|&share| share == 0.0));
    }

    #[test]
    fn a_smaller_picture_is_enlarged() {
        let (hits, camera) = halves(5.0);
        let layer = SharpLayer::new(&hits, &camera, ROUGH, [320, 160]);
        assert_eq!((layer.width, layer.base.len()), (320, 320 * 160));
        assert_eq!((layer.base[150].1, layer.base[170].1), (1.0, 0.0));
    }

    #[test]
    fn a_little_blur_keeps_the_detail_that_it_has() {
        // A wall of fine stripes behind what is in focus, with a circle of 3 pixels of the rough picture.
        let (mut hits, camera) = halves(5.0);
        let optics = camera.optics();
        let camera = Camera { aperture_radius: camera.aperture_radius * 3.0 / 8.0, ..camera };
        let kappa = optics.kappa(1.0 / 5.0, FocusOffset::STANDARD);
        for index in 0..hits.depth.len() {
            (hits.depth[index], hits.kappa[index]) = (5.0, kappa);
            hits.radiance[index] = [if (index % 160 / 10) % 2 == 0 { 1.0 } else { 0.2 }; 3];
        }
        let exact = gather_blur(&hits, &camera, &Unwatched).unwrap();
        let mut shown = enlarged(&reduced(&exact, ROUGH), SIZE);
        let error = |picture: &Picture| -> f32 {
            let square = |(a, b): (&[f32; 3], &[f32; 3])| (a[0] - b[0]).powi(2);
            picture.radiance.iter().zip(&exact.radiance).map(square).sum()
        };
        let of_rough = error(&shown);
        SharpLayer::new(&hits, &camera, ROUGH, SIZE).lay_over(&mut shown, &SIZE.map(|side| 0..side));
        assert!(error(&shown) < 0.5 * of_rough, "{} of {of_rough}", error(&shown));
    }
}
