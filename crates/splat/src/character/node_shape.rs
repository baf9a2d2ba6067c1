//! The aperture as one node's light passes it: cut by rims, weighed by edges.
//!
//! Aperture points are in 1/16384 of the lens's radius.

use crate::fixed::{ONE, integer_sqrt};

/// What a rim leaves of the aperture for a node: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its centre.
    pub center: [i32; 2],
    /// Its radius; nothing passes one of 0.
    pub radius: i32,
}

/// The weight over the aperture of a node's light: 1 + `steepness`·2(stop²·|u|² − mean)/extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeEdges {
    /// b·σ(κ), in [−1, 1].
    pub steepness: f32,
    /// The square of the lens's radius over its widest.
    pub stop_square: f32,
    /// The mean of stop²·|u|².
    pub mean: f32,
    /// 2/M.
    pub per_extent: f32,
}

/// How a node's light passes the aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeShape {
    /// What rims leave.
    pub discs: [Option<Disc>; 2],
    /// What weighs what.
    pub edges: Option<NodeEdges>,
}

/// Part of a pixel row of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapedRun {
    /// From where, 1/4096 px.
    pub start: i32,
    /// To where.
    pub end: i32,
    /// What part of the row's light a pixel of it has, times 16384.
    pub weight: u32,
}

/// A pixel row of an image, from which parts are made.
#[derive(Clone, Copy, Debug)]
pub struct ImageRow {
    /// Column of the image's centre, 1/4096 px.
    pub center: i32,
    /// Signed radius of the image, 1/4096 px; not 0.
    pub radius: i32,
    /// The aperture's v at the row's middle.
    pub v: i32,
    /// The standard deviation of the row's v.
    pub v_deviation: i32,
    /// From where to where light is, 1/4096 px.
    pub span: [i32; 2],
    /// Parts of different weight are about this wide, 1/4096 px.
    pub part_width: i32,
    /// Where the parts begin differs by it.
    pub dither: u32,
}

/// The most parts of a row.
const MAX_PARTS: i32 = 128;

impl NodeShape {
    /// Whether all light passes alike.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        self.edges.is_none() && self.discs == [None; 2]
    }

    /// From where to where light passes on the line of height `v`; `None` if nowhere.
    #[inline(always)]
    pub fn chord(&self, v: i32) -> Option<[i32; 2]> {
        let mut chord = [-2 * ONE, 2 * ONE];
        for disc in self.discs.iter().flatten() {
            let half = half_chord(disc.radius, v - disc.center[1])?;
            chord = [chord[0].max(disc.center[0] - half), chord[1].min(disc.center[0] + half)];
        }
        (chord[0] < chord[1]).then_some(chord)
    }

    /// The weight of a part of the aperture whose mean square is `square`, in units of the lens's radius.
    #[inline(always)]
    pub fn weight(&self, square: f32) -> f32 {
        self.edges.map_or(1.0, |edges| edges.weight(square))
    }

    /// Calls `emit` with the parts of a row that are let through.
    #[inline(always)]
    pub fn visit_row(&self, row: ImageRow, mut emit: impl FnMut(ShapedRun)) {
        let Some((span, share)) = self.cut(&row) else { return };
        let Some(edges) = self.edges else {
            return emit(ShapedRun { start: span[0], end: span[1], weight: share });
        };
        let [v, deviation] = [row.v, row.v_deviation].map(|v| v as f32 / ONE as f32);
        let v_square = v * v + deviation * deviation;
        let per_radius = 1.0 / row.radius as f32;
        let width = span[1] - span[0];
        let count = (width / row.part_width.max(1)).clamp(1, MAX_PARTS);
        // Parts of neighbouring rows begin elsewhere, so that no edge of one shows.
        let step = width / count;
        let offset = ((i64::from(row.dither >> 16) * i64::from(step)) >> 16) as i32;
        // One part is not parted.
        let mut end = span[0] + if count == 1 { step } else { offset };
        let mut start = span[0];
        while start < span[1] {
            // The last part takes what is left of the division.
            end = if span[1] - end < count { span[1] } else { end };
            if end > start {
                let half = (end - start) as f32 * 0.5 * per_radius;
                let middle = ((start - row.center) as f32 + (end - start) as f32 * 0.5) * per_radius;
                let weight = edges.weight(middle * middle + half * half / 3.0 + v_square);
                let weight = (weight * share as f32).round_ties_even().max(0.0) as u32;
                if weight > 0 {
                    emit(ShapedRun { start, end, weight });
                }
                start = end;
            }
            end += step;
        }
    }

    /// What of a row's span rims leave, and how much of its height, times 16384: the mean of two lines of it, whose chords have
    /// the mean of all (Gauss's rule).
    #[inline(always)]
    fn cut(&self, row: &ImageRow) -> Option<([i32; 2], u32)> {
        if self.discs == [None; 2] {
            return (row.span[0] < row.span[1]).then_some((row.span, ONE as u32));
        }
        let line = |v: i32| {
            let [from, to] = self.chord(v.clamp(-ONE, ONE))?;
            let at = |u: i32| {
                let x = i64::from(row.center) + ((i64::from(row.radius) * i64::from(u)) >> 14);
                x.clamp(i64::from(i32::MIN / 2), i64::from(i32::MAX / 2)) as i32
            };
            let [a, b] = [at(from), at(to)];
            let span = [a.min(b).max(row.span[0]), a.max(b).min(row.span[1])];
            (span[0] < span[1]).then_some(span)
        };
        match [row.v - row.v_deviation, row.v + row.v_deviation].map(line) {
            [Some(a), Some(b)] => Some(([(a[0] + b[0]) >> 1, (a[1] + b[1]) >> 1], ONE as u32)),
            [Some(one), None] | [None, Some(one)] => Some((one, ONE as u32 / 2)),
            [None, None] => None,
        }
    }
}

