//! The light of partly occluded nodes through the lens's aperture: its share, mean and spread over the aperture.

use crate::aperture::shape::Shape;
use crate::fixed::{ONE, WHOLE};
use crate::nodes::{Cells, Nodes, SplatNode};
use glam::DVec2;
use numerics::prefetch;
use std::sync::atomic::{AtomicU32, Ordering};

/// The light that a node sends through the lens's aperture, as a share of what its weight at the centre would send
/// through all of it, and the mean aperture point of that light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ApertureMoments {
    /// Times 2²⁴.
    pub share: u32,
    /// Times 16384, in units of the lens's radius.
    pub mean: [i16; 2],
    /// √3 standard deviations of its aperture points: half a box as wide. Times 16384, in units of the lens's radius.
    pub half_width: [u16; 2],
}

/// Sums over cells: share of the aperture, first and second moments.
#[derive(Clone, Copy, Default)]
struct MomentSums([f64; 6]);

impl MomentSums {
    fn add(&mut self, other: &Self) {
        (0..6).for_each(|k| self.0[k] += other.0[k]);
    }
}

/// The aperture moments of all partly occluded nodes of a light field, each computed when it is first asked for: a picture draws few of them.
pub struct MomentCache {
    /// Sums over eight cells of a row, by half row and by which of the cells are open.
    sums: Vec<[MomentSums; 256]>,
    /// The lens's aperture radius as a share of the baked one.
    stop: f64,
    /// In the order of [`SplatNode::cells`].
    entries: Vec<Entry>,
}

/// Moments that may not be computed yet. Threads that compute the same at the same time write the same.
#[derive(Default)]
struct Entry {
    /// The share plus 1; 0 while nothing is computed. Written last, read first.
    share: AtomicU32,
    mean: AtomicU32,
    half_width: AtomicU32,
}

impl MomentCache {
    /// No moments yet, of `nodes` (`None`: there are none) for a lens whose aperture radius is `stop` > 0 times the baked one's.
    pub fn new(nodes: Option<&Nodes>, shape: &Shape, stop: f64) -> Self {
        let cells = shape.cells(1.0 / stop);
        let sum_of = |half_row: usize, bits: usize| {
            let mut sum = MomentSums::default();
            for k in (0..8).filter(|k| bits >> k & 1 == 1) {
                let (share, u) = cells[half_row * 8 + k];
                let moments = [1.0, u.x, u.y, u.x * u.x, u.x * u.y, u.y * u.y];
                sum.add(&MomentSums(moments.map(|m| share * m)));
            }
            sum
        };
        let sums = (0..32).map(|half_row| std::array::from_fn(|bits| sum_of(half_row, bits))).collect();
        let count = nodes.map_or(0, Nodes::partial_count);
        Self { sums, stop, entries: std::iter::repeat_with(Entry::default).take(count).collect() }
    }

    /// The moments of a partly occluded node of `nodes`; no light of one that sees the whole aperture.
    #[inline(always)]
    pub fn of(&self, nodes: &Nodes, node: &SplatNode) -> ApertureMoments {
        let Some(entry) = self.entries.get(node.cells as usize) else { return ApertureMoments::default() };
        entry.get().unwrap_or_else(|| self.compute(nodes, node, entry))
    }

    /// Asks for the moments of a node to be brought near.
    #[inline(always)]
    pub fn prefetch(&self, node: &SplatNode) {
        prefetch(self.entries.get(node.cells as usize));
    }

    #[cold]
    fn compute(&self, nodes: &Nodes, node: &SplatNode, entry: &Entry) -> ApertureMoments {
        let moments = nodes.cells(node).map_or_else(Default::default, |rows| self.moments(node, rows));
        entry.set(moments);
        moments
    }

    fn moments(&self, node: &SplatNode, rows: &Cells) -> ApertureMoments {
        let mut sum = MomentSums::default();
        for (row, &bits) in rows.iter().enumerate() {
            sum.add(&self.sums[2 * row][(bits & 255) as usize]);
            sum.add(&self.sums[2 * row + 1][(bits >> 8) as usize]);
        }
        let [m, x, y, xx, xy, yy] = sum.0;
        let one = ONE as f64;
        // The tilt is that over the baked aperture.
        let (base, tilt) = (node.base as f64 / one, node.tilt.map(|tilt| tilt as f64 / one * self.stop));
        let share = base * m + tilt[0] * x + tilt[1] * y;
        if share <= 0.0 {
            return ApertureMoments::default();
        }
        let first =
            DVec2::new(base * x + tilt[0] * xx + tilt[1] * xy, base * y + tilt[0] * xy + tilt[1] * yy);
        let mean = (first / share).clamp(DVec2::NEG_ONE, DVec2::ONE);
        // The change of the weight within the visible part is negligible.
        let variance = (DVec2::new(xx, yy) / m - (DVec2::new(x, y) / m).powf(2.0)).max(DVec2::ZERO);
        let half = (3.0 * variance).map(f64::sqrt);
        ApertureMoments {
            half_width: (half * one).to_array().map(|half| half.round().min(65535.0) as u16),
            share: (share * WHOLE as f64).round() as u32,
            mean: (mean * one).to_array().map(|m| m.round() as i16),
        }
    }
}

impl Entry {
    #[inline(always)]
    fn get(&self) -> Option<ApertureMoments> {
        let share = self.share.load(Ordering::Acquire).checked_sub(1)?;
        let [mean, half_width] =
            [&self.mean, &self.half_width].map(|pair| unpack(pair.load(Ordering::Relaxed)));
        Some(ApertureMoments { share, mean: mean.map(|m| m as i16), half_width })
    }

    fn set(&self, moments: ApertureMoments) {
        self.mean.store(pack(moments.mean.map(|m| m as u16)), Ordering::Relaxed);
        self.half_width.store(pack(moments.half_width), Ordering::Relaxed);
        self.share.store(moments.share.saturating_add(1), Ordering::Release);
    }
}

fn pack([low, high]: [u16; 2]) -> u32 {
    u32::from(low) | u32::from(high) << 16
}

fn unpack(pair: u32) -> [u16; 2] {
    [pair as u16, (pair >> 16) as u16]
}
