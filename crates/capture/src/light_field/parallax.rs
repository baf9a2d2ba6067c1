//! Whether rows and columns of views run as their names say, measured from the pictures.
//!
//! Programs count rows from the top or from the bottom, and columns from the left or the right. For each possible orientation of the grid,
//! the test is how well one disparity per block of pixels explains the neighbours of the middle view on both axes at once:
//!
//! ```text
//! E(block, turn) = min over d of  Σ over views, pixels |R(p) − V(p − d·turn(position))|
//! ```
//!
//! A wrong orientation explains a block only where it has no detail along one of the axes, or no parallax. Each block whose best
//! orientation is clearly better than the others has a vote. Without a disparity map a grid cannot be distinguished from the same rotated
//! by 180°, whose disparities all have the other sign: columns are then assumed to be right. With one, all eight orientations are
//! distinguished, d being the map's.

use crate::depth_map::DepthMap;
use glam::{DVec2, Vec2Swizzles};
use scene::Photograph;

/// The orientation of a grid of views, relative to their names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct GridTurn {
    /// Rows are columns: the first number in a name is the column.
    pub is_transposed: bool,
    /// Columns, after that, run from right to left.
    pub columns_reversed: bool,
    /// Rows, after that, run from the bottom up.
    pub rows_reversed: bool,
}

impl GridTurn {
    /// The true position of a view from the position that its name says.
    pub fn apply(&self, position: DVec2) -> DVec2 {
        let DVec2 { x, y } = if self.is_transposed { position.yx() } else { position };
        let sign = |is_reversed| if is_reversed { -1.0 } else { 1.0 };
        DVec2::new(x * sign(self.columns_reversed), y * sign(self.rows_reversed))
    }
}

/// The orientation according to the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridTurnEstimate {
    /// The orientation was detected.
    Turned(GridTurn),
    /// All views lie in one line, which is as their names say: on which side of it is up cannot be detected.
    OneLine,
    /// There is too little parallax or detail, or no orientation explains the pictures.
    Unclear,
}

/// Side of a block, px.
const BLOCK: usize = 8;
/// The most pixels per side that are compared, around the middle.
const WINDOW: usize = 384;
/// The largest movement between the views that is tested, px of the reduced pictures.
const REACH: f64 = 16.0;
/// Pictures are compared at these reductions: large movements are small in small pictures.
const REDUCTIONS: [u32; 2] = [1, 4];

/// Estimates the orientation of the grid, from the pixels of a reference view and of some views around it with their positions according to
/// their names, relative to it; two on each axis are enough. `disparity` is the map of the reference, if there is one.
///
/// Brightness may differ between views by a factor.
pub fn estimate_grid_turn(
    reference: &Photograph,
    others: &[(DVec2, &Photograph)],
    disparity: Option<&DepthMap>,
) -> GridTurnEstimate {
    let luma = Luma::from_photograph(reference);
    let others: Vec<(DVec2, Luma)> = others
        .iter()
        .map(|(position, picture)| (*position, Luma::from_photograph(picture).brightened_to(&luma)))
        .collect();
    let groups = groups(&others, disparity.is_some());
    let mut votes = vec![0usize; groups.len()];
    for factor in REDUCTIONS {
        let reduced: Vec<(DVec2, Luma)> =
            others.iter().map(|(position, other)| (*position, other.reduced(factor))).collect();
        let view = luma.reduced(factor);
        if view.width < 4 * BLOCK
            || view.height < 4 * BLOCK
            || reduced.iter().any(|(_, other)| other.size() != view.size())
        {
            continue;
        }
        count_votes(&view, &reduced, &groups, disparity.map(|map| (map, f64::from(factor))), &mut votes);
    }
    let all: usize = votes.iter().sum();
    let Some(best) = (0..groups.len()).max_by_key(|group| votes[*group]) else {
        return GridTurnEstimate::Unclear;
    };
    // Two thirds of some, or clearly more than half of many.
    let (count, half) = (votes[best] as f64, 0.5 * all as f64);
    let is_clear = all >= 6 && 3 * votes[best] >= 2 * all || count > half + 3.0 * half.sqrt();
    if !is_clear {
        return GridTurnEstimate::Unclear;
    }
    match &groups[best][..] {
        [turn] => GridTurnEstimate::Turned(*turn),
        turns if turns.contains(&GridTurn::default()) => GridTurnEstimate::OneLine,
        turns => GridTurnEstimate::Turned(turns[0]),
    }
}

