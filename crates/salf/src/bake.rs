//! Scene and camera to light field.
//!
//! 1. The pinhole picture is sampled, cell by cell ([`crate::layers`]), with four times the rays where an outline passes
//!    through: the nearest surfaces, a sample each or, where their radiance varies, one a quadrant.
//! 2. Their depths tell which of them may be partly occluded, and where hidden ones may show ([`crate::occluders`]).
//! 3. Surfaces edge-on to the aperture, and small bright ones, are sampled on the surface ([`crate::surface_patches`]).
//! 4. What may be partly occluded, and only that, is asked what of the aperture it sees ([`crate::visibility`]).
//!
//! The samples of each block are packed as soon as they are all found ([`crate::samples`]).

use crate::domain::{Cell, Density, Domain};
use crate::layers::{Group, Layers, Tile, trace_cell};
use crate::margin::standard_margin_px;
use crate::occluders::{Depths, Footprint, Occluders};
use crate::options::BakeOptions;
use crate::outgoing::{self, Asked, TowardCells};
use crate::outliers::{self, Outliers};
use crate::placement::Placement;
use crate::salf::Salf;
use crate::sample::{Sample, Visibility};
use crate::samples::{Found, Packer, Samples, block_corner};
use crate::surface_patches;
use crate::view::View;
use crate::visibility::{self, Fineness, Patterns, Seen};
use glam::{DVec2, IVec2, Vec3};
use lens::Camera;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;
use std::sync::atomic::{AtomicUsize, Ordering};
use trace::{Radiance, Received, Tracer, Viewpoint};

/// A surface of a cell, before it is known what it sees of the aperture.
struct Candidate {
    center: DVec2,
    inverse_depth: f64,
    slope: DVec2,
    /// From where it is asked what it sees.
    viewpoint: Viewpoint,
    /// Whether no other surface of its own cell is in front of it.
    is_in_front: bool,
}

/// What the first look at a cell found.
struct FirstLook {
    cell: Cell,
    density: Density,
    depths: Depths,
    has_gap: bool,
    has_pane: bool,
    /// Its nearest surfaces, each with its samples as if they saw all.
    nearest: Vec<(Candidate, Vec<Found>)>,
}

