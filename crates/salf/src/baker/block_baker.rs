//! Bakes blocks of the picture: each of its cells is traced twice.

use crate::baker::layers::{Group, Layers, Tile, trace_cell};
use crate::baker::occluders::{Depths, Footprint, Occluders};
use crate::baker::outgoing::{self, ApertureRadiance, RadianceQuery};
use crate::baker::outliers::{self, Outliers};
use crate::baker::placement::Placement;
use crate::baker::shadow_rays::{self, Patterns, VisibilityRequest, VisiblePart};
use crate::domain::{Cell, Density, Domain};
use crate::margin::standard_margin_px;
use crate::options::BakeOptions;
use crate::sample::{Sample, Visibility};
use crate::samples::{BakedSample, Packer, Samples};
use crate::view::View;
use glam::{DVec2, IVec2, Vec3};
use lens::Camera;
use std::collections::BTreeMap;
use std::rc::Rc;
use trace::{IncidentLight, Radiance, Tracer, Viewpoint};

/// The number of cells that are traced together unless light is computed for more at once: few, so that the allocator reuses the
/// same memory for the next ones.
const BATCH_CELLS: usize = TILE_CELLS;

/// The number of cells, one after the other along Morton's curve, whose occluders are searched for together.
const TILE_CELLS: usize = 16;

/// A surface of a cell whose visibility has not been computed yet.
struct Candidate {
    center: DVec2,
    inverse_depth: f64,
    slope: DVec2,
    /// Where its visibility is computed from.
    viewpoint: Viewpoint,
    /// Whether no other surface of its own cell is in front of it.
    is_in_front: bool,
}

/// The result of tracing a cell's nearest surfaces.
pub struct CellSurvey {
    /// The cell that was surveyed.
    pub cell: Cell,
    density: Density,
    /// The depths that its chief rays found around it.
    pub depths: Depths,
    has_gap: bool,
    has_pane: bool,
    /// Its nearest surfaces, each with its samples as if they saw all.
    surfaces: Vec<(Candidate, Vec<BakedSample>)>,
}

/// What is asked about the visibility of the aperture from some cells, before they are sampled.
struct CellQuestions {
    /// What may show behind the nearest surfaces, by cell.
    behind: Vec<Option<Layers>>,
    /// By cell and surface; `None` for surfaces that see all of it.
    requests: Vec<Vec<Option<VisibilityRequest>>>,
}

/// What is asked about the visibility of the aperture from a block.
pub struct BlockQuestions(Vec<CellQuestions>);

/// What every cell is sampled with.
pub struct BlockBaker<'a> {
    /// Traces the rays.
    pub tracer: &'a Tracer,
    /// The light that surfaces send.
    pub radiance: &'a dyn Radiance,
    /// The camera's view.
    pub view: View<'a>,
    /// Which triangles have samples of their own.
    pub placement: Placement,
    /// Where on the aperture shadow rays end.
    pub patterns: Patterns,
    /// Where the pinhole picture is sampled.
    pub domain: Domain,
    /// See [`BakeOptions::pixel_px`].
    pub pixel_px: f64,
    /// See [`BakeOptions::splat_cells`].
    pub splat_cells: u32,
    packs: bool,
}

impl<'a> BlockBaker<'a> {
    /// Prepares to bake blocks of the light field for `camera`, which must be valid.
    pub fn new(
        tracer: &'a Tracer,
        radiance: &'a dyn Radiance,
        camera: &'a Camera,
        options: &BakeOptions,
    ) -> Self {
        let view = View::new(camera, options.tolerance_px).with_carried(options.carried);
        let margin = standard_margin_px(tracer.scene(), &view).max(options.margin_px);
        let domain = Domain::new(camera.width, camera.height, margin);
        let placement = Placement::new(tracer.scene(), &view);
        let BakeOptions { packs, pixel_px, splat_cells, .. } = *options;
        Self {
            tracer,
            radiance,
            view,
            placement,
            patterns: Patterns::new(),
            domain,
            pixel_px,
            splat_cells,
            packs,
        }
    }

    /// Packs the samples of the block whose upper left corner is at `corner`, px.
    pub fn pack(&self, corner: IVec2, baked: Vec<BakedSample>) -> Samples {
        if !self.packs {
            return Samples::from(baked.into_iter().map(|baked| baked.sample).collect::<Vec<_>>());
        }
        let splats = self.tracer.scene().splats.as_ref().map_or(0..0, |splats| splats.triangles());
        let mut packer = Packer::new(corner, splats);
        baked.into_iter().for_each(|baked| packer.push(baked));
        packer.finish()
    }