/// The possible orientations, grouped by those that cannot be distinguished.
fn groups(others: &[(DVec2, Luma)], has_map: bool) -> Vec<Vec<GridTurn>> {
    let bools = [false, true];
    let mut turns = Vec::new();
    for (is_transposed, columns_reversed, rows_reversed) in
        bools.into_iter().flat_map(|a| bools.into_iter().flat_map(move |b| bools.map(move |c| (a, b, c))))
    {
        if has_map || !columns_reversed {
            turns.push(GridTurn { is_transposed, columns_reversed, rows_reversed });
        }
    }
    let mut groups: Vec<Vec<GridTurn>> = Vec::new();
    let is_same = |a: &GridTurn, b: &GridTurn| {
        let sums =
            |sign: f64| others.iter().all(|(at, _)| (a.apply(*at) - sign * b.apply(*at)).length() < 1e-9);
        // Without a map the sign of all disparities is free.
        sums(1.0) || (!has_map && sums(-1.0))
    };
    for turn in turns {
        match groups.iter_mut().find(|group| is_same(&group[0], &turn)) {
            Some(group) => group.push(turn),
            None => groups.push(vec![turn]),
        }
    }
    groups
}

/// Lets each block vote for a group.
fn count_votes(
    view: &Luma,
    others: &[(DVec2, Luma)],
    groups: &[Vec<GridTurn>],
    map: Option<(&DepthMap, f64)>,
    votes: &mut [usize],
) {
    /// The factor by which a block's best orientation must be better than any other.
    const CLEARLY: f64 = 1.3;
    /// Differences of this much, of the square root of light, are noise.
    const NOISE: f64 = 0.004;
    let nearest = others.iter().map(|(at, _)| at.length()).fold(f64::INFINITY, f64::min);
    if !(nearest > 0.0 && nearest.is_finite()) {
        return;
    }
    let steps = movements().into_iter().map(|movement| movement / nearest).collect::<Vec<f64>>();
    let window = |side: usize| {
        let blocks = side.min(WINDOW) / BLOCK;
        ((side - blocks * BLOCK) / 2, blocks)
    };
    let ((left, across), (top, down)) = (window(view.width), window(view.height));
    // Every other block, as on a chessboard.
    let blocks = (0..down).flat_map(|y| (0..across).map(move |x| (x, y))).filter(|(x, y)| (x + y) % 2 == 0);
    for (x, y) in blocks {
        let corner = [left + x * BLOCK, top + y * BLOCK];
        if !view.has_detail(corner) {
            continue;
        }
        let errors: Vec<f64> = groups
            .iter()
            .map(|group| {
                let directions: Vec<DVec2> = others.iter().map(|(at, _)| group[0].apply(*at)).collect();
                match map {
                    Some((map, factor)) => view.error_with(corner, others, &directions, |[x, y]| {
                        map_at(map, [x, y], view.size()) / factor
                    }),
                    None => steps
                        .iter()
                        .map(|d| view.error_with(corner, others, &directions, |_| *d))
                        .fold(f64::INFINITY, f64::min),
                }
            })
            .collect();
        let Some(best) = (0..errors.len()).min_by(|a, b| errors[*a].total_cmp(&errors[*b])) else { continue };
        let second = errors
            .iter()
            .enumerate()
            .filter(|(at, _)| *at != best)
            .map(|(_, error)| *error)
            .fold(f64::INFINITY, f64::min);
        let noise = NOISE * (others.len() * BLOCK * BLOCK) as f64;
        if second.is_finite() && second + noise > CLEARLY * (errors[best] + noise) {
            votes[best] += 1;
        }
    }
}

/// Movements between two views that are tested, px: small ones finely.
fn movements() -> Vec<f64> {
    let mut all = vec![0.0];
    let mut at = 0.0;
    while at < REACH {
        at += if at < 2.0 {
            0.25
        } else if at < 6.0 {
            0.5
        } else {
            1.0
        };
        all.extend([at, -at]);
    }
    all
}

