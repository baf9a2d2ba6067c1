//! Light for texels that no photograph sees, from those around in space.
//!
//! Push and pull (Gortler et al. 1996) over lattices that are twice as coarse each time: a cell knows the mean of what was seen in it and how
//! much that was; a texel takes it from the finest cells that know, the rest from coarser ones. Lattices are in space, not in the
//! atlas, so that charts do not matter.

use crate::photographs::places::Texels;
use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Evidence in a cell: the weighted sum of light, and the weight.
type Cells = HashMap<IVec3, (Vec3, f32)>;

/// A cell that holds the evidence of so many texels needs no coarser one.
const ENOUGH: f32 = 2.0;
/// The finest cells are so many texels wide.
const FINEST: f64 = 2.0;

/// Gives every texel light: its own as far as it is seen (`seen`, in [0, 1]), that from around for the rest.
pub(crate) fn fill(texels: &Texels, seen: &[f32], light: &mut [Vec3]) {
    if seen.iter().all(|&seen| seen >= 1.0) {
        return;
    }
    let area: f64 = (0..texels.count()).map(|texel| f64::from(texels.area(texel))).sum();
    let texel_side = (area / texels.count().max(1) as f64).sqrt();
    let bounds = (0..texels.count()).map(|texel| texels.position(texel));
    let (low, high) = bounds.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let size = (high - low).max_element();
    if !(texel_side > 0.0 && size.is_finite()) {
        return;
    }
    let mut spacings = vec![FINEST * texel_side];
    while *spacings.last().unwrap_or(&size) < 2.0 * size && spacings.len() < 24 {
        spacings.push(spacings[spacings.len() - 1] * 2.0);
    }
    // From fine to coarse, each from the one before.
    let mut levels: Vec<Cells> = Vec::with_capacity(spacings.len());
    for (number, &spacing) in spacings.iter().enumerate() {
        let mut cells = Cells::new();
        let mut add = |cell: IVec3, light: Vec3, weight: f32| {
            let sum = cells.entry(cell).or_default();
            sum.0 += light * weight;
            sum.1 += weight;
        };
        if number == 0 {
            for texel in (0..texels.count()).filter(|&texel| seen[texel] > 0.0) {
                add(((texels.position(texel) - low) / spacing).floor().as_ivec3(), light[texel], seen[texel]);
            }
        } else {
            // In an order that does not depend on how the map is laid out.
            let mut finer: Vec<_> = levels[number - 1].iter().collect();
            finer.sort_unstable_by_key(|(cell, _)| cell.to_array());
            for (cell, &(sum, weight)) in finer {
                // A cell speaks for its place, not for how many texels lie in it.
                let speaks = weight.min(ENOUGH);
                add(cell.div_euclid(IVec3::splat(2)), sum / weight, speaks);
            }
        }
        levels.push(cells);
    }
    let filled = |position: DVec3| {
        let (mut result, mut rest) = (Vec3::ZERO, 1.0);
        for (cells, &spacing) in levels.iter().zip(&spacings) {
            let at = (position - low) / spacing - 0.5;
            let floor = at.floor();
            let share = (at - floor).as_vec3();
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for k in 0..8 {
                let step = IVec3::new(k & 1, k >> 1 & 1, k >> 2);
                let of_axis = |axis: usize| if step[axis] == 0 { 1.0 - share[axis] } else { share[axis] };
                if let Some(&(light, weight)) = cells.get(&(floor.as_ivec3() + step)) {
                    let speaks = of_axis(0) * of_axis(1) * of_axis(2) * weight.min(ENOUGH);
                    sum += light / weight * speaks;
                    weights += speaks;
                }
            }
            if weights > 0.0 {
                let known = (weights / ENOUGH).min(1.0) * rest;
                result += sum / weights * known;
                rest -= known;
            }
            if rest <= 1e-3 {
                break;
            }
        }
        if rest < 1.0 { result / (1.0 - rest) } else { Vec3::ZERO }
    };
    light.par_iter_mut().enumerate().filter(|(texel, _)| seen[*texel] < 1.0).for_each(|(texel, light)| {
        *light = filled(texels.position(texel)).lerp(*light, seen[texel]);
    });
}
