//! Light for texels that no photograph observes, from those around them in space.
//!
//! Push–pull (Gortler et al. 1996) over lattices that double their spacing: a cell holds the mean of the light observed
//! in it and the amount of evidence; a texel takes its light from the finest cells with evidence and the rest from
//! coarser ones. Lattices are in space rather than in the atlas, so chart borders do not matter.

use crate::photographs::texels::Texels;
use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Evidence in a cell: weighted sum of light, and weight.
type Cells = HashMap<IVec3, (Vec3, f32)>;

/// A cell with the evidence of this many texels needs no coarser one.
const FULL_EVIDENCE: f32 = 2.0;
/// Width of the finest cells, texels.
const FINEST_CELL_TEXELS: f64 = 2.0;

/// Completes the light of all texels: their own as far as it was observed (`observed_share`, in [0, 1]), and that from
/// around for the rest.
pub(crate) fn fill_unobserved(texels: &Texels, observed_share: &[f32], light: &mut [Vec3]) {
    if observed_share.iter().all(|&share| share >= 1.0) {
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
    let mut spacings = vec![FINEST_CELL_TEXELS * texel_side];
    while *spacings.last().unwrap_or(&size) < 2.0 * size && spacings.len() < 24 {
        spacings.push(spacings[spacings.len() - 1] * 2.0);
    }
    // From fine to coarse, each from the one before.
    let mut levels: Vec<Cells> = Vec::with_capacity(spacings.len());
    for (level, &spacing) in spacings.iter().enumerate() {
        let mut cells = Cells::new();
        let mut add = |cell: IVec3, light: Vec3, weight: f32| {
            let sum = cells.entry(cell).or_default();
            sum.0 += light * weight;
            sum.1 += weight;
        };
        if level == 0 {
            for texel in (0..texels.count()).filter(|&texel| observed_share[texel] > 0.0) {
                add(
                    ((texels.position(texel) - low) / spacing).floor().as_ivec3(),
                    light[texel],
                    observed_share[texel],
                );
            }
        } else {
            // In an order that does not depend on the layout of the map.
            let mut finer: Vec<_> = levels[level - 1].iter().collect();
            finer.sort_unstable_by_key(|(cell, _)| cell.to_array());
            for (cell, &(sum, weight)) in finer {
                // A cell represents its volume however many texels lie in it.
                let capped = weight.min(FULL_EVIDENCE);
                add(cell.div_euclid(IVec3::splat(2)), sum / weight, capped);
            }
        }
        levels.push(cells);
    }
    let light_around = |position: DVec3| {
        let (mut result, mut rest) = (Vec3::ZERO, 1.0);
        for (cells, &spacing) in levels.iter().zip(&spacings) {
            let at = (position - low) / spacing - 0.5;
            let floor = at.floor();
            let share = (at - floor).as_vec3();
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for k in 0..8 {
                let step = IVec3::new(k & 1, k >> 1 & 1, k >> 2);
                let axis_weight = |axis: usize| if step[axis] == 0 { 1.0 - share[axis] } else { share[axis] };
                if let Some(&(light, weight)) = cells.get(&(floor.as_ivec3() + step)) {
                    let cell_weight =
                        axis_weight(0) * axis_weight(1) * axis_weight(2) * weight.min(FULL_EVIDENCE);
                    sum += light / weight * cell_weight;
                    weights += cell_weight;
                }
            }
            if weights > 0.0 {
                let used = (weights / FULL_EVIDENCE).min(1.0) * rest;
                result += sum / weights * used;
                rest -= used;
            }
            if rest <= 1e-3 {
                break;
            }
        }
        if rest < 1.0 { result / (1.0 - rest) } else { Vec3::ZERO }
    };
    light.par_iter_mut().enumerate().filter(|(texel, _)| observed_share[*texel] < 1.0).for_each(
        |(texel, light)| {
            *light = light_around(texels.position(texel)).lerp(*light, observed_share[texel]);
        },
    );
}
