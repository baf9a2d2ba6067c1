//! The light that a surface sends toward the aperture, in the most compact form.
//!
//! Own light changes little over the aperture and is one radiance, unless views of a light field show otherwise
//! (`own_light_change`). Carried light of a lobe of width ω, over an aperture that subtends the angle δ at the surface, needs
//! about 6 δ/ω radiances per side; in an aperture image of c px, no more than c over the tolerance can be resolved. It is
//! sampled on that many cells, which are merged again where they are alike.
//!
//! Own and carried light share the weight of their patch, as they share its coverage, so each is divided by its share.

pub mod aperture_parts;
pub mod own_light_change;

use crate::baker::outgoing::aperture_parts::{ApertureCells, AperturePart, MAX_CELLS};
use crate::carried::Carried;
use crate::jitter::jitter;
use crate::sample::Visibility;
use crate::view::View;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::FRAC_PI_4;
use surface::SurfacePoint;
use trace::{IncidentLight, OutgoingRadiance, Radiance, SampleSlot};

/// Cells per side for a lobe as wide as the aperture appears.
const CELLS_A_WIDTH: f64 = 6.0;

/// Cells are joined whose light differs from their mean by at most this share of all the light that is sent.
pub const ALIKE: f32 = 0.05;

/// Shares of coverage are multiples of one over this: few values, so that few planes differ, and exact in 11 bits.
const STEPS: f32 = 128.0;

/// Light toward the aperture, and what of the weight of its patch it has.
#[derive(Clone, Debug, PartialEq)]
pub struct LightComponent {
    /// Its radiance, linear RGB.
    pub radiance: Vec3,
    /// Its share of the patch's weight, in [0, 1].
    pub share: f32,
    /// Whether it is carried light; otherwise own.
    pub is_carried: bool,
    /// The noisy part of the radiance ([`OutgoingRadiance::noisy`]).
    pub noisy: Vec3,
    /// The part of the aperture that it is sent toward.
    pub toward: Visibility,
}

/// Means of what some points send.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeanRadiance {
    own: Vec3,
    carried: Vec3,
    carried_share: f32,
    noisy: [Vec3; 2],
    weight: f32,
}

impl MeanRadiance {
    /// The mean radiance of points with these weights.
    pub fn mean(of: impl IntoIterator<Item = (OutgoingRadiance, f32)>) -> Self {
        let mut sum = Self::default();
        for (OutgoingRadiance { own, carried, carried_share, noisy }, weight) in of {
            sum.own += own * weight;
            sum.carried += carried * weight;
            sum.carried_share += carried_share * weight;
            (0..2).for_each(|kind| sum.noisy[kind] += noisy[kind] * weight);
            sum.weight += weight;
        }
        let by = 1.0 / sum.weight;
        Self {
            own: sum.own * by,
            carried: sum.carried * by,
            carried_share: sum.carried_share * by,
            noisy: sum.noisy.map(|light| light * by),
            ..sum
        }
    }

    /// The mean as the radiance of one point.
    pub fn to_outgoing(self) -> OutgoingRadiance {
        let Self { own, carried, carried_share, noisy, .. } = self;
        OutgoingRadiance { own, carried, carried_share, noisy }
    }

    /// The sum of own and carried radiance, linear RGB.
    pub fn total(&self) -> Vec3 {
        self.own + self.carried
    }

    /// The share of carried light, quantised; neither 0 nor 1 where there are both kinds.
    fn share(&self) -> f32 {
        let share = (self.carried_share * STEPS).round() / STEPS;
        let least = if self.carried_share > 0.0 { 1.0 / STEPS } else { 0.0 };
        let most = if self.own != Vec3::ZERO { 1.0 - 1.0 / STEPS } else { 1.0 };
        share.clamp(least, most)
    }

