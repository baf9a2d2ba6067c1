//! The light of the cut aperture for every place of the picture: its share, mean and spread.
//!
//! What rims leave of the aperture changes slowly over the picture and with depth, so that it is tabled for places and depths, and
//! interpolated between them. Boxes (small images) are made from it; larger images are cut row by row.

use glam::DVec2;
use lens::{Aperture, ApertureRows, CharacterOptics};
use rayon::prelude::*;

/// Moments of the light over the aperture, u in units of the lens's radius: 1, u, v, u² and v².
pub type Moments = [f32; 5];

/// Moments of the light, and of the light times g (see [`lens::Edges`]).
#[derive(Clone, Copy, Debug, Default)]
pub struct EdgeMoments {
    /// Of the light, as a share of an aperture's that is not cut.
    pub plain: Moments,
    /// The same times g.
    pub weighed: Moments,
}

impl EdgeMoments {
    /// The moments of light whose weight is 1 + `steepness`·g.
    #[inline]
    pub fn at(&self, steepness: f32) -> Moments {
        std::array::from_fn(|k| self.plain[k] + steepness * self.weighed[k])
    }

    fn mix(&self, other: &Self, share: f32) -> Self {
        let mix = |a: &Moments, b: &Moments| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share);
        Self { plain: mix(&self.plain, &other.plain), weighed: mix(&self.weighed, &other.weighed) }
    }
}

/// Places in a half-height.
const PLACES: f64 = 8.0;

/// Rows that the aperture is cut into.
const ROWS: usize = 64;

/// Depths, evenly spread in 1/z.
const DEPTHS: usize = 9;

/// How near the lens places are, 1/z times a rim's distance at most: nearer nodes count as there.
const NEAREST: f64 = 0.75;

/// The moments, by place and depth.
pub struct MomentTable {
    first: [f32; 2],
    columns: usize,
    rows: usize,
    per_inverse_depth: f32,
    entries: Vec<EdgeMoments>,
}

impl MomentTable {
    /// The table of a lens for places of `frame` (its middle and half extent, half-heights from the axis) and depths down to
    /// 1/`largest_inverse_depth`, or for one place and depth if nothing is cut.
    pub fn new(
        optics: &CharacterOptics,
        aperture: &Aperture,
        [middle, half]: [DVec2; 2],
        largest_inverse_depth: f64,
    ) -> Self {
        let distance = optics.farthest_rim();
        let nearest = if distance > 0.0 { NEAREST / distance } else { f64::INFINITY };
        let largest = largest_inverse_depth.min(nearest).max(f64::MIN_POSITIVE);
        let size = if optics.has_rims() { (2.0 * half * PLACES).ceil() + 2.0 } else { DVec2::ONE };
        let [columns, rows] = [size.x as usize, size.y as usize];
        let depths = if optics.has_rims() { DEPTHS } else { 1 };
        let (first, cut) = (middle - half, aperture.rows(ROWS));
        let step = largest / (DEPTHS - 1) as f64;
        let entry = |k: usize| {
            let (place, depth) = (k % (columns * rows), k / (columns * rows));
            let q = first + DVec2::new((place % columns) as f64, (place / columns) as f64) / PLACES;
            cut_moments(optics, &cut, q, depth as f64 * step)
        };
        Self {
            first: first.as_vec2().to_array(),
            columns,
            rows,
            per_inverse_depth: (1.0 / step) as f32,
            entries: (0..columns * rows * depths).into_par_iter().map(entry).collect(),
        }
    }

    /// The moments for a node at `q` (half-heights from the axis) of depth 1/`inverse_depth`.
    pub fn at(&self, q: [f32; 2], inverse_depth: f32) -> EdgeMoments {
        if self.entries.len() == 1 {
            return self.entries[0];
        }
        let (x, right) = step_of((q[0] - self.first[0]) * PLACES as f32, self.columns);
        let (y, up) = step_of((q[1] - self.first[1]) * PLACES as f32, self.rows);
        let (z, near) = step_of(inverse_depth * self.per_inverse_depth, DEPTHS);
        let plane = self.columns * self.rows;
        let at = |dz: usize, dy: usize| {
            let from = (z + dz) * plane + (y + dy) * self.columns + x;
            self.entries[from].mix(&self.entries[from + 1], right)
        };
        let on = |dz: usize| at(dz, 0).mix(&at(dz, 1), up);
        on(0).mix(&on(1), near)
    }
}