    /// The samples of a block from the surveys of its cells, and of the surface patches in it.
    pub fn bake_block(
        &self,
        occluders: &Occluders,
        surveys: &[CellSurvey],
        patches: &[Sample],
    ) -> (Vec<BakedSample>, Outliers) {
        let sampled = surveys.chunks(self.batch_cells()).flat_map(|surveys| {
            let questions = self.questions(occluders, surveys);
            let visible = self.answers_on_processor(&questions);
            self.sample_visible(surveys, questions, visible)
        });
        self.finish_block(sampled.collect(), surveys, patches)
    }

    /// What [`Self::bake_block`] asks about visibility, for a device to answer.
    pub fn block_questions(&self, occluders: &Occluders, surveys: &[CellSurvey]) -> BlockQuestions {
        BlockQuestions(
            surveys.chunks(self.batch_cells()).map(|surveys| self.questions(occluders, surveys)).collect(),
        )
    }

    /// The samples of a block once it is known what is visible: of each of its [questions](Self::block_questions), in order.
    pub fn bake_answered(
        &self,
        surveys: &[CellSurvey],
        BlockQuestions(questions): BlockQuestions,
        visible: impl IntoIterator<Item = Vec<VisiblePart>>,
        patches: &[Sample],
    ) -> (Vec<BakedSample>, Outliers) {
        let mut visible = visible.into_iter();
        let sampled = surveys.chunks(self.batch_cells()).zip(questions).flat_map(|(surveys, questions)| {
            let visible = questions.answered(&mut visible);
            self.sample_visible(surveys, questions, visible)
        });
        self.finish_block(sampled.collect(), surveys, patches)
    }

    fn finish_block(
        &self,
        mut baked: Vec<BakedSample>,
        surveys: &[CellSurvey],
        patches: &[Sample],
    ) -> (Vec<BakedSample>, Outliers) {
        if surveys.is_empty() {
            return Default::default();
        }
        let unplaced =
            |patch: &Sample| BakedSample { sample: patch.clone(), part_of: None, noisy: Vec3::ZERO };
        baked.extend(patches.iter().map(unplaced));
        let outliers = outliers::spread_outliers(&mut baked, self.tracer.scene());
        (baked, outliers)
    }

    /// The number of cells of a block that are traced together.
    fn batch_cells(&self) -> usize {
        if self.radiance.supports_batches() { usize::MAX } else { BATCH_CELLS }
    }

    fn trace_layers(&self, cell: Cell, density: Density, hidden: bool) -> Layers {
        trace_cell(self.tracer, &self.view, &self.placement, cell, density, hidden)
    }

    /// The nearest surfaces of a cell, as densely traced as they need.
    fn trace_nearest(&self, cell: Cell) -> (Density, Layers) {
        let layers = self.trace_layers(cell, Density::Coarse, false);
        if layers.has_outline() {
            return (Density::Fine, self.trace_layers(cell, Density::Fine, false));
        }
        (Density::Coarse, layers)
    }

    /// The depths around a cell as its chief rays find them: the same as those of [`Self::survey_cells`].
    pub fn depths(&self, cell: Cell) -> Depths {
        self.trace_nearest(cell).1.depths(cell)
    }

    /// Looks at what each of the cells of a block shows; one survey for each, in order.
    pub fn survey_cells(&self, cells: &[Cell]) -> Vec<CellSurvey> {
        let mut surveys = Vec::with_capacity(cells.len());
        cells.chunks(self.batch_cells()).for_each(|cells| surveys.extend(self.survey_batch(cells)));
        surveys
    }

    /// Surveys cells whose light is computed together.
    fn survey_batch(&self, cells: &[Cell]) -> impl Iterator<Item = CellSurvey> {
        let of_cell = |&cell: &Cell| {
            let (density, layers) = self.trace_nearest(cell);
            (cell, density, layers)
        };
        let traced: Vec<_> = cells.iter().map(of_cell).collect();
        let groups =
            traced.iter().flat_map(|(cell, _, layers)| layers.groups.iter().map(|group| (*cell, group)));
        let mut sampled = self.sample_groups(&groups.collect::<Vec<_>>()).into_iter();
        let survey = move |(cell, density, layers): (Cell, Density, Layers)| {
            let candidates = layers.groups.iter().map(|group| self.candidate(cell, &layers, group));
            let nearest = candidates.zip(&mut sampled).collect();
            let (has_gap, has_pane) = (layers.has_gap, layers.has_pane);
            CellSurvey { cell, density, depths: layers.depths(cell), has_gap, has_pane, surfaces: nearest }
        };
        traced.into_iter().map(survey)
    }