    /// Its two kinds of light, each toward the whole aperture.
    pub fn components(&self) -> impl Iterator<Item = LightComponent> + use<> {
        let share = self.share();
        let kinds = [(self.own, 1.0 - share, false), (self.carried, share, true)].into_iter().zip(self.noisy);
        kinds.filter(|((_, share, _), _)| *share > 0.0).map(|((light, share, is_carried), noisy)| {
            LightComponent {
                radiance: clamped(light / share),
                share,
                is_carried,
                noisy: noisy / share,
                toward: Visibility::Open,
            }
        })
    }
}

/// Paths that correct an estimate may make light negative; 0 is then closer to the true value.
fn clamped(light: Vec3) -> Vec3 {
    light.max(Vec3::ZERO)
}

/// The number of cells per side on which carried light is sampled, of a point of inverse depth `inverse_depth` whose narrowest lobe is
/// `width` rad wide.
pub fn cells_per_side(view: &View, inverse_depth: f64, width: f64) -> usize {
    let circle_px = view.circle_px(inverse_depth);
    let of_lobe = cells_of_lobe(view, inverse_depth, width);
    let cells = match view.carried {
        Carried::Standard => (circle_px / view.tolerance_px).min(of_lobe),
        Carried::Painted => of_lobe,
    };
    // Without an aperture nothing can be resolved: 0/0.
    if cells > 1.0 { (cells.min(MAX_CELLS as f64).ceil() as usize).next_power_of_two() } else { 1 }
}

/// How many cells a side of the aperture the light of a lobe of `width` (rad) needs, for a point of inverse depth
/// `inverse_depth`.
pub fn cells_of_lobe(view: &View, inverse_depth: f64, width: f64) -> f64 {
    CELLS_A_WIDTH * 2.0 * view.optics.aperture_radius * inverse_depth / width
}

/// A query for the light of a cell's points: the light model, the view, and what has been computed already.
#[derive(Clone, Copy)]
pub struct RadianceQuery<'a> {
    /// The light that surfaces send.
    pub radiance: &'a dyn Radiance,
    /// The camera's view.
    pub view: &'a View<'a>,
    /// Of the cell.
    pub seed: [u32; 2],
    /// What its points receive.
    pub incident: Option<IncidentLight>,
    /// Whether only own light is needed.
    pub own_only: bool,
    /// How many cells the picture takes the mean of, wherever it is focused.
    pub blurred: usize,
}

impl RadianceQuery<'_> {
    /// What a point sends toward a world position: the `index`-th of `count` queries.
    pub fn outgoing(&self, point: SurfacePoint, eye: DVec3, index: usize, count: usize) -> OutgoingRadiance {
        let seed = u64::from(self.seed[0]) << 32 | u64::from(self.seed[1]);
        let count = count * self.blurred;
        let slot = SampleSlot {
            seed,
            index: index as u32,
            count: count as u32,
            incident: self.incident,
            own_only: self.own_only,
        };
        self.radiance.outgoing_sample(point, eye, slot)
    }
}

/// The radiance that each point sends toward a place of its own on the open aperture; the places are evenly spread.
pub fn toward_aperture_points(query: &RadianceQuery, points: &[SurfacePoint]) -> Vec<OutgoingRadiance> {
    // Roberts's sequence: fractions of the plastic number's powers.
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);
    let RadianceQuery { view, seed, .. } = *query;
    let [x, y, _] = jitter(seed[0], seed[1], 1 << 20);
    let place = |k: usize| {
        let at = (DVec2::new(x, y) + STEP * k as f64).fract();
        view.aperture_point(view.open_aperture.sample(at.x, at.y))
    };
    let sent = |(k, &point): (usize, &SurfacePoint)| query.outgoing(point, place(k), k, points.len());
    points.iter().enumerate().map(sent).collect()
}

/// The side of the largest square of the picture, px, on which carried light is computed once: in a wide aperture image, its exact
/// origin is invisible. 1 where every cell has its own.
pub fn tile_side(view: &View, inverse_depth: f64) -> i32 {
    /// Its share of the image.
    const SHARE: f64 = 0.25;
    const LARGEST: f64 = 8.0;
    if view.carried == Carried::Painted {
        return 1;
    }
    let circle_px = view.circle_px(inverse_depth);
    let side = (SHARE * circle_px).clamp(1.0, LARGEST);
    1 << (side as u32).ilog2()
}

