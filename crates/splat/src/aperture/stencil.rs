//! Stencils: the aperture's image at every radius, cut to pixel rows once and used by all splats of that radius.
//!
//! A stencil's run says: in this pixel row, from here to there, this much light a quantum. Positions are in 1/4096 px from
//! the splat's centre, so that a splat costs a few integer operations a row. Radii are tabled by their squares, in steps of
//! 1/256 of themselves, the centre's height in 32nds of a pixel or, of large ones, more coarsely.

use crate::aperture::shape::{Part, Shape};
use crate::canvas::{PIXEL, POSITION_BITS};
use glam::DVec4;
use lens::Run;
use progress::Progress;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Bits behind the point of the height of a splat of one pixel.
pub const HEIGHT_BITS: u32 = 24;

/// Stencils are made up to this radius, px.
pub const LARGEST_RADIUS_PX: i32 = 64;

/// Heights of the centre within a pixel, at most: 2 to this.
pub const PHASE_BITS: u32 = 5;

/// Light in one pixel row.
#[derive(Clone, Copy, Debug)]
pub struct StencilRun {
    /// The pixel row, from that of the centre.
    pub row: i32,
    /// From where, in 1/4096 px from the centre.
    pub start: i32,
    /// To where.
    pub end: i32,
    /// What a pixel within it gets of the splat's light, times 2 to [`Stencil::height_bits`].
    pub height: u32,
    /// The aperture's v at the row's middle, times 2¹⁴.
    pub v: i32,
}

/// The aperture's image at one radius and one height within the pixel.
#[derive(Clone, Debug)]
pub struct Stencil {
    /// From the uppermost pixel row down.
    pub runs: Box<[StencilRun]>,
    /// Bits behind the point of the heights: the larger the image, the more.
    pub height_bits: u32,
}

/// All stencils of an aperture, made when they are first used.
pub struct Stencils {
    /// The shape that they are cut from.
    pub shape: Shape,
    /// Its parts, few and many.
    pub parts: [Vec<Part>; 2],
    /// Far (upright) radii, then near ones; of each the heights.
    table: Vec<OnceLock<Box<[Stencil]>>>,
}

/// The stencils of one signed radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The place's index in the table, below [`Stencils::PLACES`].
    pub index: usize,
    /// They are cut at 2 to this heights of the centre within a pixel.
    phase_bits: u32,
}

impl Place {
    /// That of a radius, whose half of the table begins at `half`.
    #[inline(always)]
    fn from_index(index: usize, half: usize) -> Self {
        let [coarser, coarsest] = [COARSER[0], COARSER[1]].map(|first| u32::from(index >= first));
        Self { index: half + index, phase_bits: PHASE_BITS - coarser - coarsest }
    }

    /// The place with this index below [`Stencils::PLACES`].
    pub fn from_table_index(index: usize) -> Self {
        let half = if index < Stencils::PLACES / 2 { 0 } else { Stencils::PLACES / 2 };
        Self::from_index(index - half, half)
    }

    /// The height of a stencil of the place, and the pixel row, of a centre at `y` (1/4096 px).
    #[inline(always)]
    fn phase(self, y: i32) -> (usize, i32) {
        let bits = POSITION_BITS - self.phase_bits;
        let rounded = y + (1 << bits) / 2;
        (((rounded & (PIXEL - 1)) >> bits) as usize, rounded >> POSITION_BITS)
    }

    /// Half the step between heights of the place's stencils, in 1/4096 px.
    pub fn half_step(self) -> u32 {
        1 << (POSITION_BITS - self.phase_bits - 1)
    }

    /// A number for the place's stencil of this phase; no other stencil has it.
    pub fn with_phase(self, phase: usize) -> u32 {
        ((self.index << PHASE_BITS) + phase) as u32
    }
}

/// The size of a stencil: its radius squared and whether it is turned (of a negative radius).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StencilSize {
    /// (1/64 px)².
    square: u32,
    is_turned: bool,
}

