//! The visibility of the aperture from a surface point: a shadow ray per cell of the aperture, all of them at once.

use crate::domain::Cell;
use crate::jitter::{Net, jitter};
use crate::sample::Visibility;
use crate::view::View;
use glam::DVec2;
use rayon::prelude::*;
use trace::{PointSet, PreparedSight, SightQuery, SquareVisibility, TargetPoints, Tracer, Viewpoint};

/// How much of its cell, along each axis, the places of a ray are spread over, of 16 cells a side.
///
/// Rays anywhere in their cells measure visibility best. Where cells are larger than pixels they blur
/// the image of an edge, though, which those through their middles do half as much; that the edges of many samples together lie
/// anywhere in their cells is then sufficient.
const SPREADS: [f64; 5] = [1.0, 0.75, 0.5, 0.375, 0.25];

/// Rays are spread over at least this many px of the picture, as the standard lens shows it, where that is within their cells.
const SPREAD_PX: f64 = 0.5;

/// The resolution of visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fineness {
    /// 8 cells a side.
    Coarse,
    /// 16 cells a side, with this one of [`SPREADS`].
    Fine(usize),
}

impl Fineness {
    /// How finely a point of inverse depth `inverse_depth` (1/length) sees the aperture: by the size of its circle of
    /// confusion.
    pub fn for_depth(view: &View, inverse_depth: f64) -> Self {
        let circle_px = view.circle_px(inverse_depth);
        if circle_px <= view.tolerance_px {
            return Self::Coarse;
        }
        // The narrowest that is as wide, or the narrowest of all.
        let target_spread = SPREAD_PX * 16.0 / circle_px;
        Self::Fine(SPREADS.iter().skip(1).take_while(|&&spread| target_spread <= spread).count())
    }

    fn cells_per_side(self) -> usize {
        match self {
            Self::Coarse => 8,
            Self::Fine(_) => 16,
        }
    }
}

/// Where in each cell of the aperture its ray goes through: several patterns, spread so that in each cell of it the rays of
/// neighbours are spread evenly, too.
pub struct Patterns {
    coarse: Vec<TargetPoints>,
    /// By spread.
    fine: [Vec<TargetPoints>; SPREADS.len()],
}

impl Patterns {
    /// Binary digits of the coordinates that select a pixel's pattern.
    const DIGITS: u32 = 3;

    /// How many there are of each.
    const COUNT: u32 = 1 << (2 * Self::DIGITS);

    /// Makes all patterns, coarse (8 × 8) and fine (16 × 16).
    pub fn new() -> Self {
        let all =
            |side: usize, spread: f64| (0..Self::COUNT).map(|k| Self::pattern(side, spread, k)).collect();
        Self { coarse: all(8, 1.0), fine: SPREADS.map(|spread| all(16, spread)) }
    }

    fn pattern(side: usize, spread: f64, number: u32) -> TargetPoints {
        let net = Net::for_pattern(side.ilog2(), number);
        let place = |cell: usize| {
            let (row, column) = (cell / side, cell % side);
            let [u, v] = net.place(row, column).map(|at| 0.5 + spread * (at - 0.5));
            DVec2::new(column as f64 + u, row as f64 + v) * (2.0 / side as f64) - 1.0
        };
        TargetPoints::new(&(0..side * side).map(place).collect::<Vec<_>>())
    }

    /// The number of the pattern for the `index`-th surface of a cell: along Morton's curve, so that neighbours have others.
    pub fn number_of(cell: Cell, index: usize) -> u32 {
        let at = (cell.corner / cell.side).as_uvec2();
        let digit = |k: u32| (at.x >> k & 1) << (2 * k) | (at.y >> k & 1) << (2 * k + 1);
        (0..Self::DIGITS).map(digit).sum::<u32>() ^ (index as u32).wrapping_mul(21)
    }

    /// The number of a pattern below [`Self::COUNT`], chosen at random by `seed`.
    pub fn random_number(seed: [u32; 2]) -> u32 {
        (jitter(seed[0], seed[1], 0)[0] * f64::from(Self::COUNT)) as u32
    }

    /// All of them, as a device is given them.
    pub fn all(&self) -> Vec<&TargetPoints> {
        self.coarse.iter().chain(self.fine.iter().flatten()).collect()
    }

    /// Where among all of them a pattern is.
    fn place_among_all(fineness: Fineness, number: u32) -> u32 {
        let sets_before = match fineness {
            Fineness::Coarse => 0,
            Fineness::Fine(spread) => 1 + spread as u32,
        };
        sets_before * Self::COUNT + number % Self::COUNT
    }

    fn pattern_points(&self, fineness: Fineness, number: u32) -> &TargetPoints {
        let patterns = match fineness {
            Fineness::Coarse => &self.coarse,
            Fineness::Fine(spread) => &self.fine[spread],
        };
        &patterns[(number % Self::COUNT) as usize]
    }
}

