//! What sharing and evening take away is given back nearby.
//!
//! That partly occluded samples share what open ones leave, and that the standard picture's coverage is evened out (see
//! [`crate::partition`]), makes each pixel's coverage right, but moves light: what a small card that is hidden in part
//! loses, the wall beside it gets. So light is scaled, colour by colour, by gains g that vary slowly over the picture,
//!
//! ```text
//! g(q) = G·Σ_k b_k(q)·r_k,     r_k = (⟨b_k, before⟩/⟨b_k, after⟩) / (the same of coverage)
//! ```
//!
//! b_k the tents of knots [`SPACING`] apart, which sum to 1; "before" and "after" the light of the standard picture before
//! and after it was shared (or evened). r_k gives back where it was taken, as far as it is not coverage itself that was
//! mended there. G, one number for each colour and near 1, then makes the whole picture's sum what it was: as
//!
//! ```text
//! Σ_q g(q)·after(q) = G·Σ_k r_k·⟨b_k, after⟩
//! ```
//!
//! that needs the knots alone. Gains are found with the shares, from the standard picture: paint leaves them as they are.
//! Coverage has none.
//!
//! Where a part of the scene is painted, the rest, which shares alone now, gets back what was taken while all shared. So the
//! sum of a painted picture is off by some 0.05 %; but for live ones, a further gain for each colour of the light that shares
//! makes it what it was ([`rest`]).

use crate::partition::{Parts, Share};
use crate::resolve::Light;
use crate::widest::with_widest_instructions;
use glam::Vec4;
use rayon::prelude::*;

/// How far knots lie apart, px. What is taken from a surface is given back within that of it.
pub const SPACING: usize = 32;

/// Which light is scaled: that of the sharing samples, where the picture is not evened out; else all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaled {
    Sharing = 0,
    All = 1,
}

/// Red, green, blue and coverage of the standard picture, weighted by a knot's tent: of sharing samples before and after
/// they share, of the picture before that and after it is evened out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnotSums(pub [[f32; 4]; 4]);

impl KnotSums {
    fn add(&mut self, weight: f32, other: &Self) {
        for (sum, other) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *sum += weight * other;
        }
    }
}

/// Red, green, blue and coverage of sharing samples before and after they share and are scaled by their gains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SharedSums(pub [Light; 2]);

impl SharedSums {
    /// Sums that take turns, a pixel each: none waits for the one before.
    pub const TURNS: usize = 2;

    #[inline(always)]
    pub fn add(&mut self, before: &Light, after: &Light) {
        for c in 0..4 {
            self.0[0][c] += before[c];
            self.0[1][c] += after[c];
        }
    }

    /// The sum of those of all turns.
    #[inline(always)]
    pub fn of_turns([mut sum, odd]: [Self; Self::TURNS]) -> Self {
        let [before, after] = &odd.0;
        sum.add(before, after);
        sum
    }
}

/// The knots of a picture, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knots {
    size: [usize; 2],
}

/// A pixel's place among knots: the one before it, and the weight of the one behind.
#[inline(always)]
const fn place(pixel: usize) -> (usize, f32) {
    (pixel / SPACING, ((pixel % SPACING) as f32 + 0.5) / SPACING as f32)
}

impl Knots {
    /// Of a picture of this width and height, px.
    pub fn new(size: [usize; 2]) -> Self {
        Self { size }
    }

    /// How many there are in a row.
    pub fn columns(&self) -> usize {
        self.size[0].div_ceil(SPACING) + 1
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.size[1].div_ceil(SPACING) + 1
    }

    /// How many spans of [`SPACING`] pixels a row of pixels has.
    pub fn spans(&self) -> usize {
        self.columns() - 1
    }

    /// Sums a whole row of pixels: a sum for each column of knots. Those of the picture, beside those of what shares, only if
    /// asked for.
    pub fn sum_row(&self, parts: Parts<'_>, shares: &[Share], sums: &mut [KnotSums], has_picture: bool) {
        if has_picture {
            with_widest_instructions(
                #[inline(always)]
                || sum_pixels::<true>(parts, shares, sums),
            );
        } else {
            with_widest_instructions(
                #[inline(always)]
                || sum_pixels::<false>(parts, shares, sums),
            );
        }
    }