/// The number of pixels, at least 1, over which the light of a point with standard focus is spread.
pub fn blurred_px(view: &View, inverse_depth: f64) -> usize {
    if view.carried == Carried::Painted {
        return 1;
    }
    let circle_px = view.circle_px(inverse_depth);
    (FRAC_PI_4 * circle_px * circle_px).max(1.0) as usize
}

/// What points send toward each cell of the aperture.
pub struct ApertureRadiance {
    /// What the points send toward all cells in the mean.
    pub all: MeanRadiance,
    side: usize,
    /// Carried light of all points toward each cell, row by row from v = −1.
    carried: Vec<Vec3>,
    /// The noisy part of it.
    noisy: Vec<Vec3>,
}

impl ApertureRadiance {
    /// Samples the light of weighted points, or of a subset, toward `side` × `side` cells: every cell has as many samples, and
    /// neighbouring points sample distant cells.
    pub fn gather(query: &RadianceQuery, points: &[(SurfacePoint, f32)], side: usize) -> Self {
        let RadianceQuery { view, seed, .. } = *query;
        let cells = side * side;
        const MOST: usize = 128;
        let count = cells * points.len().min(MOST).div_ceil(cells);
        let bits = cells.ilog2();
        let mut of_points: Vec<Vec<(OutgoingRadiance, f32)>> = vec![Vec::new(); points.len()];
        let mut of_cells: Vec<Vec<(OutgoingRadiance, f32)>> = vec![Vec::new(); cells];
        let turn = (jitter(seed[0], seed[1], 1 << 21)[0] * cells as f64) as usize;
        for sample in 0..count {
            let at = sample * points.len() / count;
            let (point, weight) = points[at];
            let cell = ((sample % cells) as u32).reverse_bits() >> (u32::BITS - bits);
            let [row, column] = crate::domain::Cell::row_and_column(cell as usize ^ turn);
            let [x, y, _] = jitter(seed[0], seed[1], (1 << 22) + sample as u32);
            let place = DVec2::new(column as f64 + x, row as f64 + y) * (2.0 / side as f64) - 1.0;
            let outgoing = query.outgoing(point, view.aperture_point(place), sample, count);
            of_points[at].push((outgoing, weight));
            of_cells[row * side + column].push((outgoing, weight));
        }
        let of_cells: Vec<_> = of_cells.into_iter().map(MeanRadiance::mean).collect();
        let of_points = of_points.into_iter().zip(points).filter(|(sent, _)| !sent.is_empty());
        let of_points =
            of_points.map(|(sent, (_, weight))| (MeanRadiance::mean(sent).to_outgoing(), *weight));
        Self {
            all: MeanRadiance::mean(of_points),
            side,
            carried: of_cells.iter().map(|sent| sent.carried).collect(),
            noisy: of_cells.iter().map(|sent| sent.noisy[1]).collect(),
        }
    }

    /// The same carried light beside `own`, other own light.
    pub fn with_own(&self, own: MeanRadiance) -> Self {
        let all = MeanRadiance { carried: self.all.carried, ..own };
        Self { all, side: self.side, carried: self.carried.clone(), noisy: self.noisy.clone() }
    }