/// Bits behind the point of the radii whose squares are tabled.
pub const RADIUS_BITS: u32 = 6;

/// Bits of the tabled squares below the leading one.
pub const MANTISSA_BITS: u32 = 7;

impl StencilSize {
    /// The signed radius of the aperture on a stencil of this size, 1/4096 px.
    pub fn radius(self) -> i32 {
        let size = (f64::from(self.square).sqrt() * f64::from(1 << (POSITION_BITS - RADIUS_BITS))) as i32;
        if self.is_turned { -size } else { size }
    }

    /// Of a radius squared, (1/4096 px)²; less than 0 counts as 0. `None` if it is too large for a stencil.
    #[inline(always)]
    pub fn from_radius_square(square: i64, is_turned: bool) -> Option<Self> {
        const LARGEST: i64 = (LARGEST_RADIUS_PX as i64 * PIXEL as i64).pow(2);
        let square_64 = square.max(0) >> (2 * (POSITION_BITS - RADIUS_BITS));
        (square <= LARGEST).then_some(Self { square: square_64 as u32, is_turned })
    }
}

/// The place of a squared radius, (1/64 px)², in the table: a float of a few bits, rounded.
#[inline(always)]
const fn index_of(square: u32) -> usize {
    let octave = (square | 1).ilog2().saturating_sub(MANTISSA_BITS);
    let steps = (square + (1 << octave) / 2) >> octave;
    // Rounding up to the next octave is its first place.
    ((octave << MANTISSA_BITS) + steps) as usize
}

/// From these places on, 8 and 24 px, stencils are cut at half as many heights each.
pub const COARSER: [usize; 2] =
    [index_of((8 * 8) << (2 * RADIUS_BITS)), index_of((24 * 24) << (2 * RADIUS_BITS))];

/// The radius, px, that a place of the table represents.
fn radius_at(index: usize) -> f64 {
    let one = 1usize << MANTISSA_BITS;
    let (octave, mantissa) = if index < 2 * one { (0, index) } else { (index / one - 1, index % one + one) };
    (mantissa as f64 * (1u64 << octave) as f64).sqrt() / (1 << RADIUS_BITS) as f64
}

impl Stencils {
    /// Places of the table.
    pub const PLACES: usize = 2 * (index_of((LARGEST_RADIUS_PX as u32).pow(2) << (2 * RADIUS_BITS)) + 1);
    /// Stencils of a place, at most.
    pub const PHASES: usize = 1 << PHASE_BITS;

    /// The stencils of a shape; each is cut when it is first used.
    pub fn new(shape: Shape) -> Self {
        let parts = [2, 4].map(|side| shape.parts(side));
        Self { shape, parts, table: (0..Self::PLACES).map(|_| OnceLock::new()).collect() }
    }

    /// Cuts the stencils of all places now; stops early if `progress` asks to.
    pub fn cut_all(&self, progress: &dyn Progress) {
        (0..Self::PLACES).into_par_iter().filter(|_| !progress.cancelled()).for_each(|index| {
            self.at_place(Place::from_table_index(index));
        });
    }

    /// The stencil of a size for a centre at the height `y` (1/4096 px), and the pixel row of that centre.
    #[inline(always)]
    pub fn stencil_at(&self, size: StencilSize, y: i32) -> (&Stencil, i32) {
        let (place, phase, row) = self.place(size, y);
        (&self.at_place(place)[phase], row)
    }

    /// Where [`Self::stencil_at`] looks in the table: place, phase, and the pixel row of the centre.
    #[inline(always)]
    pub fn place(&self, size: StencilSize, y: i32) -> (Place, usize, i32) {
        let turned = if size.is_turned { Self::PLACES / 2 } else { 0 };
        let place = Place::from_index(index_of(size.square), turned);
        let (phase, row) = place.phase(y);
        (place, phase, row)
    }