    /// The sums of knots from those of all rows of pixels.
    pub fn sums(&self, rows: &[KnotSums]) -> Vec<KnotSums> {
        let columns = self.columns();
        let sum = |knot: usize| {
            let (row, column) = (knot / columns, knot % columns);
            let mut sum = KnotSums::default();
            for y in (row.max(1) - 1) * SPACING..((row + 1) * SPACING).min(self.size[1]) {
                let (before, behind) = place(y);
                sum.add(if before == row { 1.0 - behind } else { behind }, &rows[y * columns + column]);
            }
            sum
        };
        (0..columns * self.rows()).into_par_iter().map(sum).collect()
    }

    /// The sums of cells of [`SPACING`] rows from those of the spans of all rows of pixels.
    pub fn cells(&self, spans: &[SharedSums]) -> Vec<SharedSums> {
        let of_rows = spans.chunks(SPACING * self.spans());
        let cell = |rows: &[SharedSums], span: usize| {
            let mut sum = SharedSums::default();
            rows[span..]
                .iter()
                .step_by(self.spans())
                .for_each(|SharedSums([before, after])| sum.add(before, after));
            sum
        };
        of_rows.flat_map(|rows| (0..self.spans()).map(move |span| cell(rows, span))).collect()
    }
}

/// Some light of the pixels of a span.
#[derive(Clone, Copy, Default)]
struct SpanSum {
    sum: Vec4,
    /// The sum of all sums so far: a pixel is in it as often as there are pixels from it to the span's end.
    ramp: Vec4,
}

impl SpanSum {
    #[inline(always)]
    fn add(&mut self, light: Vec4) {
        self.sum += light;
        self.ramp += self.sum;
    }

    /// Weighted by the tents of the knot before the span and of the one behind it, if that many pixels were added.
    fn of_ends(mut self, count: usize) -> [Vec4; 2] {
        (count..SPACING).for_each(|_| self.add(Vec4::ZERO));
        let before = (self.ramp - 0.5 * self.sum) / SPACING as f32;
        [before, self.sum - before]
    }
}

#[inline(always)]
fn sum_pixels<const HAS_PICTURE: bool>(parts: Parts<'_>, shares: &[Share], sums: &mut [KnotSums]) {
    let lights = parts.free.chunks(SPACING).zip(parts.sharing.chunks(SPACING));
    let mut of_knot = [Vec4::ZERO; 4];
    for (((free, sharing), shares), sum) in lights.zip(shares.chunks(SPACING)).zip(&mut *sums) {
        let [mut before, mut after, mut picture, mut evened] = [SpanSum::default(); 4];
        for ((free, sharing), share) in free.iter().zip(sharing).zip(shares) {
            let (free, sharing) = (Vec4::from_array(*free), Vec4::from_array(*sharing));
            let shared = share.partial * sharing;
            before.add(sharing);
            after.add(shared);
            if HAS_PICTURE {
                picture.add(free + sharing);
                evened.add(share.even * (free + shared));
            }
        }
        let ends = [before, after, picture, evened].map(|sum| sum.of_ends(free.len()));
        for ((sum, of_knot), [before, behind]) in sum.0.iter_mut().zip(&mut of_knot).zip(ends) {
            *sum = (*of_knot + before).to_array();
            *of_knot = behind;
        }
    }
    if let Some(last) = sums.last_mut() {
        last.0 = of_knot.map(|sum| sum.to_array());
    }
}

/// The gains of a picture, and room to find them.
pub struct Balance {
    pub knots: Knots,
    pub gains: Gains,
    /// What all light that shares is scaled by beside its gains.
    pub rest: [f32; 3],
    /// What each row of pixels brings to each column of knots.
    pub rows: Vec<KnotSums>,
    /// What shares in each span of each row of pixels.
    pub shared: Vec<SharedSums>,
}

impl Balance {
    /// Of a picture of this width and height, px, of which nothing is known.
    pub fn none(size: [usize; 2]) -> Self {
        let knots = Knots::new(size);
        let rows = vec![KnotSums::default(); size[1] * knots.columns()];
        let shared = vec![SharedSums::default(); size[1] * knots.spans()];
        Self { gains: Gains::none(knots), knots, rest: NO_REST, rows, shared }
    }

    /// Forgets the gains.
    pub fn forget(&mut self) {
        self.gains = Gains::none(self.knots);
    }

