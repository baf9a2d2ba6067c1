//! Rays of a tile, several at once.
//!
//! The rays of a tile have nearly one direction D₀. With D = D₀ + (x, y, 0) the vectors of a ray's response ([`super::Eye`]) are linear in its offset:
//!
//! ```text
//! q = W D = W D₀ + x w₁ + y w₂        p × q = p × W D₀ + x p × w₁ + y p × w₂
//! ```
//!
//! with w₁ and w₂ the first columns of W. The constants are computed once for a tile and a splat, in 64 bits and in units of |W D₀|, so that all are of moderate size:
//! p × W D₀ is then the distance of the middle ray in standard deviations. What is left for a ray are 32-bit products, of eight rays beside each other.

use super::MAX_ALPHA;
use super::eye::{Eye, Hit, MIN_TRANSMITTANCE};
use super::shape::MIN_ALPHA;
use glam::DVec3;
use numerics::with_widest_simd;

/// Rays that are traced at once.
pub(crate) const LANES: usize = 8;

/// What the rays of a tile need of a splat.
struct TileSplat {
    /// p × q: that of the middle ray, and its changes with x and y.
    cross: [[f32; 3]; 3],
    /// q, the same way.
    q: [[f32; 3]; 3],
    p: [f32; 3],
    cutoff: f32,
    opacity: f32,
    /// Its index in the view.
    index: u32,
    /// The first and the last row of rays that it can meet.
    rows: [u32; 2],
}

/// The splats that rays of a tile can meet.
pub(crate) struct TileTracer {
    middle: DVec3,
    splats: Vec<TileSplat>,
}

/// What up to [`LANES`] rays meet: a list of hits for each, and what is left of it.
#[derive(Default)]
pub(crate) struct LaneHits {
    pub hits: [Vec<Hit>; LANES],
    pub rest: [f64; LANES],
}

/// How long a ray is followed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Follow {
    /// Until nearly nothing of it is left.
    Visible,
    /// To its end.
    All,
    /// Each until nearly nothing of it is left, and at most to before this splat of the view; 0: not at all.
    Before([u32; LANES]),
}

impl TileTracer {
    /// For rays near the direction `middle` (z = 1) from an eye, which meet no splats but `candidates`, in the rows of rays beside each.
    pub fn new(eye: &Eye<'_>, middle: DVec3, candidates: impl Iterator<Item = (u32, [u32; 2])>) -> Self {
        let splats = candidates.map(|(index, rows)| TileSplat::new(eye, middle, index, rows)).collect();
        Self { middle, splats }
    }

    /// Traces up to [`LANES`] rays of row `row` in `directions` (z = 1).
    pub fn trace(&self, row: u32, directions: &[DVec3], follow: Follow, lanes: &mut LaneHits) {
        with_widest_simd(
            #[inline(always)]
            || self.trace_lanes(row, directions, follow, lanes),
        );
    }

    #[inline(always)]
    fn trace_lanes(&self, row: u32, directions: &[DVec3], follow: Follow, lanes: &mut LaneHits) {
        lanes.hits.iter_mut().for_each(Vec::clear);
        lanes.rest = [1.0; LANES];
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for (lane, direction) in directions.iter().enumerate() {
            let offset = *direction - self.middle;
            (x[lane], y[lane]) = (offset.x as f32, offset.y as f32);
        }
        let (least_rest, before) = match follow {
            Follow::Visible => (MIN_TRANSMITTANCE, [u32::MAX; LANES]),
            Follow::All => (0.0, [u32::MAX; LANES]),
            Follow::Before(splats) => (MIN_TRANSMITTANCE, splats),
        };
        // A bit for each ray that is followed further, and the first splat at which that changes.
        let mut active = (0..directions.len()).map(|lane| u32::from(before[lane] > 0) << lane).sum::<u32>();
        let next_end = |active: u32| {
            let ends = (0..LANES).filter(|lane| active >> lane & 1 == 1).map(|lane| before[lane]);
            ends.min().unwrap_or(0)
        };
        let mut end = next_end(active);
        for splat in &self.splats {
            if splat.index >= end {
                (0..LANES).for_each(|lane| active &= !(u32::from(before[lane] <= splat.index) << lane));
                end = next_end(active);
            }
            if active == 0 {
                break;
            }
            if row < splat.rows[0] || splat.rows[1] < row {
                continue;
            }
            let distances = squared_lengths(&splat.cross, &x, &y);
            let squares = squared_lengths(&splat.q, &x, &y);
            let mut near = 0;
            for lane in 0..LANES {
                near |= u32::from(distances[lane] <= splat.cutoff * squares[lane]) << lane;
            }
            near &= active;
            if near == 0 {
                continue;
            }
            let (mut alphas, mut depths) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                let response = exp_of_negative(-0.5 * distances[lane] / squares[lane]);
                alphas[lane] = (splat.opacity * response).min(MAX_ALPHA as f32);
                depths[lane] = splat.depth(x[lane], y[lane], squares[lane]);
            }
            while near != 0 {
                let lane = near.trailing_zeros() as usize;
                near &= near - 1;
                let (alpha, depth) = (alphas[lane], depths[lane]);
                // What is behind the aperture is not met.
                if alpha < MIN_ALPHA as f32 || depth <= 0.0 {
                    continue;
                }
                let (alpha, rest) = (f64::from(alpha), &mut lanes.rest[lane]);
                lanes.hits[lane].push(Hit {
                    splat: splat.index,
                    alpha,
                    weight: alpha * *rest,
                    depth: depth.into(),
                });
                *rest *= 1.0 - alpha;
                if *rest < least_rest {
                    active &= !(1 << lane);
                }
            }
        }
    }
}

