//! Blur without a light field: a picture of one ray a pixel, blurred by the circle of confusion of each pixel, painted or not.
//!
//! The light of a pixel is spread over its circle: it covers 1/area of the aperture of each pixel there. What covers a pixel fills its aperture,
//! the nearest first, until that is full. Where it never is (what lies behind what is nearer was not seen), it is filled with what is seen
//! behind, around it. Large circles are kept in cells of several pixels, so that each pixel looks at a bounded number.

mod behind;
mod cells;
mod covers;
mod level;

use crate::display::antialiasing::rgb_and_coverage;
use baselines::FirstHits;
use behind::Behind;
use cells::{LEVELS, MIN_RADIUS_PX, NEARER_SHARE, SLICES, Value, add_share, level_of};
use covers::Covers;
use lens::{Camera, FocusOffset, Picture};
use level::Level;
use rayon::prelude::*;

/// A pixel that is covered less than this is filled from behind; the sum of a full one is known to about so much.
const FULL: f32 = 0.95;

/// A picture of one ray a pixel, blurred.
#[derive(Debug)]
pub(crate) struct Defocused {
    pub picture: Picture,
    /// By pixel, the radius of the smallest circle of confusion whose light is there, px.
    pub min_radii: Vec<f32>,
}

impl Defocused {
    /// Blurs the picture of `hits` by the lens of `camera`, whose picture has their size. Circles are round whatever the aperture's shape is,
    /// and their radius is at most 96 px.
    pub fn new(hits: &FirstHits, camera: &Camera) -> Self {
        let optics = camera.optics();
        let radius = |(&depth, &focus): (&f32, &FocusOffset)| {
            optics.splat_radius_px(optics.kappa(1.0 / f64::from(depth), focus)).abs() as f32
        };
        Self::by_radii(hits, &hits.depth.par_iter().zip(&hits.focus).map(radius).collect::<Vec<f32>>())
    }

    /// Blurs the picture of `hits` by the radius of each pixel's circle of confusion, px.
    fn by_radii(hits: &FirstHits, radii: &[f32]) -> Self {
        let size = [hits.width as usize, hits.height as usize];
        let picture = hits.picture();
        let values: Vec<Value> = (0..radii.len()).map(|index| rgb_and_coverage(&picture, index)).collect();
        let slices = depth_slices(&hits.depth);
        let levels: Vec<Level> = (0..LEVELS)
            .into_par_iter()
            .map(|level| Level::new(level, size, radii, &values, &slices))
            .collect();
        let behind = Behind::pyramid(size, &values, &hits.depth);
        let pixel = |index: usize| {
            let place = [(index % size[0]) as f32 + 0.5, (index / size[0]) as f32 + 0.5];
            let mut covers = Covers::NONE;
            for level in &levels {
                level.add_what_covers(place, &mut covers);
            }
            let mut shown = covers.nearest_first();
            if shown[4] < FULL {
                let farther_than = hits.depth[index] * (1.0 + NEARER_SHARE);
                let radius = radii[index].max(MIN_RADIUS_PX);
                let sum = behind[level_of(radius)].sum_around(place, radius, farther_than);
                if sum[4] > 0.0 {
                    let share = (FULL - shown[4]) / sum[4];
                    add_share(&mut shown, &sum, share);
                }
            }
            let [r, g, b, coverage, covered] = shown;
            (([r / covered, g / covered, b / covered], coverage / covered), covers.min_radius)
        };
        let ((radiance, coverage), min_radii): ((Vec<_>, Vec<_>), Vec<_>) =
            (0..radii.len()).into_par_iter().map(pixel).unzip();
        Self { picture: Picture { radiance, coverage, ..picture }, min_radii }
    }
}