    /// Finds the gains from the rows, of a standard picture.
    pub fn settle(&mut self) {
        self.gains = Gains::of(self.knots, &self.knots.sums(&self.rows));
    }

    /// Finds what is left to give back in a painted picture, from its spans.
    pub fn find_rest(&mut self) {
        self.rest = rest(&self.knots.cells(&self.shared));
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        let rows = size_of_val(self.rows.as_slice()) + size_of_val(self.shared.as_slice());
        rows + size_of_val(self.gains.of_knots.as_slice())
    }
}

/// No gain of light that shares is larger.
const LARGEST_RATIO: f64 = 1.05;

/// What each knot scales light by.
#[derive(Clone, Debug, PartialEq)]
pub struct Gains {
    knots: Knots,
    /// Of each knot, by [`Scaled`].
    of_knots: Vec<[[f32; 3]; 2]>,
}

impl Gains {
    /// Those of a picture of which nothing is known: 1.
    pub fn none(knots: Knots) -> Self {
        Self { of_knots: vec![[[1.0; 3]; 2]; knots.columns() * knots.rows()], knots }
    }

    /// Those that give back what the sums of all knots say was taken.
    ///
    /// r_k stays within 5 % of 1: a knot may have next to no light, or a lamp that outshines all about it. A light field that
    /// covers the picture by 0.1 % too little or too much or more has holes or surfaces twice: what evening mends of that
    /// is not given back, but all that it takes up to 0.05 %. G stays within 1 % of 1. So what is white stays white to 0.05 %.
    pub fn of(knots: Knots, sums: &[KnotSums]) -> Self {
        const RIPPLE: f64 = 5e-4;
        let mut of_knots = vec![[[1.0; 3]; 2]; sums.len()];
        for (kind, c) in
            [Scaled::Sharing, Scaled::All].into_iter().flat_map(|kind| (0..3).map(move |c| (kind, c)))
        {
            let kind = kind as usize;
            let of = |sums: &KnotSums, c: usize| {
                (f64::from(sums.0[2 * kind][c]), f64::from(sums.0[2 * kind + 1][c]))
            };
            let ratio = |sums: &KnotSums| {
                let ((before, after), (covered, evened)) = (of(sums, c), of(sums, 3));
                within(LARGEST_RATIO, before * evened / (after * covered))
            };
            let [before, after, covered, evened] = sums.iter().fold([0.0; 4], |all, sums| {
                let ((before, after), (covered, evened)) = (of(sums, c), of(sums, 3));
                [all[0] + before, all[1] + ratio(sums) * after, all[2] + covered, all[3] + evened]
            });
            let (light, coverage) = (before / after, covered / evened);
            // All of a ripple is given back, none of a fault.
            let excess = coverage - 1.0;
            let given_back = excess * (2.0 - excess.abs() / RIPPLE).clamp(0.0, 1.0);
            let gain = within(1.01, light / coverage * (1.0 + given_back));
            for (knot, sums) in of_knots.iter_mut().zip(sums) {
                knot[kind][c] = (gain * ratio(sums)) as f32;
            }
        }
        Self { knots, of_knots }
    }

    /// Scales a picture that is evened out.
    pub fn scale(&self, radiance: &mut [[f32; 3]]) {
        let width = self.knots.size[0];
        radiance.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            let gains = self.of_row(y, Scaled::All);
            with_widest_instructions(
                #[inline(always)]
                || gains.scale(row),
            );
        });
    }

    /// Those of knots, row by row, by [`Scaled`].
    pub fn of_knots(&self) -> &[[[f32; 3]; 2]] {
        &self.of_knots
    }

    /// Those of a row of pixels, at each column of knots.
    pub fn of_row(&self, y: usize, scaled: Scaled) -> GainsOfRow {
        let ((row, behind), columns) = (place(y), self.knots.columns());
        let of_knot = |knot: &[[f32; 3]; 2]| {
            let [r, g, b] = knot[scaled as usize];
            [r, g, b, 1.0]
        };
        let of_row = |row: usize| self.of_knots[row * columns..][..columns].iter().map(of_knot);
        GainsOfRow(of_row(row).zip(of_row(row + 1)).map(|(a, b)| mix(a, b, behind)).collect())
    }
}

/// Where nothing is left to give back.
pub const NO_REST: [f32; 3] = [1.0; 3];