/// A visible part of the aperture and its transmittance: less than 1 through partly transparent surfaces.
pub type VisiblePart = (Visibility, f32);

/// The cells of the aperture that a point sees, by how much of it: one ray each, of the pattern of a `number`. None if it sees
/// none.
///
/// `is_on_side` decides which aperture points lie on the side of the surface that the point represents.
pub fn visible_parts(
    tracer: &Tracer,
    view: &View,
    patterns: &Patterns,
    from: Viewpoint,
    fineness: Fineness,
    number: u32,
    is_on_side: impl Fn(DVec2) -> bool,
) -> Vec<VisiblePart> {
    let places = patterns.pattern_points(fineness, number);
    let visibility = tracer.square_visibility(from, &view.aperture_square(), places);
    parts(visibility, places, fineness, is_on_side)
}

/// The parts of the aperture by what is visible of its places.
fn parts(
    SquareVisibility { hidden, shares }: SquareVisibility,
    places: &TargetPoints,
    fineness: Fineness,
    is_on_side: impl Fn(DVec2) -> bool,
) -> Vec<VisiblePart> {
    let visible = (places.all() - hidden).iter().filter(|&cell| is_on_side(places.position(cell)));
    let part =
        |cells: PointSet| Visibility::from_words(&cells.words()[..fineness.cells_per_side().pow(2) / 64]);
    match shares {
        None => {
            let cells: PointSet = visible.collect();
            if cells.is_empty() { Vec::new() } else { vec![(part(cells), 1.0)] }
        }
        Some(shares) => {
            let levels = levels(visible.map(|cell| (shares[cell], cell)).collect());
            levels.into_iter().map(|(share, cells)| (part(cells.into_iter().collect()), share)).collect()
        }
    }
}

/// A surface point of whose view of the aperture is asked.
#[derive(Clone, Copy, Debug)]
pub struct VisibilityRequest {
    /// The point.
    pub from: Viewpoint,
    /// Its inverse depth, 1/length.
    pub inverse_depth: f64,
    /// The number of its pattern.
    pub number: u32,
}

/// Points that are so far apart in depth, px of parallax over half the aperture, share no search for what hides them.
const TOGETHER_PX: f64 = 4.0;

/// [`visible_parts`] of points that lie close together in the picture, in their order. What may hide any of them is searched for once.
pub fn visible_parts_of_many(
    tracer: &Tracer,
    view: &View,
    patterns: &Patterns,
    requests: &[VisibilityRequest],
) -> Vec<Vec<VisiblePart>> {
    let alone = |request: &VisibilityRequest| {
        let VisibilityRequest { from, inverse_depth, number } = *request;
        let fineness = Fineness::for_depth(view, inverse_depth);
        visible_parts(tracer, view, patterns, from, fineness, number, |_| true)
    };
    // Shares of light are multiplied in the order in which what is half transparent is found.
    if requests.len() < 2 || tracer.has_transparency() {
        return requests.iter().map(alone).collect();
    }
    let mut by_depth: Vec<usize> = (0..requests.len()).collect();
    let depth = |&at: &usize| requests[at].inverse_depth;
    by_depth.sort_by(|a, b| depth(a).total_cmp(&depth(b)).then(a.cmp(b)));
    let mut found = vec![Vec::new(); requests.len()];
    let square = view.aperture_square();
    let mut left = by_depth.as_slice();
    while let Some(first) = left.first() {
        let farthest = depth(first);
        let is_near = |at: &&usize| (depth(at) - farthest) * view.radius_per_kappa_px <= TOGETHER_PX;
        let count = left.iter().take_while(is_near).count().max(1);
        let (together, others) = left.split_at(count);
        left = others;
        let viewpoints: Vec<Viewpoint> = together.iter().map(|&at| requests[at].from).collect();
        let occluders = if count > 1 { tracer.square_occluders(&viewpoints, &square) } else { None };
        for &at in together {
            let VisibilityRequest { from, inverse_depth, number } = requests[at];
            found[at] = match &occluders {
                None => alone(&requests[at]),
                Some(occluders) => {
                    let fineness = Fineness::for_depth(view, inverse_depth);
                    let places = patterns.pattern_points(fineness, number);
                    parts(occluders.visibility(from, places), places, fineness, |_| true)
                }
            };
        }
    }
    found
}