    /// The stencils of a place, one for each phase; cut on first use.
    #[inline(always)]
    pub fn at_place(&self, place: Place) -> &[Stencil] {
        self.table[place.index].get_or_init(|| {
            let half = Self::PLACES / 2;
            let radius_px =
                if place.index < half { radius_at(place.index) } else { -radius_at(place.index - half) };
            let count = 1 << place.phase_bits;
            (0..count).map(|phase| self.cut(radius_px, phase as f64 / count as f64)).collect()
        })
    }

    /// Cuts the shape to pixel rows: `radius_px` signed, the centre at `phase` of its pixel.
    fn cut(&self, radius_px: f64, phase: f64) -> Stencil {
        let area_px = (self.shape.open_area * radius_px * radius_px).max(1.0);
        let height_bits = HEIGHT_BITS + area_px.log2() as u32;
        let size = radius_px.abs();
        let mut runs = Vec::new();
        for row in (phase - size).floor() as i32..=(phase + size).floor() as i32 {
            // The heights of its edges in the aperture; v goes up, pixel rows go down.
            let v_at = |y: f64| if size > 0.0 { (phase - y) / radius_px } else { (phase - y).signum() };
            let [a, b] = [v_at(row.into()), v_at((row + 1).into())];
            let between = [a.min(b), a.max(b)];
            let Some(whole) = WeightedRun::from_moments(self.shape.moments(between), radius_px) else {
                continue;
            };
            let mut add = |run: &WeightedRun| runs.extend(run.quantised(row, height_bits));
            if self.shape.is_picture {
                let parts = self.shape.runs_between(between);
                let parts: Vec<_> = parts.map(|(run, light)| whole.part(run, radius_px, light)).collect();
                whole.binned(&parts, size).iter().for_each(add);
            } else {
                add(&whole);
            }
        }
        Stencil { runs: runs.into(), height_bits }
    }
}

/// A run in px, with its share of the splat's light.
#[derive(Clone, Copy)]
struct WeightedRun {
    start: f64,
    end: f64,
    light: f64,
    v: f64,
}

/// Narrower runs, px, are widened: light between two pixels' edges has no height to give.
const NARROWEST_PX: f64 = 1.0 / 16.0;

impl WeightedRun {
    /// One run with the light, mean and variance of these moments (see [`Shape::moments`]). `None` without light.
    fn from_moments(moments: DVec4, radius_px: f64) -> Option<Self> {
        let [light, u, u_squared, v] = moments.to_array();
        if light <= 0.0 {
            return None;
        }
        let mean = u / light;
        let half = (3.0 * (u_squared / light - mean * mean)).max(0.0).sqrt() * radius_px.abs();
        let middle = mean * radius_px;
        Some(Self { start: middle - half, end: middle + half, light, v: v / light })
    }

    /// One of the runs that it is the mean of.
    fn part(&self, run: &Run, radius_px: f64, light: f64) -> Self {
        let [a, b] = [run.start * radius_px, run.end * radius_px];
        Self { start: a.min(b), end: a.max(b), light, v: self.v }
    }

