//! What is sharp of a picture without blur, laid over a rough picture that is enlarged.
//!
//! A rough picture has few pixels, and shows what is in focus as blocks. Where the circle of confusion is small, and no blur of something
//! nearer reaches, the picture without blur is closer to the exact one.

use crate::display::antialiasing::antialiased;
use crate::display::enlarging::enlarged;
use crate::display::picture_ring::Rectangle;
use baselines::FirstHits;
use lens::{Camera, FocusOffset, Picture};
use rayon::prelude::*;

/// Up to this diameter of the circle of confusion, in pixels of the rough picture, the sharp picture is shown alone.
const SHARP_CIRCLE: f32 = 1.0;
/// From this diameter on, the rough picture is.
const ROUGH_CIRCLE: f32 = 2.0;
/// A surface hides another if it is nearer by this share of the depth.
const NEARER_SHARE: f32 = 0.01;
/// Blur reaches no farther than this many pixels of the rough picture: beyond that, all is blurred.
const MAX_REACH: i32 = 24;

/// A picture without blur, and how much of it is shown.
#[derive(Debug)]
pub(crate) struct SharpLayer {
    picture: Picture,
    /// By pixel: the share of this picture; the rest is the rough one's.
    shares: Vec<f32>,
}

impl SharpLayer {
    /// The layer over a picture of `rough` columns and rows that is enlarged to `size`, from the first hits of the same view with the lens of
    /// `camera`, whose picture has the hits' size.
    pub fn new(hits: &FirstHits, camera: &Camera, rough: [u32; 2], size: [u32; 2]) -> Self {
        let per_hit = rough[0] as f32 / hits.width as f32;
        let optics = camera.optics();
        let circle = |(&depth, &focus): (&f32, &FocusOffset)| {
            let kappa = optics.kappa(1.0 / f64::from(depth), focus);
            2.0 * optics.splat_radius_px(kappa).abs() as f32 * per_hit
        };
        let circles: Vec<f32> = hits.depth.par_iter().zip(&hits.focus).map(circle).collect();
        let reaching = reaching_circles(hits, &circles, rough);
        let at = |index: usize, from: [u32; 2]| {
            let [x, y] = [index as u32 % size[0], index as u32 / size[0]];
            let [column, row] = [x * from[0] / size[0], y * from[1] / size[1]];
            row as usize * from[0] as usize + column as usize
        };
        let share = |index: usize| {
            let circle = circles[at(index, [hits.width, hits.height])].max(reaching[at(index, rough)]);
            1.0 - ((circle - SHARP_CIRCLE) / (ROUGH_CIRCLE - SHARP_CIRCLE)).clamp(0.0, 1.0)
        };
        let shares = (0..size[0] as usize * size[1] as usize).map(share).collect();
        let picture = antialiased(&hits.picture());
        let is_of_size = [picture.width, picture.height] == size;
        Self { picture: if is_of_size { picture } else { enlarged(&picture, size) }, shares }
    }

    /// Lays it over `part`, a rectangle of the enlarged picture.
    pub fn lay_over(&self, part: &mut Picture, [columns, rows]: &Rectangle) {
        let width = self.picture.width as usize;
        let indices =
            rows.clone().flat_map(|row| columns.clone().map(move |x| row as usize * width + x as usize));
        for ((radiance, coverage), index) in part.radiance.iter_mut().zip(&mut part.coverage).zip(indices) {
            let share = self.shares[index];
            if share > 0.0 {
                let mix = |rough: f32, sharp: f32| rough + (sharp - rough) * share;
                let sharp = self.picture.radiance[index];
                *radiance = std::array::from_fn(|c| mix(radiance[c], sharp[c]));
                *coverage = mix(*coverage, self.picture.coverage[index]);
            }
        }
    }
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
        if circle <= SHARP_CIRCLE {
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
        assert_eq!((layer.picture.width, layer.shares.len()), (320, 320 * 160));
        assert_eq!((layer.shares[150], layer.shares[170]), (1.0, 0.0));
    }
}