impl NodeEdges {
    /// The weight, ≥ 0, where the mean square of the aperture point is `square`, in units of the lens's radius.
    #[inline(always)]
    pub fn weight(&self, square: f32) -> f32 {
        let g = (self.stop_square * square - self.mean) * self.per_extent;
        (1.0 + self.steepness * g).max(0.0)
    }
}

/// √(radius² − away²), `None` if that is negative.
#[inline(always)]
fn half_chord(radius: i32, away: i32) -> Option<i32> {
    let away = away.abs();
    if radius <= away {
        return None;
    }
    // (r − d)·(r + d) in 32 bits.
    let [less, more] = [(radius - away) as u32, (radius + away) as u32];
    let shift = 16u32.saturating_sub(more.leading_zeros());
    Some((integer_sqrt((less >> shift) * (more >> shift)) << shift) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(v: i32) -> ImageRow {
        let radius = 30 * 4096;
        ImageRow {
            center: 100 * 4096,
            radius,
            v,
            v_deviation: 300,
            span: [70 * 4096, 130 * 4096],
            part_width: 4096,
            dither: 0x9E37_79B1u32.wrapping_mul(v as u32),
        }
    }

    #[test]
    fn chords_of_discs_are_exact() {
        for radius in [1, 700, 16384, 20000, 40000, 100_000] {
            for away in [0, 5, radius / 3, radius - 1, radius, radius + 7] {
                let exact = (f64::from(radius).powi(2) - f64::from(away).powi(2)).max(0.0).sqrt();
                let found = half_chord(radius, -away).map_or(0.0, f64::from);
                assert!(
                    (found - exact).abs() <= 1.5 + exact / 8192.0 + 2.0 * f64::from(radius) / exact.max(1.0),
                    "{radius} {away}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn a_cut_row_ends_where_its_disc_does() {
        let disc = Disc { center: [6000, -2000], radius: 15000 };
        let shape = NodeShape { discs: [Some(disc), None], edges: None };
        let mut found = Vec::new();
        shape.visit_row(row(1000), |run| found.push(run));
        let half = (15000f64.powi(2) - 3000f64.powi(2)).sqrt();
        let x = |u: f64| (100.0 + 30.0 * u / 16384.0) * 4096.0;
        assert_eq!(found.len(), 1);
        assert!((f64::from(found[0].start) - x(6000.0 - half)).abs() < 200.0, "{found:?}");
        assert_eq!((found[0].end, found[0].weight), (130 * 4096, ONE as u32));
        // Of a turned image the other side is cut.
        let mut turned = Vec::new();
        shape.visit_row(ImageRow { radius: -30 * 4096, ..row(1000) }, |run| turned.push(run));
        assert!(turned[0].start == 70 * 4096 && turned[0].end < 130 * 4096, "{turned:?}");
        let mut missed = 0;
        shape.visit_row(row(16000), |_| missed += 1);
        assert_eq!(missed, 0);
    }

    #[test]
    fn a_weighed_row_has_the_mean_of_its_weight() {
        for steepness in [1.0, -1.0, 0.4] {
            let edges = NodeEdges { steepness, stop_square: 1.0, mean: 0.5, per_extent: 2.0 };
            let shape = NodeShape { discs: [None; 2], edges: Some(edges) };
            for v in [0, 3000, -12000] {
                // As far as a disc's row goes: the weight has its mean and its extent over the disc.
                let half = (1.0 - (f64::from(v) / 16384.0).powi(2)).sqrt();
                let reach = (half * 30.0 * 4096.0) as i32;
                let span = [100 * 4096 - reach, 100 * 4096 + reach];
                let (mut light, mut filled) = (0.0, 0.0);
                shape.visit_row(ImageRow { span, ..row(v) }, |run| {
                    light += f64::from(run.end - run.start) * f64::from(run.weight) / 16384.0;
                    filled += f64::from(run.end - run.start);
                });
                let width = f64::from(span[1] - span[0]);
                // A part of weight 0, in the middle or at the rim, is left out.
                let may_vanish = steepness.abs() == 1.0;
                assert!(filled == width || (may_vanish && filled > 0.9 * width), "{steepness} {v}: {filled}");
                let square = half * half / 3.0 + (f64::from(v).powi(2) + 300f64.powi(2)) / 16384f64.powi(2);
                let expected = 1.0 + f64::from(steepness) * 2.0 * (square - 0.5);
                assert!(
                    (light / width - expected).abs() < 2e-3,
                    "{steepness} {v}: {} {expected}",
                    light / width
                );
            }
        }
    }
}
