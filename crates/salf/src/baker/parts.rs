//! A light field in parts, each as it is in the whole: what a part of a picture needs is baked square by square, and need not be in
//! memory at once.
//!
//! Samples depend on their own block of the picture, and on the depths around it as far as those may hide or reveal something.
//! A part of the picture is therefore surveyed first, with as much around it ([`PartsBaker::survey_surroundings`]); then its squares are baked, some at
//! a time. The parts of a light field have its camera, its blocks and its hierarchy.

use crate::baker::block_baker::BlockBaker;
use crate::baker::block_samples::{BlockSampler, Surveys};
use crate::baker::map_rows::map_rows;
use crate::baker::occluders::Occluders;
use crate::baker::outliers::Outliers;
use crate::baker::reach::{Bound, Reach, SQUARE_PX};
use crate::baker::{outside_domain, pack_blocks, patches};
use crate::domain::Domain;
use crate::options::BakeOptions;
use crate::salf::{BakedOn, Salf};
use crate::sample::Sample;
use crate::samples::Samples;
use glam::{IVec2, Vec2};
use lens::{Camera, FocusOffset};
use progress::{Cancelled, Progress, Stage};
use std::collections::{HashMap, HashSet};
use surface::SurfaceField;
use trace::{Radiance, Tracer};

/// Bakes parts of one light field.
pub struct PartsBaker<'a> {
    baker: BlockBaker<'a>,
    camera: &'a Camera,
    options: BakeOptions,
    reach: Reach,
}

/// The surroundings of a part of the picture.
pub struct Surroundings {
    /// The squares whose light may reach it, by column and row; row by row.
    pub squares: Vec<IVec2>,
    occluders: Occluders,
    patches: HashMap<IVec2, Vec<Sample>>,
}

/// The footprint of a node is no wider, to either side, px.
const WIDEST_FOOTPRINT_PX: f32 = 32.0;

impl<'a> PartsBaker<'a> {
    /// Prepares to bake parts of a light field for `camera`, which must be valid, and for `focus`.
    pub fn new(
        tracer: &'a Tracer,
        radiance: &'a dyn Radiance,
        camera: &'a Camera,
        options: &BakeOptions,
        focus: &dyn SurfaceField<FocusOffset>,
    ) -> Self {
        let baker = BlockBaker::new(tracer, radiance, camera, options);
        let reach = Reach::new(tracer.scene(), &baker.view, baker.domain, &baker.placement, focus);
        Self { baker, camera, options: *options, reach }
    }

    /// Whether anything may be painted, wherever it is.
    pub fn may_be_painted(&self) -> bool {
        self.reach.may_be_painted
    }