/// eˣ for −6 ≤ x ≤ 0, to 1e-6 of itself, by operations that round alike on every machine; less exact below.
///
/// x log₂e = n + f with |f| ≤ ½; 2ᶠ by its Taylor polynomial.
#[inline(always)]
fn exp_of_negative(x: f32) -> f32 {
    /// Its sum with a small number has the nearest integer in its lowest bits.
    const ROUNDING: f32 = 12_582_912.0;
    let exponent = x * std::f32::consts::LOG2_E;
    let rounded = exponent + ROUNDING;
    let f = (exponent - (rounded - ROUNDING)) * std::f32::consts::LN_2;
    let power = 1.0
        + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    let scale = rounded.to_bits().wrapping_sub(ROUNDING.to_bits()).wrapping_add(127) << 23;
    power * f32::from_bits(scale)
}

/// |v + x vₓ + y vᵧ|² of rays with offsets x and y, of the vectors v, vₓ and vᵧ.
#[inline(always)]
fn squared_lengths([v, vx, vy]: &[[f32; 3]; 3], x: &[f32; LANES], y: &[f32; LANES]) -> [f32; LANES] {
    let mut sums = [0.0; LANES];
    for lane in 0..LANES {
        let a = v[0] + x[lane] * vx[0] + y[lane] * vy[0];
        let b = v[1] + x[lane] * vx[1] + y[lane] * vy[1];
        let c = v[2] + x[lane] * vx[2] + y[lane] * vy[2];
        sums[lane] = a * a + b * b + c * c;
    }
    sums
}

impl TileSplat {
    fn new(eye: &Eye<'_>, middle: DVec3, index: u32, rows: [u32; 2]) -> Self {
        let shape = &eye.view().splats()[index as usize].shape;
        let q = shape.whitened(middle);
        let unit = q.length().recip();
        let (p, q) = (eye.whitened_mean(index), q * unit);
        let (qx, qy) = (shape.whitened(DVec3::X) * unit, shape.whitened(DVec3::Y) * unit);
        let narrow = |v: DVec3| v.as_vec3().to_array();
        Self {
            cross: [narrow(p.cross(q)), narrow(p.cross(qx)), narrow(p.cross(qy))],
            q: [narrow(q), narrow(qx), narrow(qy)],
            p: narrow(p * unit),
            cutoff: shape.cutoff as f32,
            opacity: shape.opacity as f32,
            index,
            rows,
        }
    }

    /// p·q / q·q.
    #[inline(always)]
    fn depth(&self, x: f32, y: f32, square: f32) -> f32 {
        let [q, qx, qy] = &self.q;
        let along = |k: usize| self.p[k] * (q[k] + x * qx[k] + y * qy[k]);
        (along(0) + along(1) + along(2)) / square
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{CloudBuilder, CloudTraits, Splat};
    use crate::placement::Placement;
    use crate::view::GaussianView;
    use glam::{DVec2, Quat, Vec3};

    #[test]
    fn exponentials_are_exact_to_single_precision() {
        for k in 0..=6000 {
            let x = -0.001 * k as f32;
            let (value, expected) = (f64::from(exp_of_negative(x)), f64::from(x).exp());
            assert!((value / expected - 1.0).abs() < 1e-6, "{x}: {value} {expected}");
        }
        assert_eq!(exp_of_negative(0.0), 1.0);
    }

    /// Thin splats at all angles, each 1e-4 as thick as wide: 32 bits beside 64.
    #[test]
    fn tiles_meet_what_single_rays_meet() {
        let mut builder = CloudBuilder::new(0, 200);
        for k in 0..200u32 {
            let turn = |step: f32| (k as f32 * step).fract() - 0.5;
            builder.push(
                Splat {
                    mean: Vec3::new(0.2 * turn(0.618), 0.2 * turn(0.414), -2.0 + turn(0.732)),
                    rotation: Quat::from_xyzw(turn(0.9), turn(0.37), turn(0.71), turn(0.53)),
                    log_scale: Vec3::new(0.1, 0.05, 1e-5).map(f32::ln),
                    opacity: 0.3,
                    base_color: Vec3::ZERO,
                },
                &[],
            );
        }
        let cloud = builder.finish(CloudTraits::default());
        let camera = lens::Camera { height: 2000, ..lens::Camera::default() };
        let view = GaussianView::new(&cloud, &Placement::IDENTITY, &camera);
        let eye = Eye::new(&view, DVec2::new(0.01, -0.005));
        let middle = DVec3::new(0.02, -0.01, 1.0);
        let tracer = TileTracer::new(&eye, middle, (0..view.len() as u32).map(|splat| (splat, [0, 0])));
        let directions: Vec<DVec3> =
            (0..5).map(|k| middle + DVec3::new(0.002 * f64::from(k), -0.001, 0.0)).collect();
        for (follow, stops) in [(Follow::Visible, true), (Follow::All, false)] {
            let mut lanes = LaneHits::default();
            tracer.trace(0, &directions, follow, &mut lanes);
            for (direction, hits) in directions.iter().zip(&lanes.hits) {
                let expected = if stops { eye.hits(*direction) } else { eye.all_hits(*direction) };
                let sum = |hits: &[Hit]| hits.iter().map(|hit| hit.weight).sum::<f64>();
                let depth = |hits: &[Hit]| hits.iter().map(|hit| hit.weight * hit.depth).sum::<f64>();
                assert!(expected.len() > 20 && expected.len().abs_diff(hits.len()) <= 1);
                assert!((sum(hits) - sum(&expected)).abs() < 1e-5, "{} {}", sum(hits), sum(&expected));
                assert!(
                    (depth(hits) - depth(&expected)).abs() < 1e-3,
                    "{} {}",
                    depth(hits),
                    depth(&expected)
                );
            }
            assert!(lanes.hits[5..].iter().all(Vec::is_empty));
        }
    }
}