    /// The light of `runs`, whose mean it is and which lie within `size` of the centre, in runs that do not overlap: bins of
    /// half a pixel, like neighbours joined, moved so that they have that mean.
    fn binned(&self, runs: &[Self], size: f64) -> Vec<Self> {
        const BINS_A_PX: f64 = 2.0;
        const ALIKE: f64 = 1e-3;
        let mut bins = vec![0.0; (2.0 * size * BINS_A_PX).ceil() as usize + 1];
        for run in runs {
            let [start, end] = [run.start, run.end].map(|x| (x + size) * BINS_A_PX);
            let density = run.light / (end - start).max(1e-9);
            for (bin, light) in bins.iter_mut().enumerate().skip(start.max(0.0) as usize) {
                let overlap = end.min(bin as f64 + 1.0) - start.max(bin as f64);
                if overlap <= 0.0 {
                    break;
                }
                *light += density * overlap;
            }
        }
        let x_of = |bin: usize| bin as f64 / BINS_A_PX - size;
        let mut binned: Vec<Self> = Vec::new();
        let mut bin = 0;
        while bin < bins.len() {
            let alike =
                bins[bin..].iter().take_while(|&&light| (light - bins[bin]).abs() <= ALIKE * bins[bin]);
            let count = alike.count();
            if bins[bin] > 0.0 {
                let light = bins[bin..bin + count].iter().sum();
                binned.push(Self { start: x_of(bin), end: x_of(bin + count), light, v: self.v });
            }
            bin += count;
        }
        let middle = |run: &Self| (run.start + run.end) / 2.0;
        let binned_mean: f64 = binned.iter().map(|run| run.light * middle(run)).sum::<f64>() / self.light;
        let shift = middle(self) - binned_mean;
        binned.into_iter().map(|run| Self { start: run.start + shift, end: run.end + shift, ..run }).collect()
    }

