//! The light of partly occluded nodes through the lens's aperture: its share, mean and spread over the aperture.

use crate::aperture::shape::Shape;
use crate::fixed::{ONE, WHOLE};
use crate::nodes::Nodes;
use glam::DVec2;
use rayon::prelude::*;

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

/// The aperture moments of every partly occluded node, in the order of [`crate::nodes::SplatNode::cells`], for a lens
/// whose aperture radius is `stop` times the baked one's.
pub fn aperture_moments(nodes: &Nodes, shape: &Shape, stop: f64) -> Vec<ApertureMoments> {
    let cells = shape.cells(1.0 / stop);
    // Of every eight cells of a row at once.
    let table: Vec<[MomentSums; 256]> = (0..32)
        .map(|half_row| {
            std::array::from_fn(|bits| {
                let mut sum = MomentSums::default();
                for k in (0..8).filter(|k| bits >> k & 1 == 1) {
                    let (share, u) = cells[half_row * 8 + k];
                    let moments = [1.0, u.x, u.y, u.x * u.x, u.x * u.y, u.y * u.y];
                    sum.add(&MomentSums(moments.map(|m| share * m)));
                }
                sum
            })
        })
        .collect();
    let of = |node: &crate::nodes::SplatNode| {
        let Some(rows) = nodes.cells(node) else { return ApertureMoments::default() };
        let mut sum = MomentSums::default();
        for (row, &bits) in rows.iter().enumerate() {
            sum.add(&table[2 * row][(bits & 255) as usize]);
            sum.add(&table[2 * row + 1][(bits >> 8) as usize]);
        }
        let [m, x, y, xx, xy, yy] = sum.0;
        let one = ONE as f64;
        // The tilt is that over the baked aperture.
        let (base, tilt) = (node.base as f64 / one, node.tilt.map(|tilt| tilt as f64 / one * stop));
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
    };
    let partial: Vec<_> = nodes.nodes.iter().filter(|node| !node.is_open()).collect();
    partial.into_par_iter().map(of).collect()
}
