//! How a block of the picture is baked: its cells are looked at twice.

use crate::domain::{Cell, Density, Domain};
use crate::layers::{Group, Layers, Tile, trace_cell};
use crate::margin::standard_margin_px;
use crate::occluders::{Depths, Footprint, Occluders};
use crate::options::BakeOptions;
use crate::outgoing::{self, Asked, TowardCells};
use crate::outliers::{self, Outliers};
use crate::placement::Placement;
use crate::sample::{Sample, Visibility};
use crate::samples::{Found, Packer, Samples, block_corner};
use crate::view::View;
use crate::visibility::{self, Fineness, Patterns, Seen};
use glam::{DVec2, IVec2, Vec3};
use lens::Camera;
use std::collections::BTreeMap;
use std::rc::Rc;
use trace::{Radiance, Received, Tracer, Viewpoint};

/// So many cells are looked at together where nothing is told of more at once: what they take is given back, and taken again by the
/// next ones, from the few pieces of memory that a thread has at hand.
const FEW_CELLS: usize = 4;

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
pub struct FirstLook {
    pub cell: Cell,
    density: Density,
    pub depths: Depths,
    has_gap: bool,
    has_pane: bool,
    /// Its nearest surfaces, each with its samples as if they saw all.
    nearest: Vec<(Candidate, Vec<Found>)>,
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

/// What every cell is sampled with.
pub struct Baker<'a> {
    pub tracer: &'a Tracer,
    pub radiance: &'a dyn Radiance,
    pub view: View<'a>,
    pub placement: Placement,
    pub patterns: Patterns,
    /// Where the pinhole picture is sampled.
    pub domain: Domain,
    packs: bool,
}

impl<'a> Baker<'a> {
    /// For `camera`, which must be valid.
    pub fn new(
        tracer: &'a Tracer,
        radiance: &'a dyn Radiance,
        camera: &'a Camera,
        options: &BakeOptions,
    ) -> Self {
        let view = View::new(camera, options.tolerance_px).telling(options.carried);
        let margin = standard_margin_px(tracer.scene(), &view).max(options.margin_px);
        let domain = Domain::new(camera.width, camera.height, margin);
        let placement = Placement::new(tracer.scene(), &view);
        let packs = options.packs;
        Self { tracer, radiance, view, placement, patterns: Patterns::new(), domain, packs }
    }

    /// The samples of a block that was looked at, and of the surface patches in it.
    pub fn block(
        &self,
        occluders: &Occluders,
        looks: &[FirstLook],
        patches: &[Sample],
    ) -> (Samples, Outliers) {
        let Some(first) = looks.first() else { return Default::default() };
        let mut found: Vec<_> =
            looks.chunks(self.together()).flat_map(|looks| self.second_looks(occluders, looks)).collect();
        let unfound = |patch: &Sample| Found { sample: patch.clone(), part_of: None, by_chance: Vec3::ZERO };
        found.extend(patches.iter().map(unfound));
        let outliers = outliers::spread(&mut found, self.tracer.scene());
        (together(block_corner(first.cell.corner), found, self.packs), outliers)
    }

    /// How many cells of a block are looked at together.
    fn together(&self) -> usize {
        if self.radiance.tells_many() { usize::MAX } else { FEW_CELLS }
    }

    fn layers(&self, cell: Cell, density: Density, hidden: bool) -> Layers {
        trace_cell(self.tracer, &self.view, &self.placement, cell, density, hidden)
    }

    /// The nearest surfaces of a cell, as densely traced as they need.
    fn nearest(&self, cell: Cell) -> (Density, Layers) {
        let layers = self.layers(cell, Density::Coarse, false);
        if layers.has_outline() {
            return (Density::Fine, self.layers(cell, Density::Fine, false));
        }
        (Density::Coarse, layers)
    }

    /// What the chief rays of a cell tell of the depths around it: as [`Self::first_looks`] does, and no more.
    pub fn depths(&self, cell: Cell) -> Depths {
        self.nearest(cell).1.depths(cell)
    }

    /// Looks at the cells of a block.
    pub fn first_looks(&self, cells: &[Cell]) -> Vec<FirstLook> {
        let mut looks = Vec::with_capacity(cells.len());
        cells.chunks(self.together()).for_each(|cells| looks.extend(self.looks_together(cells)));
        looks
    }

    /// Looks at some of them, of which light is told together.
    fn looks_together(&self, cells: &[Cell]) -> impl Iterator<Item = FirstLook> {
        let of_cell = |&cell: &Cell| {
            let (density, layers) = self.nearest(cell);
            (cell, density, layers)
        };
        let looks: Vec<_> = cells.iter().map(of_cell).collect();
        let groups =
            looks.iter().flat_map(|(cell, _, layers)| layers.groups.iter().map(|group| (*cell, group)));
        let mut sampled = self.samples(&groups.collect::<Vec<_>>()).into_iter();
        let first_look = move |(cell, density, layers): (Cell, Density, Layers)| {
            let candidates = layers.groups.iter().map(|group| self.candidate(cell, &layers, group));
            let nearest = candidates.zip(&mut sampled).collect();
            let (has_gap, has_pane) = (layers.has_gap, layers.has_pane);
            FirstLook { cell, density, depths: layers.depths(cell), has_gap, has_pane, nearest }
        };
        looks.into_iter().map(first_look)
    }

    /// The samples of surfaces that are of one block, as if they saw all.
    fn samples(&self, groups: &[(Cell, &Group)]) -> Vec<Vec<Found>> {
        if !self.radiance.tells_many() {
            let of_group =
                |&(cell, group): &(Cell, &Group)| group.samples(self.radiance, &self.view, cell, None, None);
            return groups.iter().map(of_group).collect();
        }
        let spots: Vec<_> =
            groups.iter().map(|(cell, group)| group.spot(self.tracer.scene(), *cell)).collect();
        let asked: Vec<_> = spots.iter().copied().flatten().collect();
        let mut of_asked = self.radiance.received(&asked, self.view.eye).into_iter();
        let received: Vec<_> =
            spots.iter().map(|spot| spot.and_then(|_| of_asked.next().flatten())).collect();
        let shared = self.shared(groups, &received);
        let samples = |((&(cell, group), received), shared): ((&(Cell, &Group), _), Option<Rc<_>>)| {
            group.samples(self.radiance, &self.view, cell, received, shared.as_deref())
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
            if is_told && let Some(tile) = group.tile(self.radiance, &self.view, *cell) {
                tiles.entry(tile).or_default().push(index);
            }
        }
        let mut shared = vec![None; groups.len()];
        for (tile, members) in tiles.into_iter().filter(|(_, members)| members.len() > 1) {
            let points = members.iter().flat_map(|&index| groups[index].1.weighted_points());
            let points: Vec<_> = points.filter(|(_, weight)| *weight > 0.0).collect();
            if points.is_empty() {
                continue;
            }
            let asked = Asked {
                radiance: self.radiance,
                view: &self.view,
                seed: tile.corner.map(|at| at as u32),
                received: received[members[0]],
                own_only: false,
                blurred: outgoing::blurred_px(&self.view, groups[members[0]].1.mean_inverse_depth()),
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
            viewpoint: group.viewpoint(&self.view, cell),
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