/// [`visible_parts`] of any points, in their order, as a device sees them; the processor where it leaves them. `None` once it no longer works.
pub fn visible_parts_by_device(
    tracer: &Tracer,
    view: &View,
    patterns: &Patterns,
    device: &dyn PreparedSight,
    requests: &[VisibilityRequest],
) -> Option<Vec<Vec<VisiblePart>>> {
    let query = |request: &VisibilityRequest| {
        let fineness = Fineness::for_depth(view, request.inverse_depth);
        SightQuery { from: request.from, target: Patterns::place_among_all(fineness, request.number) }
    };
    let queries: Vec<_> = requests.par_iter().map(query).collect();
    let square = view.aperture_square();
    let parts_of = |(request, hidden): (&VisibilityRequest, Option<PointSet>)| {
        let VisibilityRequest { from, inverse_depth, number } = *request;
        let fineness = Fineness::for_depth(view, inverse_depth);
        let places = patterns.pattern_points(fineness, number);
        let visibility = match hidden {
            Some(hidden) => tracer.visibility_from_hidden(from, &square, places, hidden),
            None => tracer.square_visibility(from, &square, places),
        };
        parts(visibility, places, fineness, |_| true)
    };
    let hidden = device.hidden(&queries)?;
    Some(requests.par_iter().zip(hidden).map(parts_of).collect())
}

/// Shares that differ by no more than this part of them are one.
const SAME_SHARE: f32 = 1.0 / 1024.0;

/// At most this many different shares are kept; if there are more, steps between the least and the largest.
const MAX_SHARES: usize = 16;

/// Cells by transmittance. The mean is kept, however few the levels.
fn levels(mut cells: Vec<(f32, usize)>) -> Vec<(f32, Vec<usize>)> {
    cells.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let Some((&(least, _), &(largest, _))) = cells.first().zip(cells.last()) else { return Vec::new() };
    let level = |cells: &[(f32, usize)]| {
        let mean = cells.iter().map(|(share, _)| share).sum::<f32>() / cells.len() as f32;
        (mean, cells.iter().map(|(_, cell)| *cell).collect())
    };
    let alike: Vec<_> = cells.chunk_by(|a, b| b.0 - a.0 <= SAME_SHARE * b.0).collect();
    let is_resolved =
        alike.iter().all(|cells| cells[cells.len() - 1].0 - cells[0].0 <= 2.0 * SAME_SHARE * cells[0].0);
    if is_resolved && alike.len() <= MAX_SHARES {
        return alike.into_iter().map(level).collect();
    }
    let step =
        |share: f32| (((share - least) / (largest - least) * MAX_SHARES as f32) as usize).min(MAX_SHARES - 1);
    cells.chunk_by(|a, b| step(a.0) == step(b.0)).map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::IVec2;
    use lens::Camera;

    #[test]
    fn rays_are_spread_less_where_cells_are_larger_than_pixels() {
        let camera = Camera {
            width: 640,
            height: 360,
            focus_distance: 1.0,
            aperture_radius: 0.05,
            ..Camera::default()
        };
        let view = View::new(&camera, 2.0);
        let of_circle = |px: f64| {
            let kappa = view.optics.kappa_for_circle_px(px).expect("there is an aperture");
            Fineness::for_depth(&view, 1.0 - kappa)
        };
        let found = [1.0, 1.99, 2.01, 8.0, 12.0, 15.0, 18.0, 25.0, 500.0].map(of_circle);
        let spreads = [0, 0, 1, 1, 2, 3, 4].map(Fineness::Fine);
        assert_eq!(found[..2], [Fineness::Coarse; 2]);
        assert_eq!(found[2..], spreads);
    }

    #[test]
    fn shares_are_told_by_few_levels_that_keep_the_mean() {
        let cells =
            |share: &dyn Fn(usize) -> f32| (0..256).map(|cell| (share(cell), cell)).collect::<Vec<_>>();
        assert_eq!(levels(Vec::new()), Vec::new());
        assert_eq!(levels(cells(&|_| 0.5)).len(), 1);
        assert_eq!(levels(cells(&|cell| [0.5, 0.25, 1.0][cell % 3])).len(), 3);
        for share in [|cell: usize| (cell as f32 + 1.0) / 256.0, |cell: usize| 0.5 + 1e-5 * cell as f32] {
            let found = levels(cells(&share));
            assert!(found.len() <= MAX_SHARES);
            let mut all: Vec<_> = found.iter().flat_map(|(_, cells)| cells.clone()).collect();
            all.sort();
            assert!(all.into_iter().eq(0..256));
            let [mean, wanted] = [
                found.iter().map(|(share, cells)| share * cells.len() as f32).sum::<f32>(),
                (0..256).map(share).sum::<f32>(),
            ];
            assert!((mean / wanted - 1.0).abs() < 1e-5, "{mean} {wanted}");
        }
    }

    #[test]
    fn neighbours_have_patterns_of_their_own() {
        for (side, index) in [(1, 0), (1, 3), (4, 1)] {
            let mut found = [0; Patterns::COUNT as usize];
            for k in 0..Patterns::COUNT as i32 {
                let corner = IVec2::new(k % 8 - 16, k / 8 + 32) * side;
                let number = Patterns::number_of(Cell { corner, side }, index);
                found[(number % Patterns::COUNT) as usize] += 1;
            }
            assert!(found.iter().all(|&count| count == 1), "{side} {index}: {found:?}");
        }
    }
}