/// The disparity of a map at a pixel of a picture of this size, NaN where it is unknown.
fn map_at(map: &DepthMap, [x, y]: [usize; 2], size: [usize; 2]) -> f64 {
    let place = |at: usize, count: usize, side: u32| {
        ((2 * at + 1) * side as usize / (2 * count)).min(side as usize - 1)
    };
    let (x, y) = (place(x, size[0], map.width), place(y, size[1], map.height));
    f64::from(map.values[y * map.width as usize + x])
}

/// The square root of a picture's brightness: noise is uniform in light and shade.
struct Luma {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Luma {
    fn from_photograph(picture: &Photograph) -> Self {
        let values = picture.pixels.iter().map(|[r, g, b]| (0.25 * r + 0.5 * g + 0.25 * b).max(0.0).sqrt());
        Self { width: picture.width as usize, height: picture.height as usize, values: values.collect() }
    }

    fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    fn mean(&self) -> f32 {
        self.values.iter().sum::<f32>() / self.values.len().max(1) as f32
    }

    fn brightened_to(mut self, other: &Self) -> Self {
        let gain = other.mean() / self.mean();
        if gain.is_finite() {
            self.values.iter_mut().for_each(|value| *value *= gain);
        }
        self
    }

    fn reduced(&self, factor: u32) -> Self {
        let factor = factor as usize;
        let [width, height] = [self.width / factor, self.height / factor];
        let mean = |x: usize, y: usize| {
            let rows =
                (0..factor).map(|v| &self.values[(y * factor + v) * self.width + x * factor..][..factor]);
            rows.flatten().sum::<f32>() / (factor * factor) as f32
        };
        let values =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
        Self { width, height, values }
    }

    /// Whether the contrast of a block exceeds noise.
    fn has_detail(&self, [left, top]: [usize; 2]) -> bool {
        const MIN_CONTRAST: f32 = 0.03;
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for y in top..top + BLOCK {
            for value in &self.values[y * self.width + left..][..BLOCK] {
                (low, high) = (low.min(*value), high.max(*value));
            }
        }
        high - low > MIN_CONTRAST
    }

    /// The sum of differences of a block to other views, moved by a disparity along their directions.
    fn error_with(
        &self,
        [left, top]: [usize; 2],
        others: &[(DVec2, Self)],
        directions: &[DVec2],
        disparity: impl Fn([usize; 2]) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        for y in top..top + BLOCK {
            for x in left..left + BLOCK {
                let d = disparity([x, y]);
                if d.is_nan() {
                    continue;
                }
                let here = self.values[y * self.width + x];
                for ((_, other), direction) in others.iter().zip(directions) {
                    let there = other.at(x as f64 - d * direction.x, y as f64 - d * direction.y);
                    sum += f64::from((here - there).abs());
                }
            }
        }
        sum
    }

    /// The value at a position between pixels, 0 the centre of the first.
    fn at(&self, x: f64, y: f64) -> f32 {
        let clamped = |at: f64, side: usize| {
            let at = at.clamp(0.0, (side - 1) as f64);
            let first = (at as usize).min(side.saturating_sub(2));
            (first, (first + 1).min(side - 1), (at - first as f64) as f32)
        };
        let ((x0, x1, right), (y0, y1, down)) = (clamped(x, self.width), clamped(y, self.height));
        let value = |x: usize, y: usize| self.values[y * self.width + x];
        let row = |y: usize| value(x0, y) + right * (value(x1, y) - value(x0, y));
        row(y0) + down * (row(y1) - row(y0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth_map::DepthMeaning;

    const SIZE: u32 = 96;

    /// A picture of waves, moved: the left half has disparity 1.2, the right −0.7.
    fn view(position: DVec2, gain: f32) -> Photograph {
        let wave = |x: f64, y: f64| {
            0.5 + 0.12 * (x * 0.9 + 1.7 * (y * 0.31).sin()).sin()
                + 0.12 * (y * 0.8 + (x * 0.23).cos()).sin()
                + 0.1 * ((x + y) * 0.37).sin()
        };
        let pixel = |x: u32, y: u32| {
            let d = disparity(x);
            let light = wave(f64::from(x) + d * position.x, f64::from(y) + d * position.y);
            [gain * (light * light) as f32; 3]
        };
        let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| pixel(x, y))).collect();
        Photograph { width: SIZE, height: SIZE, pixels }
    }

    fn disparity(x: u32) -> f64 {
        if x < SIZE / 2 { 1.2 } else { -0.7 }
    }

    fn estimate(named: &[(f64, f64)], is: GridTurn, map: Option<&DepthMap>) -> GridTurnEstimate {
        let named: Vec<DVec2> = named.iter().map(|(x, y)| DVec2::new(*x, *y)).collect();
        let pictures: Vec<Photograph> = named.iter().map(|at| view(is.apply(*at), 0.8)).collect();
        let others: Vec<(DVec2, &Photograph)> = named.iter().copied().zip(&pictures).collect();
        estimate_grid_turn(&view(DVec2::ZERO, 1.0), &others, map)
    }

    const CROSS: [(f64, f64); 4] = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];

