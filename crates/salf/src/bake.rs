//! Scene and camera to light field.
//!
//! 1. The pinhole picture is sampled, cell by cell ([`crate::layers`]): the nearest surfaces.
//! 2. Their depths tell which of them may be partly occluded, and where hidden ones may show ([`crate::occluders`]).
//! 3. Those, and only those, are asked what of the aperture they see ([`crate::visibility`]).
//! 4. Surfaces edge-on to the aperture are sampled on the surface ([`crate::edge_on`]).

use crate::domain::{Cell, Domain};
use crate::layers::{Group, trace_cell};
use crate::margin::{painted_margin_px, standard_margin_px};
use crate::occluders::{Footprint, Occluders};
use crate::sample::{Salf, Sample, Visibility};
use crate::view::View;
use crate::{edge_on, visibility};
use glam::DVec2;
use lens::{Camera, FocusOffset};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use scene::SurfaceField;
use std::sync::atomic::{AtomicUsize, Ordering};
use trace::{Radiance, Tracer};

/// How the light field is sampled.
#[derive(Clone, Copy, Debug, Default)]
pub struct BakeOptions {
    /// How far outside the frame to sample at least, px: the radius of the largest circle of confusion that paint
    /// may give. What the standard picture needs is always sampled.
    pub margin_px: f64,
}

impl BakeOptions {
    /// Sampled as far outside the frame as `focus` needs.
    pub fn for_focus(tracer: &Tracer, camera: &Camera, focus: &dyn SurfaceField<FocusOffset>) -> Self {
        Self { margin_px: painted_margin_px(tracer, &View::new(camera), focus) }
    }
}

/// A nearest surface of a cell, before it is known whether anything occludes it.
struct Candidate {
    sample: Sample,
    slope: DVec2,
    /// Whether another surface of its own cell is in front of it.
    has_nearer: bool,
}

/// What the first look at a cell found.
struct FirstLook {
    cell: Cell,
    depth_range: [f32; 2],
    is_edge_on: bool,
    candidates: Vec<Candidate>,
}

/// Bakes the light field that `camera`'s square aperture sees. `camera` must be valid.
pub fn bake(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    camera: &Camera,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<Salf, Cancelled> {
    let view = View::new(camera);
    let margin = standard_margin_px(tracer.scene(), &view).max(options.margin_px);
    let domain = Domain::new(camera.width, camera.height, margin);

    let first_looks = each_row(&domain.block_rows(), &Stage::new(progress, 0.0, 0.4), |cells| {
        cells.iter().map(|&cell| first_look(tracer, radiance, &view, cell)).collect::<Vec<_>>()
    })?;
    let depths = first_looks.iter().flatten().map(|look| (look.cell, look.depth_range));
    let occluders = Occluders::new(domain, view.radius_per_kappa_px, depths);

    let second = Stage::new(progress, 0.4, 0.95);
    let mut rows = each_row(&first_looks, &second, |looks| {
        let mut samples = Vec::new();
        for look in looks {
            second_look(tracer, radiance, &view, &occluders, look, &mut samples);
        }
        samples
    })?;

    let triangles: Vec<u32> = (0..tracer.scene().triangles.len() as u32)
        .filter(|&triangle| !view.faces_aperture(tracer.scene(), triangle))
        .collect();
    let chunks: Vec<_> = triangles.chunks(256).collect();
    rows.extend(each_row(&chunks, &Stage::new(progress, 0.95, 1.0), |chunk| {
        let of = |&triangle: &u32| edge_on::samples(tracer, radiance, &view, &domain, triangle);
        chunk.iter().flat_map(of).collect()
    })?);

    let mut samples = Vec::with_capacity(rows.iter().map(Vec::len).sum());
    rows.into_iter().for_each(|row| samples.extend(row));
    Ok(Salf { camera: camera.clone(), margin_px: domain.margin as u32, samples })
}

/// Works on rows in parallel, in order of result, with progress and cancel.
fn each_row<T: Sync, R: Send>(
    rows: &[T],
    progress: &dyn Progress,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Cancelled> {
    let done = AtomicUsize::new(0);
    rows.par_iter()
        .map(|row| {
            progress.check()?;
            let result = work(row);
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / rows.len() as f32);
            Ok(result)
        })
        .collect()
}

fn first_look(tracer: &Tracer, radiance: &dyn Radiance, view: &View, cell: Cell) -> FirstLook {
    let layers = trace_cell(tracer, view, cell, false);
    let candidates = layers
        .groups
        .iter()
        .map(|group| Candidate {
            sample: group.sample(radiance, view, cell, Visibility::Open),
            slope: group.slope,
            has_nearer: layers.has_nearer(group, view.radius_per_kappa_px),
        })
        .collect();
    FirstLook { cell, depth_range: layers.depth_range, is_edge_on: layers.is_edge_on, candidates }
}

fn second_look(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    view: &View,
    occluders: &Occluders,
    look: &FirstLook,
    samples: &mut Vec<Sample>,
) {
    let cell = look.cell;
    let may_occlude = |center: DVec2, inverse_depth: f64, slope: DVec2| {
        occluders.may_occlude(&Footprint { center, cell, inverse_depth, slope })
    };
    let is_pinhole = view.optics.aperture_radius == 0.0;
    let hidden = look.is_edge_on || occluders.may_reveal(cell, look.depth_range[0]);
    if is_pinhole || !hidden {
        let is_open = |candidate: &Candidate| {
            let sample = &candidate.sample;
            is_pinhole
                || !candidate.has_nearer
                    && !may_occlude(sample.center.as_dvec2(), sample.inverse_depth as f64, candidate.slope)
        };
        if look.candidates.iter().all(is_open) {
            samples.extend(look.candidates.iter().map(|candidate| candidate.sample.clone()));
            return;
        }
    }
    let layers = trace_cell(tracer, view, cell, hidden);
    for (index, group) in layers.groups.iter().enumerate() {
        let is_open = group.is_nearest
            && !layers.has_nearer(group, view.radius_per_kappa_px)
            && !may_occlude(group.center(cell), group.mean_inverse_depth(), group.slope);
        let visibility = if is_open {
            Some(Visibility::Open)
        } else {
            partial_visibility(tracer, view, cell, group, index as u32)
        };
        if let Some(visibility) = visibility {
            samples.push(group.sample(radiance, view, cell, visibility));
        }
    }
}

fn partial_visibility(
    tracer: &Tracer,
    view: &View,
    cell: Cell,
    group: &Group,
    index: u32,
) -> Option<Visibility> {
    let corner = cell.corner.as_uvec2();
    let seed = [corner.x, corner.y.wrapping_add(index << 16)];
    if !group.is_nearest && visibility::is_hidden(tracer, view, &group.members, seed) {
        return None;
    }
    let side = visibility::cells_a_side(view, group.mean_inverse_depth());
    visibility::visibility(tracer, view, &group.members, side, seed, |_| true)
}