    /// The carried light, on as few parts of the aperture as possible without changing it noticeably.
    pub fn carried(&self) -> Vec<LightComponent> {
        let differs = ALIKE * self.all.total().max_element();
        let cells = ApertureCells { side: self.side, light: &self.carried, noisy: &self.noisy };
        let share = self.all.share();
        let part = |AperturePart { light, noisy, cells }| LightComponent {
            radiance: clamped(light / share),
            share,
            is_carried: true,
            noisy: noisy / share,
            toward: Visibility::from_words(&[cells]),
        };
        cells.parts(differs).into_iter().map(part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::Camera;

    /// A mirror that shows something bright toward the right of the aperture, over a ground of its own.
    struct Mirror;

    impl Radiance for Mirror {
        fn outgoing(&self, _point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
            let carried = Vec3::splat(if eye.x > 0.25 { 8.0 } else { 0.5 });
            OutgoingRadiance {
                own: Vec3::splat(0.3),
                carried,
                carried_share: 0.25,
                ..OutgoingRadiance::default()
            }
        }
        fn environment(&self, _direction: DVec3) -> Vec3 {
            Vec3::ZERO
        }
    }

    #[test]
    fn carried_light_is_told_on_as_few_cells_as_it_needs() {
        let camera = Camera { width: 64, height: 64, aperture_radius: 0.5, ..Camera::default() };
        let view = View::new(&camera, 2.0);
        let points = vec![(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }, 1.0); 16];
        let of = RadianceQuery {
            radiance: &Mirror,
            view: &view,
            seed: [3, 5],
            incident: None,
            own_only: false,
            blurred: 1,
        };
        let gathered = ApertureRadiance::gather(&of, &points, 4);
        let parts = gathered.carried();
        // The left half as two quarters, and the right one cell by cell: three quarters of it are bright.
        assert_eq!(parts.len(), 2 + 8, "{parts:?}");
        let mut seen = 0;
        for part in &parts {
            let Visibility::Cells { words } = &part.toward else { panic!("a part: {part:?}") };
            assert_eq!(seen & words[0], 0, "parts do not overlap");
            seen |= words[0];
            assert!((part.share, part.is_carried) == (0.25, true));
        }
        assert_eq!(seen, u64::MAX);
        let light = |part: &LightComponent| match &part.toward {
            Visibility::Open => part.radiance.x,
            Visibility::Cells { words } => part.radiance.x * words[0].count_ones() as f32 / 64.0,
        };
        let sum: f32 = parts.iter().map(light).sum::<f32>() * 0.25;
        let expected = 0.75 * 0.5 + 0.25 * 8.0;
        assert!((sum - expected).abs() < 0.8, "{sum} for {expected}: cells on the edge are either");
        // What is the same toward all is one.
        let even = ApertureRadiance { carried: vec![Vec3::ONE; 16], ..gathered };
        assert_eq!(even.carried().len(), 1);
        assert_eq!(even.carried()[0].toward, Visibility::Open);
    }

    #[test]
    fn kinds_share_the_weight_and_keep_the_light() {
        for share in [0.0, 0.001, 0.3, 0.999, 1.0] {
            for own in [0.0, 2.0] {
                let sent = MeanRadiance::mean([(
                    OutgoingRadiance {
                        own: Vec3::splat(own),
                        carried: Vec3::splat(4.0 * share),
                        carried_share: share,
                        ..OutgoingRadiance::default()
                    },
                    0.5,
                )]);
                let kinds: Vec<_> = sent.components().collect();
                assert_eq!(kinds.iter().map(|kind| kind.share).sum::<f32>(), 1.0);
                let light: Vec3 = kinds.iter().map(|kind| kind.radiance * kind.share).sum();
                assert!((light - sent.total()).abs().max_element() < 1e-5, "{share}, {own}: {kinds:?}");
            }
        }
    }

    #[test]
    fn narrow_lobes_far_out_of_focus_need_the_most_cells() {
        let camera = Camera { width: 1920, height: 1080, aperture_radius: 0.02, ..Camera::default() };
        let view = View::new(&camera, 2.0);
        let focus = 1.0 / camera.focus_distance;
        let of = |inverse_depth: f64, width: f64| cells_per_side(&view, inverse_depth, width);
        assert_eq!((of(focus, 0.0), of(1.0, 0.0), of(1.0, 0.65)), (1, 8, 1));
        assert!((2..8).contains(&of(1.0, 0.06)), "{}", of(1.0, 0.06));
        let pinhole = Camera { aperture_radius: 0.0, ..camera };
        assert_eq!(cells_per_side(&View::new(&pinhole, 2.0), 1.0, 0.0), 1);
    }
}