    #[test]
    fn rows_are_distinguished_from_rows_reversed_and_from_columns() {
        for is_transposed in [false, true] {
            for rows_reversed in [false, true] {
                let turn = GridTurn { is_transposed, columns_reversed: false, rows_reversed };
                assert_eq!(estimate(&CROSS, turn, None), GridTurnEstimate::Turned(turn));
                // Half a cross is enough, and so is a corner.
                assert_eq!(estimate(&CROSS[1..3], turn, None), GridTurnEstimate::Turned(turn));
                // And a step of two.
                assert_eq!(estimate(&[(2.0, 0.0), (0.0, -2.0)], turn, None), GridTurnEstimate::Turned(turn));
            }
        }
    }

    #[test]
    fn a_map_decides_columns_too() {
        let values = (0..SIZE * SIZE).map(|at| disparity(at % SIZE) as f32).collect();
        let map = DepthMap { width: SIZE, height: SIZE, values, meaning: DepthMeaning::Disparity };
        for [is_transposed, columns_reversed, rows_reversed] in
            [[false, true, false], [false, true, true], [true, true, true], [false; 3]]
        {
            let turn = GridTurn { is_transposed, columns_reversed, rows_reversed };
            assert_eq!(estimate(&CROSS, turn, Some(&map)), GridTurnEstimate::Turned(turn));
        }
        // Without it, a grid turned by 180° is one that is not.
        let half = GridTurn { is_transposed: false, columns_reversed: true, rows_reversed: true };
        assert_eq!(estimate(&CROSS, half, None), GridTurnEstimate::Turned(GridTurn::default()));
    }

    #[test]
    fn one_line_decides_nothing_of_the_other() {
        for rows_reversed in [false, true] {
            let turn = GridTurn { rows_reversed, ..GridTurn::default() };
            assert_eq!(estimate(&CROSS[..2], turn, None), GridTurnEstimate::OneLine);
        }
        // But that it is vertical.
        let upright = GridTurn { is_transposed: true, ..GridTurn::default() };
        assert_eq!(estimate(&CROSS[..2], upright, None), GridTurnEstimate::Turned(upright));
    }

    #[test]
    fn without_parallax_or_detail_nothing_is_decided() {
        let still = view(DVec2::ZERO, 1.0);
        let others: Vec<(DVec2, &Photograph)> =
            CROSS.iter().map(|(x, y)| (DVec2::new(*x, *y), &still)).collect();
        assert_eq!(estimate_grid_turn(&still, &others, None), GridTurnEstimate::Unclear);
        let grey = Photograph { pixels: vec![[0.5; 3]; still.pixels.len()], ..still.clone() };
        let others: Vec<(DVec2, &Photograph)> =
            CROSS.iter().map(|(x, y)| (DVec2::new(*x, *y), &grey)).collect();
        assert_eq!(estimate_grid_turn(&grey, &others, None), GridTurnEstimate::Unclear);
        assert_eq!(estimate_grid_turn(&grey, &[], None), GridTurnEstimate::Unclear);
    }
}