/// The slice of each depth, nearest first; what is infinitely far has the last for itself.
fn depth_slices(depths: &[f32]) -> Vec<u8> {
    let finite = || depths.iter().filter(|depth| depth.is_finite()).map(|depth| 1.0 / depth);
    let (first, last) = (finite().fold(0.0, f32::max), finite().fold(f32::INFINITY, f32::min));
    let slice = |&depth: &f32| {
        if depth.is_infinite() {
            return SLICES as u8 - 1;
        }
        let place = if first > last { (first - 1.0 / depth) / (first - last) } else { 0.0 };
        (place * (SLICES - 2) as f32) as u8
    };
    depths.iter().map(slice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 240;

    /// A black picture at a depth of 2.
    fn black() -> FirstHits {
        let mut hits = FirstHits::background(SIDE, SIDE);
        hits.depth.fill(2.0);
        hits.radiance.fill([0.0; 3]);
        hits
    }

    /// The picture whose left half has one depth, light and radius, and whose right half another.
    fn halves(left: (f32, f32, f32), right: (f32, f32, f32)) -> Vec<f32> {
        let (mut hits, mut radii) = (black(), vec![0.0; (SIDE * SIDE) as usize]);
        for (index, own_radius) in radii.iter_mut().enumerate() {
            let (depth, light, radius) = if index as u32 % SIDE < SIDE / 2 { left } else { right };
            (hits.depth[index], hits.radiance[index], *own_radius) = (depth, [light; 3], radius);
        }
        let row = SIDE as usize * SIDE as usize / 2;
        let shown = Defocused::by_radii(&hits, &radii).picture;
        shown.radiance[row..row + SIDE as usize].iter().map(|rgb| rgb[0]).collect()
    }

    #[test]
    fn a_point_becomes_a_disc_that_keeps_its_light() {
        for radius in [0.0, 0.7, 1.5, 5.0, 7.0, 20.0, 60.0] {
            let mut hits = black();
            let middle = (SIDE / 2 * SIDE + SIDE / 2) as usize;
            hits.radiance[middle] = [1e6; 3];
            let shown = Defocused::by_radii(&hits, &vec![radius; hits.depth.len()]);
            let light = |index: usize| f64::from(shown.picture.radiance[index][0]);
            let sum: f64 = (0..hits.depth.len()).map(light).sum();
            assert!((sum / 1e6 - 1.0).abs() < 0.04, "radius {radius}: {sum}");
            let squares = |index: usize| {
                let at = |place: usize| (place as f64 - f64::from(SIDE / 2)).powi(2);
                light(index) * (at(index % SIDE as usize) + at(index / SIDE as usize))
            };
            let mean = (0..hits.depth.len()).map(squares).sum::<f64>() / sum;
            // The mean square of a disc's radii is half that of its rim.
            let disc = f64::from(radius).powi(2) / 2.0;
            assert!((mean - disc).abs() < 0.5 + 0.05 * disc, "radius {radius}: {mean} for {disc}");
        }
    }

    #[test]
    fn a_wall_stays_uniform_whatever_its_circles() {
        let mut hits = black();
        hits.radiance.fill([0.25, 0.5, 4.0]);
        let radii: Vec<f32> = (0..hits.depth.len()).map(|index| (index as u32 % SIDE) as f32 / 2.0).collect();
        let shown = Defocused::by_radii(&hits, &radii).picture;
        for rgb in shown.radiance {
            assert!((rgb[0] - 0.25).abs() < 1e-5 && (rgb[2] - 4.0).abs() < 1e-4, "{rgb:?}");
        }
    }

    #[test]
    fn what_is_sharp_and_bright_does_not_shine_into_the_blur_behind() {
        for behind in [3.0, f32::INFINITY] {
            let row = halves((2.0, 1000.0, 0.3), (behind, 0.0, 30.0));
            assert!(row[..118].iter().all(|light| (light - 1000.0).abs() < 1e-2), "{row:?}");
            assert!(row[122..].iter().all(|&light| light == 0.0), "{row:?}");
        }
    }

    #[test]
    fn what_is_blurred_before_something_is_half_transparent_at_its_edge() {
        for radius in [4.0, 20.0] {
            let row = halves((2.0, 1.0, radius), (4.0, 0.0, 0.0));
            assert!((0.35..0.65).contains(&row[119]), "{}", row[119]);
            let quarter = [119 - radius as usize / 2, 119 + radius as usize / 2].map(|at| row[at]);
            assert!((0.7..0.95).contains(&quarter[0]) && (0.05..0.3).contains(&quarter[1]), "{quarter:?}");
            assert!(row[119 + radius as usize + 3] == 0.0 && (row[115 - radius as usize] - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_floor_that_recedes_hides_what_is_behind_it() {
        // Each row farther than the next, before something bright and blurred.
        let (mut hits, mut radii) = (black(), vec![4.0; (SIDE * SIDE) as usize]);
        for (index, radius) in radii.iter_mut().enumerate() {
            let [x, y] = [index as u32 % SIDE, index as u32 / SIDE];
            hits.depth[index] = 1.0 + 0.02 * (SIDE - y) as f32;
            if x >= SIDE / 2 {
                (hits.depth[index], hits.radiance[index], *radius) = (f32::INFINITY, [1.0; 3], 10.0);
            }
        }
        let shown = Defocused::by_radii(&hits, &radii);
        for y in 10..SIDE - 10 {
            let light = shown.picture.radiance[(y * SIDE + SIDE / 2 - 6) as usize][0];
            assert!(light < 0.03, "row {y}: {light}");
        }
        let [sharp, blurred] = [SIDE / 2 - 30, SIDE / 2 + 30].map(|x| shown.min_radii[x as usize]);
        assert_eq!([sharp, blurred], [4.0, 10.0]);
    }

    #[test]
    fn a_picture_of_one_pixel_and_circles_without_end() {
        let mut hits = FirstHits::background(1, 1);
        hits.radiance = vec![[3.0; 3]];
        let shown = Defocused::by_radii(&hits, &[f32::INFINITY]).picture;
        assert!((shown.radiance[0][0] - 3.0).abs() < 1e-5, "{shown:?}");
        assert!(
            Defocused::by_radii(&black(), &vec![f32::INFINITY; (SIDE * SIDE) as usize])
                .picture
                .radiance
                .iter()
                .all(|rgb| rgb[0] == 0.0)
        );
    }
}
