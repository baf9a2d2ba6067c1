//! A curve fitted into the middle of the colours that it is to pass through.
//!
//! Colours are projected to the nearest place of the curve, and each of its points moves to where a local line through its colours is
//! (Hastie and Stuetzle, *Principal Curves*, JASA 1989), with a window that narrows. Rare colours are mixtures and noise.

use crate::colour_coded::palette::{Palette, distance};
use std::collections::BTreeMap;

/// Cells per channel in which colours are counted.
const CELLS: f32 = 32.0;

/// The least share of the pixels for a cell to count.
const RARE: f32 = 3e-4;

/// Windows of the rounds, as shares of the curve.
const WINDOWS: [f32; 8] = [0.08, 0.06, 0.05, 0.04, 0.03, 0.025, 0.02, 0.02];

/// Colours farther than this from the curve do not move it.
const FAR: f32 = 0.25;

/// The curve that runs through the colours of a map, from an initial curve.
pub fn fit_principal_curve(start: Palette, map: &[[f32; 3]]) -> Palette {
    let colours = frequent(map);
    let mut palette = start;
    for window in WINDOWS {
        let placed: Vec<(f32, f32, [f32; 3])> = colours
            .iter()
            .map(|(colour, weight)| (palette.nearest(*colour), colour, weight))
            .filter(|(nearest, _, _)| nearest.distance < FAR)
            .map(|(nearest, colour, weight)| (overshot(&palette, nearest.place, *colour), *weight, *colour))
            .collect();
        let last = (palette.points().len() - 1) as f32;
        let points = palette.points().iter().enumerate();
        let moved: Vec<[f32; 3]> =
            points.map(|(k, point)| local_line(&placed, k as f32 / last, window).unwrap_or(*point)).collect();
        match Palette::through(&moved) {
            Some(next) => palette = next,
            None => return palette,
        }
    }
    palette
}

/// The place along the curve, extended straight beyond its ends, so that colours there can pull it outward.
fn overshot(palette: &Palette, place: f32, colour: [f32; 3]) -> f32 {
    let points = palette.points();
    let step = 1.0 / (points.len() - 1) as f32;
    let beyond = |end: [f32; 3], inner: [f32; 3]| {
        let length = distance(end, inner);
        let along: f32 = (0..3).map(|c| (colour[c] - end[c]) * (end[c] - inner[c])).sum();
        if length > 0.0 { (along / (length * length)).max(0.0) * step } else { 0.0 }
    };
    if place <= 0.0 {
        place - beyond(points[0], points[1])
    } else if place >= 1.0 {
        place + beyond(points[points.len() - 1], points[points.len() - 2])
    } else {
        place
    }
}

/// Means of the colours that are not rare, each weighted by the root of its count.
fn frequent(map: &[[f32; 3]]) -> Vec<([f32; 3], f32)> {
    let mut cells: BTreeMap<[i32; 3], ([f64; 3], u32)> = BTreeMap::new();
    for colour in map {
        let cell = cells.entry(colour.map(|v| (v.clamp(-1.0, 2.0) * CELLS) as i32)).or_default();
        cell.0.iter_mut().zip(colour).for_each(|(sum, v)| *sum += f64::from(*v));
        cell.1 += 1;
    }
    let least = RARE * map.len() as f32;
    let counted = cells.into_values().filter(|(_, count)| *count as f32 >= least);
    counted.map(|(sum, count)| (sum.map(|v| (v / f64::from(count)) as f32), (count as f32).sqrt())).collect()
}

/// The value at `place` of a line fitted to nearby colours; `None` where there are none.
fn local_line(placed: &[(f32, f32, [f32; 3])], place: f32, window: f32) -> Option<[f32; 3]> {
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    let (mut value, mut slope) = ([0.0; 3], [0.0; 3]);
    for (there, weight, colour) in placed {
        let offset = there - place;
        let share = offset / window;
        if share.abs() > 3.0 {
            continue;
        }
        let weight = weight * (-0.5 * share * share).exp();
        sum += weight;
        first += weight * offset;
        second += weight * offset * offset;
        for c in 0..3 {
            value[c] += weight * colour[c];
            slope[c] += weight * offset * colour[c];
        }
    }
    let determinant = sum * second - first * first;
    if sum <= 0.0 {
        return None;
    }
    if determinant <= 1e-3 * sum * sum * window * window {
        // All at one place: their mean, if that is here.
        return (first.abs() < window * sum).then(|| value.map(|v| v / sum));
    }
    Some(std::array::from_fn(|c| ((second * value[c] - first * slope[c]) / determinant).clamp(0.0, 1.0)))
}