/// What is left to give back to the light that shares in a painted picture, whose sums those of all cells are: within 5 % of
/// none.
pub fn rest(cells: &[SharedSums]) -> [f32; 3] {
    let sum = |kind: usize, c: usize| cells.iter().map(|sums| f64::from(sums.0[kind][c])).sum::<f64>();
    [0, 1, 2].map(|c| within(LARGEST_RATIO, sum(0, c) / sum(1, c)) as f32)
}

/// A gain, at most `largest` and at least as much less than 1; 1 where there is no light.
fn within(largest: f64, gain: f64) -> f64 {
    if gain.is_finite() { gain.clamp(1.0 / largest, largest) } else { 1.0 }
}

/// Gains of a row of pixels, at each column of knots: of red, green, blue and, always 1, coverage.
pub struct GainsOfRow(Vec<[f32; 4]>);

impl GainsOfRow {
    /// Those of a pixel.
    #[inline(always)]
    pub fn at(&self, x: usize) -> [f32; 4] {
        let (knot, behind) = place(x);
        mix(self.0[knot], self.0[knot + 1], behind)
    }

    /// Scales the pixels of a row: each as [`Self::at`] says, several at a time.
    #[inline(always)]
    fn scale(&self, row: &mut [[f32; 3]]) {
        /// Colours of so many pixels fill whole registers.
        const GROUP: usize = 8;
        let group = |[r, g, b, _]: [f32; 4]| [[r, g, b]; GROUP];
        for (knot, span) in row.chunks_mut(SPACING).enumerate() {
            let (before, after) = (group(self.0[knot]), group(self.0[knot + 1]));
            for (pixels, behind) in span.chunks_mut(GROUP).zip(BEHIND.chunks(GROUP)) {
                let gains = before.as_flattened().iter().zip(after.as_flattened());
                let behind = behind.as_flattened();
                for ((light, behind), (before, after)) in
                    pixels.as_flattened_mut().iter_mut().zip(behind).zip(gains)
                {
                    *light *= between(*before, *after, *behind);
                }
            }
        }
    }
}

/// The weight of the knot behind a span's pixels, for each colour.
const BEHIND: [[f32; 3]; SPACING] = {
    let mut weights = [[0.0; 3]; SPACING];
    let mut x = 0;
    while x < SPACING {
        weights[x] = [place(x).1; 3];
        x += 1;
    }
    weights
};

/// What a and b are where the second has the weight `behind`.
#[inline(always)]
fn between(a: f32, b: f32, behind: f32) -> f32 {
    (1.0 - behind) * a + behind * b
}