/// Bakes the light field that `camera`'s square aperture sees. `camera` must be valid.
pub fn bake(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    camera: &Camera,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<Salf, Cancelled> {
    bake_and_tell(tracer, radiance, camera, options, progress).map(|(salf, _)| salf)
}

/// The same, with what light of outliers was spread.
pub fn bake_and_tell(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    camera: &Camera,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(Salf, Outliers), Cancelled> {
    let view = View::new(camera, options.tolerance_px).telling(options.carried);
    let margin = standard_margin_px(tracer.scene(), &view).max(options.margin_px);
    let domain = Domain::new(camera.width, camera.height, margin);
    let placement = Placement::new(tracer.scene(), &view);
    let patterns = Patterns::new();
    let baker = Baker { tracer, radiance, view: &view, placement: &placement, patterns: &patterns };

    let first_looks = each_row(&domain.block_rows(), &Stage::new(progress, 0.0, 0.4), |cells| {
        cells.chunk_by(are_of_one_block).flat_map(|cells| baker.first_looks(cells)).collect::<Vec<_>>()
    })?;
    let depths = first_looks.iter().flatten().map(|look| (look.cell, look.depths));
    let occluders = Occluders::new(domain, view.radius_per_kappa_px, depths);

    let triangles: Vec<u32> = placement.on_surface().collect();
    let chunks: Vec<_> = triangles.chunks(256).collect();
    let patches = each_row(&chunks, &Stage::new(progress, 0.4, 0.45), |chunk| {
        let of =
            |&triangle: &u32| surface_patches::samples(tracer, radiance, &view, &patterns, &domain, triangle);
        chunk.iter().flat_map(of).collect::<Vec<_>>()
    })?;
    let mut patches_of_block: HashMap<IVec2, Vec<Sample>> = HashMap::new();
    for patch in patches.into_iter().flatten() {
        patches_of_block.entry(block_corner(patch.center.floor().as_ivec2())).or_default().push(patch);
    }

    let blocks: Vec<&[FirstLook]> =
        first_looks.iter().flat_map(|row| row.chunk_by(|a, b| are_of_one_block(&a.cell, &b.cell))).collect();
    let parts = each_row(&blocks, &Stage::new(progress, 0.45, 1.0), |looks| {
        let mut found = baker.second_looks(&occluders, looks);
        let corner = block_corner(looks[0].cell.corner);
        let patches = patches_of_block.get(&corner).into_iter().flatten();
        found.extend(patches.map(|patch| Found {
            sample: patch.clone(),
            part_of: None,
            by_chance: Vec3::ZERO,
        }));
        let outliers = outliers::spread(&mut found, tracer.scene());
        (together(corner, found, options.packs), outliers)
    })?;
    let outliers = parts.iter().fold(Outliers::default(), |all, (_, outliers)| all.and(*outliers));
    // What lies beside the domain has no block.
    let corners: HashSet<IVec2> = blocks.iter().map(|looks| block_corner(looks[0].cell.corner)).collect();
    let mut beside: Vec<_> =
        patches_of_block.into_iter().filter(|(corner, _)| !corners.contains(corner)).collect();
    beside.sort_by_key(|(corner, _)| (corner.y, corner.x));
    let beside = beside.into_iter().map(|(_, patches)| Samples::from(patches));
    let samples = Samples::join(parts.into_iter().map(|(samples, _)| samples).chain(beside));
    Ok((
        Salf { camera: camera.clone(), margin_px: domain.margin as u32, carried: options.carried, samples },
        outliers,
    ))
}

fn are_of_one_block(a: &Cell, b: &Cell) -> bool {
    block_corner(a.corner) == block_corner(b.corner)
}

/// The samples of one block.
fn together(corner: IVec2, found: Vec<Found>, packs: bool) -> Samples {
    if !packs {
        return Samples::from(found.into_iter().map(|found| found.sample).collect::<Vec<_>>());
    }
    let mut packer = Packer::new(corner);
    found.into_iter().for_each(|found| packer.push(found));
    packer.finish()
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

/// What every cell is sampled with.
struct Baker<'a> {
    tracer: &'a Tracer,
    radiance: &'a dyn Radiance,
    view: &'a View<'a>,
    placement: &'a Placement,
    patterns: &'a Patterns,
}

impl Baker<'_> {
    fn layers(&self, cell: Cell, density: Density, hidden: bool) -> Layers {
        trace_cell(self.tracer, self.view, self.placement, cell, density, hidden)
    }

    /// Looks at the cells of a block.
    fn first_looks(&self, cells: &[Cell]) -> Vec<FirstLook> {
        let of_cell = |&cell: &Cell| {
            let mut density = Density::Coarse;
            let mut layers = self.layers(cell, density, false);
            if layers.has_outline() {
                density = Density::Fine;
                layers = self.layers(cell, density, false);
            }
            (cell, density, layers)
        };
        let looks: Vec<_> = cells.iter().map(of_cell).collect();
        let groups =
            looks.iter().flat_map(|(cell, _, layers)| layers.groups.iter().map(|group| (*cell, group)));
        let mut sampled = self.samples(&groups.collect::<Vec<_>>()).into_iter();
        let first_look = |(cell, density, layers): (Cell, Density, Layers)| {
            let candidates = layers.groups.iter().map(|group| self.candidate(cell, &layers, group));
            let nearest = candidates.zip(&mut sampled).collect();
            let (has_gap, has_pane) = (layers.has_gap, layers.has_pane);
            FirstLook { cell, density, depths: layers.depths(cell), has_gap, has_pane, nearest }
        };
        looks.into_iter().map(first_look).collect()
    }

    /// The samples of surfaces that are of one block, as if they saw all.
    fn samples(&self, groups: &[(Cell, &Group)]) -> Vec<Vec<Found>> {
        let spots: Vec<_> =
            groups.iter().map(|(cell, group)| group.spot(self.tracer.scene(), *cell)).collect();
        let asked: Vec<_> = spots.iter().copied().flatten().collect();
        let mut of_asked = self.radiance.received(&asked, self.view.eye).into_iter();
        let received: Vec<_> =
            spots.iter().map(|spot| spot.and_then(|_| of_asked.next().flatten())).collect();
        let shared = self.shared(groups, &received);
        let samples = |((&(cell, group), received), shared): ((&(Cell, &Group), _), Option<Rc<_>>)| {
            group.samples(self.radiance, self.view, cell, received, shared.as_deref())
        };
        groups.iter().zip(received).zip(shared).map(samples).collect()
    }

    /// The carried light that surfaces share with their neighbours ([`Group::tile`]), where what is own of them is told.
    fn shared(
        &self,
        groups: &[(Cell, &Group)],
        received: &[Option<Received>],
    ) -> Vec<Option<Rc<TowardCells>>> {
        let mut tiles: BTreeMap<Tile, Vec<usize>> = BTreeMap::new();
        for (index, (cell, group)) in groups.iter().enumerate() {
            let is_told = received[index].is_some_and(|received| received.gloss.is_some());
            if is_told && let Some(tile) = group.tile(self.radiance, self.view, *cell) {
                tiles.entry(tile).or_default().push(index);
            }
        }
        let mut shared = vec![None; groups.len()];
        for (tile, members) in tiles.into_iter().filter(|(_, members)| members.len() > 1) {
            let points = members.iter().flat_map(|&index| groups[index].1.weighted_points(self.view));
            let points: Vec<_> = points.filter(|(_, weight)| *weight > 0.0).collect();
            if points.is_empty() {
                continue;
            }
            let asked = Asked {
                radiance: self.radiance,
                view: self.view,
                seed: tile.corner.map(|at| at as u32),
                received: received[members[0]],
                own_only: false,
                blurred: outgoing::blurred_px(self.view, groups[members[0]].1.mean_inverse_depth()),
            };
            let told = Rc::new(TowardCells::ask(&asked, &points, tile.side));
            members.into_iter().for_each(|index| shared[index] = Some(told.clone()));
        }
        shared
    }

    fn candidate(&self, cell: Cell, layers: &Layers, group: &Group) -> Candidate {
        Candidate {
            center: group.center(cell),
            inverse_depth: group.mean_inverse_depth(),
            slope: group.slope,
            viewpoint: group.viewpoint(self.view, cell),
            is_in_front: group.is_nearest && !layers.has_nearer(group, self.view.radius_per_kappa_px),
        }
    }

    /// What the looks at a block's cells found, with what it sees of the aperture, and what else is found there.
    fn second_looks(&self, occluders: &Occluders, looks: &[FirstLook]) -> Vec<Found> {
        let is_pinhole = self.view.optics.aperture_radius == 0.0;
        let may_show = |look: &FirstLook| {
            look.has_pane
                || !is_pinhole && (look.has_gap || occluders.may_reveal(look.cell, look.depths.nearest))
        };
        let behind = |look: &FirstLook| {
            let layers = self.layers(look.cell, look.density, true);
            let seen = |(index, group): (usize, &Group)| {
                let candidate = self.candidate(look.cell, &layers, group);
                self.visibility(occluders, look.cell, &candidate, index)
            };
            let seen: Vec<_> = layers.groups.iter().enumerate().map(seen).collect();
            let groups = layers.groups.into_iter().zip(seen).filter(|(_, seen)| !seen.is_empty());
            groups.collect::<Vec<_>>()
        };
        let behind: Vec<_> = looks.iter().map(|look| may_show(look).then(|| behind(look))).collect();
        let groups = looks
            .iter()
            .zip(&behind)
            .flat_map(|(look, groups)| groups.iter().flatten().map(|(group, _)| (look.cell, group)));
        let mut sampled = self.samples(&groups.collect::<Vec<_>>()).into_iter();
        let mut samples = Vec::new();
        // The quadrants of a cell see about the same: they are not asked one by one.
        let mut push = |seen: &[Seen], found: &[Found]| {
            samples.extend(found.iter().flat_map(|found| seen.iter().filter_map(|seen| past(found, seen))));
        };
        for (look, behind) in looks.iter().zip(&behind) {
            match behind {
                None => look.nearest.iter().enumerate().for_each(|(index, (candidate, found))| {
                    push(&self.visibility(occluders, look.cell, candidate, index), found);
                }),
                Some(groups) => {
                    groups.iter().zip(&mut sampled).for_each(|((_, seen), found)| push(seen, &found))
                }
            }
        }
        samples
    }

    /// What a cell's `index`-th surface sees.
    fn visibility(
        &self,
        occluders: &Occluders,
        cell: Cell,
        candidate: &Candidate,
        index: usize,
    ) -> Vec<Seen> {
        let Self { tracer, view, patterns, .. } = self;
        let Candidate { center, inverse_depth, slope, viewpoint, is_in_front } = *candidate;
        let is_open =
            || is_in_front && !occluders.may_occlude(&Footprint { center, cell, inverse_depth, slope });
        if view.optics.aperture_radius == 0.0 || is_open() {
            return vec![(Visibility::Open, 1.0)];
        }
        let (fineness, number) = (Fineness::of(view, inverse_depth), Patterns::number_of(cell, index));
        visibility::visibility(tracer, view, patterns, viewpoint, fineness, number, |_| true)
    }
}

/// A sample past what hides a part of the aperture from it, or lets only a share of its light through.
fn past(found: &Found, (seen, share): &Seen) -> Option<Found> {
    let sample = &found.sample;
    let visibility = sample.visibility.and(seen)?;
    let (weight, tilt) = (sample.weight * share, sample.tilt * *share);
    Some(Found { sample: Sample { visibility, weight, tilt, ..sample.clone() }, ..*found })
}
