//! What sharing and evening take away is given back nearby.
//!
//! That partly occluded samples share what open ones leave, and that the standard picture's coverage is evened out (see
//! [`crate::resolve::partition`]), makes each pixel's coverage right, but moves light: what a small card that is hidden in part
//! loses, the wall beside it gets. So light is scaled, colour by colour, by gains g that vary slowly over the picture,
//!
//! ```text
//! g(q) = G·Σ_k b_k(q)·r_k,     r_k = (⟨b_k, before⟩/⟨b_k, after⟩) / (the same of coverage)
//! ```
//!
//! b_k the tents of knots [`SPACING`] apart (`knots`), which sum to 1; "before" and "after" the light of the standard picture before
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

use crate::resolve::knots::{KnotSums, Knots, SPACING, SharedSums, position};
use numerics::with_widest_simd;
use rayon::prelude::*;

/// Which light is scaled: that of the sharing samples, where the picture is not evened out; else all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaled {
    /// The light of sharing samples.
    Sharing = 0,
    /// All light.
    All = 1,
}

/// The gains of a picture, and room to find them.
pub struct Balance {
    /// Where the gains are.
    pub knots: Knots,
    /// The gains.
    pub gains: Gains,
    /// What all light that shares is scaled by beside its gains.
    pub rest: [f32; 3],
    /// The contribution of each row of pixels to each column of knots.
    pub rows: Vec<KnotSums>,
    /// What shares in each span of each row of pixels.
    pub shared: Vec<SharedSums>,
}

impl Balance {
    /// Gains of 1, for a picture of `size` columns and rows.
    pub fn neutral(size: [usize; 2]) -> Self {
        let knots = Knots::new(size);
        let rows = vec![KnotSums::default(); size[1] * knots.columns()];
        let shared = vec![SharedSums::default(); size[1] * knots.spans()];
        Self { gains: Gains::neutral(knots), knots, rest: NO_REST, rows, shared }
    }

    /// Forgets the gains: all are 1 again.
    pub fn reset(&mut self) {
        self.gains = Gains::neutral(self.knots);
    }

    /// Finds the gains from the rows, of a standard picture.
    pub fn find_gains(&mut self) {
        self.gains = Gains::from_sums(self.knots, &self.knots.sums(&self.rows));
    }

    /// Finds what is left to give back in a painted picture, from its spans.
    pub fn find_rest(&mut self) {
        self.rest = rest(&self.knots.cells(&self.shared));
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let rows = size_of_val(self.rows.as_slice()) + size_of_val(self.shared.as_slice());
        rows + size_of_val(self.gains.knot_gains.as_slice())
    }
}

/// No gain of light that shares is larger.
const LARGEST_RATIO: f64 = 1.05;

/// What each knot scales light by.
#[derive(Clone, Debug, PartialEq)]
pub struct Gains {
    knots: Knots,
    /// Of each knot, by [`Scaled`].
    knot_gains: Vec<[[f32; 3]; 2]>,
}

impl Gains {
    /// Gains of 1 at all knots.
    pub fn neutral(knots: Knots) -> Self {
        Self { knot_gains: vec![[[1.0; 3]; 2]; knots.columns() * knots.rows()], knots }
    }

    /// Gains that return the light which, by the sums of all knots, was taken.
    ///
    /// r_k stays within 5 % of 1: a knot may have next to no light, or a lamp that outshines all about it. A light field that
    /// covers the picture by 0.1 % too little or too much or more has holes or surfaces twice: what evening mends of that
    /// is not given back, but all that it takes up to 0.05 %. G stays within 1 % of 1. So what is white stays white to 0.05 %.
    pub fn from_sums(knots: Knots, sums: &[KnotSums]) -> Self {
        const RIPPLE: f64 = 5e-4;
        let mut knot_gains = vec![[[1.0; 3]; 2]; sums.len()];
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
            let returned = excess * (2.0 - excess.abs() / RIPPLE).clamp(0.0, 1.0);
            let gain = within(1.01, light / coverage * (1.0 + returned));
            for (knot, sums) in knot_gains.iter_mut().zip(sums) {
                knot[kind][c] = (gain * ratio(sums)) as f32;
            }
        }
        Self { knots, knot_gains }
    }

    /// Scales the linear RGB of a picture, evened out before, by the gains, in place.
    pub fn scale(&self, radiance: &mut [[f32; 3]]) {
        let width = self.knots.size[0];
        radiance.par_chunks_mut(width).enumerate().for_each(|(y, row)| self.scale_row(y, row));
    }

    /// Scales the linear RGB of row `y` of such a picture, in place.
    pub fn scale_row(&self, y: usize, row: &mut [[f32; 3]]) {
        let gains = self.row_gains(y, Scaled::All);
        with_widest_simd(
            #[inline(always)]
            || gains.scale(row),
        );
    }

    /// The gains at the knots, row by row; for each by [`Scaled`], per colour.
    pub fn knot_gains(&self) -> &[[[f32; 3]; 2]] {
        &self.knot_gains
    }

    /// The gains along row `y` of pixels, at each column of knots.
    pub fn row_gains(&self, y: usize, scaled: Scaled) -> RowGains {
        let ((row, behind), columns) = (position(y), self.knots.columns());
        let of_knot = |knot: &[[f32; 3]; 2]| {
            let [r, g, b] = knot[scaled as usize];
            [r, g, b, 1.0]
        };
        let of_row = |row: usize| self.knot_gains[row * columns..][..columns].iter().map(of_knot);
        RowGains(of_row(row).zip(of_row(row + 1)).map(|(a, b)| mix(a, b, behind)).collect())
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
pub struct RowGains(Vec<[f32; 4]>);

impl RowGains {
    /// The gains of the pixel in column `x`, interpolated between knots; coverage has 1.
    #[inline(always)]
    pub fn at(&self, x: usize) -> [f32; 4] {
        let (knot, behind) = position(x);
        mix(self.0[knot], self.0[knot + 1], behind)
    }

    /// Scales the pixels of a row: the same as [`Self::at`], several at a time.
    #[inline(always)]
    fn scale(&self, row: &mut [[f32; 3]]) {
        /// The colours of this many pixels fill whole registers.
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
        weights[x] = [position(x).1; 3];
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
    use crate::resolve::partition::{Parts, Share};

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
        picture.iter().map(|(free, sharing)| Share::new(free[3], sharing[3])).collect()
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
        Gains::from_sums(knots, &knots.sums(&rows))
    }

    /// The sum of a colour: before, and after with gains and without, of sharing light and of all.
    fn sums(picture: &[([f32; 4], [f32; 4])], shares: &[Share], gains: &Gains, c: usize) -> [[f64; 3]; 2] {
        let mut sums = [[0.0; 3]; 2];
        for (k, ((free, sharing), share)) in picture.iter().zip(shares).enumerate() {
            let (x, y) = (k % SIZE[0], k / SIZE[0]);
            let [own, all] =
                [Scaled::Sharing, Scaled::All].map(|scaled| f64::from(gains.row_gains(y, scaled).at(x)[c]));
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

    #[test]
    fn what_is_white_stays_uniform() {
        let white: Vec<_> = picture().iter().map(|(free, sharing)| ([free[3]; 4], [sharing[3]; 4])).collect();
        let gains = gains(&white, &shares(&white));
        let first = gains.knot_gains[0];
        for knot in &gains.knot_gains {
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
        assert_eq!(gains(&black, &shares(&black)), Gains::neutral(Knots::new(SIZE)));
    }
}