    /// The samples of surfaces that are of one block, as if they saw all.
    fn sample_groups(&self, groups: &[(Cell, &Group)]) -> Vec<Vec<BakedSample>> {
        if !self.radiance.supports_batches() {
            let of_group = |&(cell, group): &(Cell, &Group)| {
                group.baked_samples(self.radiance, &self.view, cell, None, None)
            };
            return groups.iter().map(of_group).collect();
        }
        let points_of_groups: Vec<_> =
            groups.iter().map(|(cell, group)| group.shading_point(self.tracer.scene(), *cell)).collect();
        let queries: Vec<_> = points_of_groups.iter().copied().flatten().collect();
        let mut incident_lights = self.radiance.incident_batch(&queries, self.view.eye).into_iter();
        let incident: Vec<_> = points_of_groups
            .iter()
            .map(|point| point.and_then(|_| incident_lights.next().flatten()))
            .collect();
        let shared = self.shared_carried(groups, &incident);
        let samples = |((&(cell, group), received), shared): ((&(Cell, &Group), _), Option<Rc<_>>)| {
            group.baked_samples(self.radiance, &self.view, cell, received, shared.as_deref())
        };
        groups.iter().zip(incident).zip(shared).map(samples).collect()
    }

    /// The carried light that surfaces share with their neighbours ([`Group::tile`]), where their own light is interpolated.
    fn shared_carried(
        &self,
        groups: &[(Cell, &Group)],
        incident: &[Option<IncidentLight>],
    ) -> Vec<Option<Rc<ApertureRadiance>>> {
        let mut tiles: BTreeMap<Tile, Vec<usize>> = BTreeMap::new();
        for (index, (cell, group)) in groups.iter().enumerate() {
            let is_own_interpolated = incident[index].is_some_and(|incident| incident.gloss.is_some());
            if is_own_interpolated && let Some(tile) = group.tile(self.radiance, &self.view, *cell) {
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
            let query = RadianceQuery {
                radiance: self.radiance,
                view: &self.view,
                seed: tile.corner.map(|at| at as u32),
                incident: incident[members[0]],
                own_only: false,
                blurred: outgoing::blurred_px(&self.view, groups[members[0]].1.mean_inverse_depth()),
            };
            let radiance = Rc::new(ApertureRadiance::gather(&query, &points, tile.side));
            members.into_iter().for_each(|index| shared[index] = Some(radiance.clone()));
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

    /// Traces what may show behind the nearest surfaces of some cells, and asks what of the aperture is visible from all of them.
    fn questions(&self, occluders: &Occluders, surveys: &[CellSurvey]) -> CellQuestions {
        let is_pinhole = self.view.optics.aperture_radius == 0.0;
        let may_show = |survey: &CellSurvey| {
            survey.has_pane
                || !is_pinhole && (survey.has_gap || occluders.may_reveal(survey.cell, survey.depths.nearest))
        };
        let behind = |survey: &CellSurvey| self.trace_layers(survey.cell, survey.density, true);
        let behind: Vec<_> = surveys.iter().map(|survey| may_show(survey).then(|| behind(survey))).collect();
        let request = |cell: Cell, (index, candidate): (usize, &Candidate)| {
            let Candidate { viewpoint, inverse_depth, .. } = *candidate;
            let number = Patterns::number_of(cell, index);
            let request = VisibilityRequest { from: viewpoint, inverse_depth, number };
            (!self.is_open(occluders, cell, candidate)).then_some(request)
        };
        let requests = |(survey, behind): (&CellSurvey, &Option<Layers>)| -> Vec<_> {
            let request = |at: (usize, &Candidate)| request(survey.cell, at);
            match behind {
                None => {
                    let nearest = survey.surfaces.iter().map(|(candidate, _)| candidate);
                    nearest.enumerate().map(request).collect()
                }
                Some(layers) => {
                    let all = layers.groups.iter().map(|group| self.candidate(survey.cell, layers, group));
                    all.enumerate().map(|(index, candidate)| request((index, &candidate))).collect()
                }
            }
        };
        let requests = surveys.iter().zip(&behind).map(requests).collect();
        CellQuestions { behind, requests }
    }

    /// Whether a surface certainly sees all of the aperture.
    fn is_open(&self, occluders: &Occluders, cell: Cell, candidate: &Candidate) -> bool {
        let Candidate { center, inverse_depth, slope, is_in_front, .. } = *candidate;
        let may_be_hidden = || occluders.may_occlude(&Footprint { center, cell, inverse_depth, slope });
        self.view.optics.aperture_radius == 0.0 || is_in_front && !may_be_hidden()
    }

    /// The answers to questions about some cells, by the processor: what may hide something from cells that lie together is searched for once.
    fn answers_on_processor(&self, questions: &CellQuestions) -> Vec<Vec<Vec<VisiblePart>>> {
        let Self { tracer, view, patterns, .. } = self;
        let of_tile = |requests: &[Vec<Option<VisibilityRequest>>]| {
            let requests: Vec<_> = requests.iter().flatten().flatten().copied().collect();
            shadow_rays::visible_parts_of_many(tracer, view, patterns, &requests)
        };
        questions.answered(&mut questions.requests.chunks(TILE_CELLS).flat_map(of_tile))
    }

    /// The samples of a block's cells with their visibility: those of the surveys, and those of surfaces behind them.
    fn sample_visible(
        &self,
        surveys: &[CellSurvey],
        CellQuestions { behind, .. }: CellQuestions,
        visible: Vec<Vec<Vec<VisiblePart>>>,
    ) -> Vec<BakedSample> {
        let behind: Vec<Option<Vec<_>>> = behind
            .into_iter()
            .zip(&visible)
            .map(|(layers, visible)| {
                let groups = layers?.groups.into_iter().zip(visible);
                Some(groups.filter(|(_, parts)| !parts.is_empty()).collect())
            })
            .collect();
        let groups = surveys
            .iter()
            .zip(&behind)
            .flat_map(|(survey, groups)| groups.iter().flatten().map(|(group, _)| (survey.cell, group)));
        let mut sampled = self.sample_groups(&groups.collect::<Vec<_>>()).into_iter();
        let mut samples = Vec::new();
        // The quadrants of a cell have nearly the same visibility: it is computed once.
        let mut push = |parts: &[VisiblePart], baked: &[BakedSample]| {
            samples.extend(
                baked.iter().flat_map(|sample| parts.iter().filter_map(|part| occluded(sample, part))),
            );
        };
        for ((survey, behind), visible) in surveys.iter().zip(&behind).zip(&visible) {
            match behind {
                None => {
                    survey.surfaces.iter().zip(visible).for_each(|((_, baked), parts)| push(parts, baked));
                }
                Some(groups) => {
                    groups.iter().zip(&mut sampled).for_each(|((_, parts), baked)| push(parts, &baked))
                }
            }
        }
        samples
    }
}

impl CellQuestions {
    /// What is visible from each surface of each cell, if these are the answers to the requests in their order.
    fn answered(&self, answers: &mut impl Iterator<Item = Vec<VisiblePart>>) -> Vec<Vec<Vec<VisiblePart>>> {
        let mut parts = |request: &Option<VisibilityRequest>| match request {
            None => vec![(Visibility::Open, 1.0)],
            Some(_) => answers.next().expect("every request is answered"),
        };
        self.requests.iter().map(|cell| cell.iter().map(&mut parts).collect()).collect()
    }
}

impl BlockQuestions {
    /// The requests, in the order in which they are answered.
    pub fn requests(&self) -> impl Iterator<Item = VisibilityRequest> {
        self.0.iter().flat_map(|questions| &questions.requests).flatten().flatten().copied()
    }
}

/// A sample past what hides a part of the aperture from it, or lets only a share of its light through.
fn occluded(baked: &BakedSample, (visibility, share): &VisiblePart) -> Option<BakedSample> {
    let sample = &baked.sample;
    let visibility = sample.visibility.intersection(visibility)?;
    let (weight, tilt) = (sample.weight * share, sample.tilt * *share);
    Some(BakedSample { sample: Sample { visibility, weight, tilt, ..sample.clone() }, ..*baked })
}