#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], behind: f32) -> [f32; 4] {
    let mut mixed = [0.0; 4];
    for c in 0..4 {
        mixed[c] = between(a[c], b[c], behind);
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [150, 90];

    /// A small red thing, half hidden, that sharing takes light from, before a grey wall that gets it.
    fn picture() -> Vec<([f32; 4], [f32; 4])> {
        let pixel = |k: usize| {
            let (x, y) = (k % SIZE[0], k / SIZE[0]);
            let ripple = 1.0 + 0.01 * (x as f32 * 0.7).sin() * (y as f32 * 0.3).cos();
            // What sharing samples see is known to cells alone: too much here, too little there.
            let (open, excess) =
                (if x < 70 { 0.6 } else { 0.3 } * ripple, if x / 5 % 2 == 0 { 1.3 } else { 0.7 });
            let red = if x.abs_diff(42) < 3 && y.abs_diff(40) < 7 { 0.5 } else { 0.0 };
            let light =
                |covered: f32, red: f32| [covered * (0.3 + red), covered * 0.3, covered * 0.3, covered];
            (light(open, 0.0), light((1.0 - open) * excess, red))
        };
        (0..SIZE[0] * SIZE[1]).map(pixel).collect()
    }

    fn shares(picture: &[([f32; 4], [f32; 4])]) -> Vec<Share> {
        picture.iter().map(|(free, sharing)| Share::of(free[3], sharing[3])).collect()
    }

    fn gains(picture: &[([f32; 4], [f32; 4])], shares: &[Share]) -> Gains {
        let knots = Knots::new(SIZE);
        let mut rows = vec![KnotSums::default(); SIZE[1] * knots.columns()];
        let lines = picture.chunks(SIZE[0]).zip(shares.chunks(SIZE[0]));
        for ((pixels, shares), sums) in lines.zip(rows.chunks_mut(knots.columns())) {
            let [free, sharing] = [|p: &([f32; 4], [f32; 4])| p.0, |p: &([f32; 4], [f32; 4])| p.1]
                .map(|of| pixels.iter().map(of).collect::<Vec<_>>());
            knots.sum_row(Parts { free: &free, sharing: &sharing }, shares, sums, true);
        }
        Gains::of(knots, &knots.sums(&rows))
    }

    /// The sum of a colour: before, and after with gains and without, of sharing light and of all.
    fn sums(picture: &[([f32; 4], [f32; 4])], shares: &[Share], gains: &Gains, c: usize) -> [[f64; 3]; 2] {
        let mut sums = [[0.0; 3]; 2];
        for (k, ((free, sharing), share)) in picture.iter().zip(shares).enumerate() {
            let (x, y) = (k % SIZE[0], k / SIZE[0]);
            let [own, all] =
                [Scaled::Sharing, Scaled::All].map(|scaled| f64::from(gains.of_row(y, scaled).at(x)[c]));
            let shared = f64::from(share.partial * sharing[c]);
            let evened = f64::from(share.even) * (f64::from(free[c]) + shared);
            let of_pixel = [
                [f64::from(sharing[c]), own * shared, shared],
                [f64::from(free[c] + sharing[c]), all * evened, evened],
            ];
            (0..2).for_each(|kind| (0..3).for_each(|k| sums[kind][k] += of_pixel[kind][k]));
        }
        sums
    }

    #[test]
    fn the_sum_is_what_it_was() {
        let picture = picture();
        let shares = shares(&picture);
        let gains = gains(&picture, &shares);
        for c in 0..3 {
            for [before, after, without] in sums(&picture, &shares, &gains, c) {
                assert!((after / before - 1.0).abs() < 1e-6, "{c}: {before} {after}");
                assert!(c > 0 || (without / before - 1.0).abs() > 5e-4, "the control: {before} {without}");
            }
        }
    }

    /// A highlight anywhere in a row, at a knot or between two, at the row's end too, is weighted as if it were alone.
    #[test]
    fn rows_are_weighted_by_tents() {
        const WIDTH: usize = 75;
        let knots = Knots::new([WIDTH, 1]);
        let share = Share { partial: 0.5, even: 0.25 };
        for highlight in 0..WIDTH {
            let light = |x: usize| if x == highlight { [1e6; 4] } else { [1e-3; 4] };
            let lights: Vec<_> = (0..WIDTH).map(light).collect();
            let mut sums = vec![KnotSums::default(); knots.columns()];
            knots.sum_row(Parts { free: &lights, sharing: &lights }, &[share; WIDTH], &mut sums, true);
            for (knot, sums) in sums.iter().enumerate() {
                let tent = |x: usize| 1.0 - (knot as f64 - (x as f64 + 0.5) / SPACING as f64).abs();
                let sum = (0..WIDTH).map(|x| tent(x).max(0.0) * f64::from(light(x)[0])).sum::<f64>();
                for (of_kind, factor) in sums.0.iter().zip([1.0, 0.5, 2.0, 0.375]) {
                    let ratio = f64::from(of_kind[0]) / (factor * sum);
                    assert!((ratio - 1.0).abs() < 1e-5, "{highlight} {knot}: {ratio}");
                }
            }
        }
    }

    #[test]
    fn what_is_white_stays_uniform() {
        let white: Vec<_> = picture().iter().map(|(free, sharing)| ([free[3]; 4], [sharing[3]; 4])).collect();
        let gains = gains(&white, &shares(&white));
        let first = gains.of_knots[0];
        for knot in &gains.of_knots {
            (0..2).for_each(|kind| {
                (0..3).for_each(|c| {
                    assert!((knot[kind][c] / first[kind][c] - 1.0).abs() < 1e-5, "{knot:?} {first:?}")
                })
            });
        }
    }

    #[test]
    fn nothing_is_given_to_black_pictures() {
        let black = vec![([0.0; 4], [0.0; 4]); SIZE[0] * SIZE[1]];
        assert_eq!(gains(&black, &shares(&black)), Gains::none(Knots::new(SIZE)));
    }
}