    /// Surveys the surroundings of some pixels of the picture, first and end: the squares whose light may come within `near_px` of
    /// them, and of the squares that lie outside of the picture those that are nearest to them.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn survey_surroundings(
        &self,
        [first, end]: [IVec2; 2],
        near_px: i32,
        progress: &dyn Progress,
    ) -> Result<Surroundings, Cancelled> {
        let apart = |square: IVec2| {
            let [low, high] = self.reach.pixels(square);
            (low - end).max(first - high).max_element().max(0)
        };
        let is_needed = |square: IVec2, bound: Bound| {
            // The nearest pixel of the picture is one of these.
            let [low, high] = self.reach.pixels(square);
            let nearest = ((low + high) / 2).clamp(IVec2::ZERO, self.baker.domain.size - 1);
            let is_own = nearest.cmpge(first).all() && nearest.cmplt(end).all();
            is_own || apart(square) as f32 <= reach_px(bound.radius_px) + near_px as f32
        };
        let needed: Vec<_> =
            self.reach.squares().filter(|(square, bound)| is_needed(*square, *bound)).collect();
        let squares: Vec<IVec2> = needed.iter().map(|(square, _)| *square).collect();
        let occluders = self.survey(&needed, &Stage::new(progress, 0.0, 0.9))?;
        let selected: HashSet<IVec2> = squares.iter().copied().collect();
        let is_selected =
            |corner: IVec2| selected.contains(&self.square_of(self.baker.domain.nearest_block(corner)));
        let patches = patches(&self.baker, &is_selected, &Stage::new(progress, 0.9, 1.0))?;
        Ok(Surroundings { squares, occluders, patches })
    }

    /// The depths of everything that may hide a surface of the needed squares, or reveal one: of squares that lie so near that the parallax
    /// of either against infinity reaches from the one to the other. What lies beyond is taken for infinitely far, and the edges that this
    /// makes are too far away to reveal anything.
    fn survey(&self, needed: &[(IVec2, Bound)], progress: &dyn Progress) -> Result<Occluders, Cancelled> {
        let domain = &self.baker.domain;
        let parallax_px = self.baker.view.radius_per_kappa_px;
        /// In addition to the parallax: cells are up to a block wide.
        const ROOM: f64 = 3.0 * Domain::BLOCK as f64;
        let size = self.reach.size;
        // The squares within the parallax of a square.
        let near = |square: IVec2, bound: Bound| {
            let px = f64::from(bound.inverse_depth) * parallax_px + ROOM;
            let far = (px / f64::from(SQUARE_PX)).ceil().min(f64::from(size.max_element())) as i32;
            let [low, high] = [(square - far).max(IVec2::ZERO), (square + far).min(size - 1)];
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec2::new(x, y)))
        };
        let selected: HashSet<IVec2> = needed.iter().map(|(square, _)| *square).collect();
        let mut surveyed: HashSet<IVec2> = selected.clone();
        needed.iter().for_each(|(square, bound)| surveyed.extend(near(*square, *bound)));
        let hides =
            |(square, bound): &(IVec2, Bound)| near(*square, *bound).any(|near| selected.contains(&near));
        surveyed.extend(self.reach.squares().filter(hides).map(|(square, _)| square));

        let mut squares: Vec<IVec2> = surveyed.into_iter().collect();
        squares.sort_by_key(|square| (square.y, square.x));
        let depths = map_rows(&squares, progress, |&square| {
            let blocks = self.blocks_of(square);
            let cells = blocks.flat_map(|block| domain.cells_of_block(block));
            cells.map(|cell| (cell, self.baker.depths(cell))).collect::<Vec<_>>()
        })?;
        let [low, high] = squares
            .iter()
            .map(|square| self.reach.pixels(*square))
            .reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
            .unwrap_or([IVec2::splat(-domain.margin); 2]);
        let extent = high.min(domain.size + domain.margin) - low;
        Ok(Occluders::new([low, extent], parallax_px, depths.into_iter().flatten()))
    }

    /// The blocks of a square.
    fn blocks_of(&self, square: IVec2) -> impl Iterator<Item = IVec2> + use<> {
        let (side, all) = (SQUARE_PX / Domain::BLOCK, self.baker.domain.blocks());
        let of_square = (0..side * side).map(move |k| square * side + IVec2::new(k % side, k / side));
        of_square.filter(move |block| block.cmplt(all).all())
    }

    /// The square of a block.
    fn square_of(&self, block: IVec2) -> IVec2 {
        block / (SQUARE_PX / Domain::BLOCK)
    }

    /// Bakes some squares (column, row) around a part of the picture.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn bake(
        &self,
        around: &Surroundings,
        squares: &[IVec2],
        progress: &dyn Progress,
    ) -> Result<(Salf, Outliers), Cancelled> {
        let domain = &self.baker.domain;
        let mut blocks: Vec<IVec2> = squares.iter().flat_map(|square| self.blocks_of(*square)).collect();
        blocks.sort_by_key(|block| (block.y, block.x));
        let numbered: Vec<_> = blocks.into_iter().enumerate().collect();
        let content_of = |_, block: IVec2| {
            let patches = around.patches.get(&domain.corner_of_block(block)).map_or(&[][..], Vec::as_slice);
            (Surveys::Made(self.baker.survey_cells(&domain.cells_of_block(block))), patches)
        };
        let (baker, occluders) = (&self.baker, &around.occluders);
        let sampler = BlockSampler { baker, occluders, device: None, content_of };
        let (parts, outliers) = pack_blocks(&sampler, &numbered, progress)?;
        let here: HashSet<IVec2> = squares.iter().copied().collect();
        let is_beside = |corner: &IVec2| {
            let nearest = domain.nearest_block(*corner);
            domain.corner_of_block(nearest) != *corner && here.contains(&self.square_of(nearest))
        };
        let apart = around.patches.iter().filter(|(corner, _)| is_beside(corner));
        let apart: HashMap<_, _> = apart.map(|(corner, patches)| (*corner, patches.clone())).collect();
        let samples = Samples::join(parts.into_iter().chain(outside_domain(apart)));
        let (camera, margin_px) = (self.camera.clone(), domain.margin as u32);
        let (carried, baked_on) = (self.options.carried, BakedOn::Processor);
        Ok((Salf { camera, margin_px, carried, baked_on, samples }, outliers))
    }

    /// Where in the picture the light of each part of the scene may land: of each part, the first and the end of some pixels.
    pub fn footprints(&self) -> impl Iterator<Item = (u32, [Vec2; 2])> {
        self.reach.parts().map(|(part, square, radius)| {
            let [low, high] = self.reach.pixels(square);
            let far = reach_px(radius) + MOST_BLUR_PX;
            (part, [low.as_vec2() - far, high.as_vec2() + far])
        })
    }
}

/// How far levels of the sum spread light at most, px.
const MOST_BLUR_PX: f32 = 80.0;

/// How far the light of a square reaches whose aperture images have this radius, px: see `splat`.
fn reach_px(radius_px: f32) -> f32 {
    radius_px * 1.15 + WIDEST_FOOTPRINT_PX + 8.0
}