/// The step of a table of `count` places that `at` lies in, and how far.
fn step_of(at: f32, count: usize) -> (usize, f32) {
    let at = at.clamp(0.0, (count - 1) as f32);
    let step = (at as usize).min(count - 2);
    (step, at - step as f32)
}

/// The moments of what rims leave for a point at `q` of depth 1/`inverse_depth`.
fn cut_moments(optics: &CharacterOptics, cut: &ApertureRows, q: DVec2, inverse_depth: f64) -> EdgeMoments {
    let radius = optics.optics.aperture_radius;
    let edges = &optics.edges;
    let square = radius * radius * edges.per_square;
    let limits = optics.limits(q * optics.optics.tan_half_yfov, inverse_depth);
    let mut sums = [[0.0; 5]; 2];
    let (height, open_area) = (2.0 / cut.rows.len() as f64, cut.open_area());
    for (row, runs) in cut.rows.iter().enumerate() {
        let v = -1.0 + (row as f64 + 0.5) * height;
        let chord = limits.clone().try_fold([f64::NEG_INFINITY, f64::INFINITY], |[from, to], limit| {
            limit.chord(v * radius).map(|chord| [from.max(chord[0]), to.min(chord[1])])
        });
        let Some([from, to]) = chord else { continue };
        for run in &runs.runs {
            let (low, high) = if radius > 0.0 {
                (run.start.max(from / radius), run.end.min(to / radius))
            } else {
                (run.start, run.end)
            };
            if high <= low {
                continue;
            }
            let light = height * run.transmission / open_area;
            // ∫uᵏ du.
            let power = |k: i32| (high.powi(k + 1) - low.powi(k + 1)) / f64::from(k + 1) * light;
            let [m0, m1, m2, m3, m4] = [0, 1, 2, 3, 4].map(power);
            let vv = v * v + height * height / 12.0;
            let own = [m0, m1, v * m0, m2, vv * m0];
            let along = [m2, m3, v * m2, m4, vv * m2];
            for k in 0..5 {
                sums[0][k] += own[k];
                let of_square = square * (along[k] + vv * own[k]);
                sums[1][k] += 2.0 * (of_square - edges.mean * own[k]) / edges.extent;
            }
        }
    }
    let [plain, weighed] = sums.map(|sums| sums.map(|sum| sum as f32));
    EdgeMoments { plain, weighed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::{Camera, Character, Rim};

    fn camera(character: Character) -> Camera {
        Camera { character, ..Camera::default() }
    }

    #[test]
    fn an_uncut_disc_keeps_its_light_and_spreads_by_its_edges() {
        let camera = camera(Character { edges: 1.0, ..Character::default() });
        let table = MomentTable::new(&camera.character_optics(), &camera.aperture, camera.frame_q(), 1.0);
        let found = table.at([0.3, 0.7], 0.2);
        for (steepness, variance) in [(0.0, 0.25), (1.0, 1.0 / 3.0), (-1.0, 1.0 / 6.0)] {
            let [light, u, v, uu, vv] = found.at(steepness);
            assert!((light - 1.0).abs() < 1e-3 && u.abs() < 1e-5 && v.abs() < 1e-5, "{steepness} {light}");
            assert!((uu - variance).abs() < 1e-3 && (vv - variance).abs() < 1e-3, "{steepness} {uu} {vv}");
        }
    }

    #[test]
    fn the_table_is_what_it_tables() {
        let rim = Rim { radius: 0.016, distance: 0.03 };
        let camera = camera(Character { edges: 0.5, rims: [Some(rim), None], ..Character::default() });
        let (optics, cut) = (camera.character_optics(), camera.aperture.rows(512));
        let table = MomentTable::new(&optics, &camera.aperture, camera.frame_q(), 2.0);
        let mut darkest = 1.0f32;
        for (x, y, inverse_depth) in
            [(0.0, 0.0, 0.4), (0.71, -0.33, 0.1), (-1.6, 0.9, 1.3), (1.77, 0.99, 0.0)]
        {
            let exact = cut_moments(&optics, &cut, DVec2::new(x, y), inverse_depth);
            let found = table.at([x as f32, y as f32], inverse_depth as f32);
            for k in 0..5 {
                assert!((found.plain[k] - exact.plain[k]).abs() < 2e-3, "{x} {y} {k}: {found:?} {exact:?}");
                assert!(
                    (found.weighed[k] - exact.weighed[k]).abs() < 4e-3,
                    "{x} {y} {k}: {found:?} {exact:?}"
                );
            }
            darkest = darkest.min(exact.plain[0]);
        }
        assert!(darkest < 0.6, "{darkest}");
    }
}