    fn quantised(&self, row: i32, height_bits: u32) -> Option<StencilRun> {
        let middle = (self.start + self.end) / 2.0;
        let half = ((self.end - self.start) / 2.0).max(NARROWEST_PX / 2.0);
        let [start, end] = [middle - half, middle + half].map(|x| (x * PIXEL as f64).round() as i32);
        let height = self.light / (end - start) as f64 * PIXEL as f64 * (1u64 << height_bits) as f64;
        let v = (self.v * 16384.0).round() as i32;
        let height = height.round() as u32;
        (height > 0).then_some(StencilRun { row, start, end, height, v })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::{ApertureMask, ApertureShape};
    use std::sync::Arc;

    #[test]
    fn places_of_the_table_invert() {
        for index in 0..Stencils::PLACES / 2 {
            let square = (radius_at(index) * 64.0).powi(2);
            assert_eq!(index_of(square.round() as u32), index, "{square}");
        }
        for radius in 1..1i64 << 12 {
            let size = StencilSize::from_radius_square((64 * radius).pow(2), false).expect("it is small");
            let apart = (radius_at(index_of(size.square)) * 64.0 - radius as f64).abs();
            assert!(apart <= radius as f64 / 511.0);
        }
        let largest = (LARGEST_RADIUS_PX as i64 * PIXEL as i64).pow(2);
        assert!(
            StencilSize::from_radius_square(largest, true).is_some()
                && StencilSize::from_radius_square(largest + 1, true).is_none()
        );
    }

    fn size_of(radius_px: f64) -> StencilSize {
        StencilSize::from_radius_square((radius_px * 4096.0).powi(2) as i64, radius_px < 0.0)
            .expect("it is small")
    }

    fn letter() -> ApertureShape {
        let transmission = (0..64).map(|k| f32::from(k % 8 < 3 || k < 16)).collect();
        ApertureShape::Mask(Arc::new(ApertureMask { width: 8, height: 8, transmission, file: String::new() }))
    }

    /// One texel of a large mask keeps its place at every size.
    #[test]
    fn a_small_opening_stays_in_its_place() {
        let mut transmission = vec![0.0; 64 * 64];
        transmission[5 * 64 + 50] = 1.0;
        let mask = ApertureMask { width: 64, height: 64, transmission, file: String::new() };
        let stencils = Stencils::new(Shape::new(&ApertureShape::Mask(Arc::new(mask)).into()));
        for radius in [1.7, 3.0, 20.0, 60.0] {
            let (stencil, base) = stencils.stencil_at(size_of(radius), PIXEL / 2);
            let (mut light, mut mean) = (0.0, [0.0; 2]);
            for run in &stencil.runs {
                let share = (run.end - run.start) as f64 * run.height as f64;
                light += share;
                mean[0] += share * (run.start + run.end) as f64 / 8192.0;
                mean[1] += share * (base + run.row) as f64;
            }
            let wanted = [(50.5 / 32.0 - 1.0) * radius, -(1.0 - 5.5 / 32.0) * radius];
            assert!((mean[0] / light - wanted[0]).abs() < 0.02, "{radius}: {mean:?}");
            assert!((mean[1] / light - wanted[1]).abs() <= 0.51, "{radius}: {mean:?}");
        }
    }

    /// Every pixel row of a disc's stencil has the light of its strip of the disc, however small the disc is.
    #[test]
    fn rows_have_the_light_of_their_strips() {
        let stencils = Stencils::new(Shape::new(&ApertureShape::Disc.into()));
        let below = |v: f64| {
            let v = v.clamp(-1.0, 1.0);
            0.5 + (v * (1.0 - v * v).sqrt() + v.asin()) / std::f64::consts::PI
        };
        for (radius, phase) in [(0.0, 0.0), (0.0, 0.75), (0.2, 0.0), (0.7, 0.5), (-4.2, 0.25), (37.3, 0.5)] {
            let stencil = stencils.cut(radius, phase);
            let mut sum = 0.0;
            for run in &stencil.runs {
                let edges = [run.row, run.row + 1].map(f64::from);
                let wanted = if radius == 0.0 {
                    f64::from(run.row == 0)
                } else {
                    let [a, b] = edges.map(|y| below((phase - y) / radius));
                    (a - b).abs()
                };
                let quanta = f64::from(run.end - run.start) / f64::from(PIXEL) * f64::from(run.height);
                let light = quanta / (1u64 << stencil.height_bits) as f64;
                assert!((light - wanted).abs() < 1e-4, "{radius} {phase} {run:?}: {light} {wanted}");
                sum += light;
            }
            assert!((sum - 1.0).abs() < 1e-5, "{radius} {phase}: {sum}");
        }
    }

    /// Light, mean and variance of a stencil are those of the shape.
    #[test]
    fn moments_are_those_of_the_shape() {
        for shape in [ApertureShape::Disc, ApertureShape::Square, letter()] {
            let stencils = Stencils::new(Shape::new(&shape.clone().into()));
            for radius in [1.7, -2.2, 4.0, -11.3, 63.0] {
                for y in [0.5, 0.125, 0.875] {
                    let (stencil, base) = stencils.stencil_at(size_of(radius), (y * 4096.0) as i32);
                    let (mut light, mut mean, mut square) = (0.0, [0.0; 2], [0.0; 2]);
                    for run in &stencil.runs {
                        let [a, b] = [run.start, run.end].map(|x| x as f64 / PIXEL as f64);
                        let share = (b - a) * run.height as f64 / (1u64 << stencil.height_bits) as f64;
                        let down = (base + run.row) as f64 + 0.5 - y;
                        light += share;
                        mean = [mean[0] + share * (a + b) / 2.0, mean[1] + share * down];
                        square[0] += share * ((a + b).powi(2) / 4.0 + (b - a).powi(2) / 12.0);
                        square[1] += share * down * down;
                    }
                    let wanted = (stencils.shape.mean * radius).to_array();
                    let what = format!("{shape:?} {radius} {y}: {light} {mean:?}");
                    assert!((light - 1.0).abs() < 1e-6, "{what}");
                    assert!((mean[0] - wanted[0]).abs() < 0.02 * radius.abs() + 0.01, "{what}");
                    assert!((mean[1] + wanted[1]).abs() < 0.02 * radius.abs() + 0.01, "{what}");
                    let variance = (stencils.shape.variance * radius * radius).to_array();
                    let found = [square[0] - mean[0].powi(2), square[1] - mean[1].powi(2)];
                    let wide = if shape == letter() { 0.05 } else { 0.0 };
                    assert!(
                        (found[0] / variance[0] - 1.0).abs() - wide < 0.05 + 0.02 / radius.powi(2),
                        "{what}"
                    );
                    assert!((found[1] - variance[1]).abs() < 0.2 + 0.02 * variance[1], "{what} {found:?}");
                }
            }
        }
    }
}
