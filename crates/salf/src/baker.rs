//! Baking: from scene, light and camera to the light field.
//!
//! 1. The pinhole picture is sampled, cell by cell ([`crate::baker::layers`]), with four times the rays where an outline passes
//!    through: the nearest surfaces, a sample each or, where their radiance varies, one a quadrant.
//! 2. Their depths tell which of them may be partly occluded, and where hidden ones may show ([`crate::baker::occluders`]).
//! 3. Surfaces edge-on to the aperture, and small bright ones, are sampled on the surface ([`crate::baker::surface_patches`]).
//! 4. For surfaces that may be partly occluded, and only for those, the visibility of the aperture is computed
//!    ([`crate::baker::shadow_rays`]).
//!
//! 5. Gaussian splats are added, and what they hide of all else is taken away ([`crate::baker::splats`]).
//!
//! The samples of each block are packed as soon as they are complete ([`crate::samples`]). Until then the surveys of step 1 are
//! retained or, for large pictures, made again. [`crate::baker::parts`] bakes parts of a picture.

pub mod block_baker;
pub mod block_samples;
pub mod layers;
pub mod map_rows;
pub mod occluders;
pub mod outgoing;
pub mod outliers;
pub mod parts;
pub mod placement;
pub mod reach;
pub mod shadow_rays;
pub mod splats;
pub mod surface_patches;

use crate::baker::block_baker::{BlockBaker, CellSurvey};
use crate::baker::block_samples::{BlockSampler, Surveys};
use crate::baker::map_rows::map_rows;
use crate::baker::occluders::Occluders;
use crate::baker::outliers::Outliers;
use crate::baker::splats::{BlockSamples, SplatBands};
use crate::options::BakeOptions;
use crate::salf::{BakedOn, Salf};
use crate::sample::Sample;
use crate::samples::{Samples, block_corner};
use glam::IVec2;
use lens::Camera;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use std::collections::HashMap;
use trace::{Radiance, SightDevice, Tracer};

/// Surveys, of some 400 bytes a pixel and more, are retained for at most this many pixels; for larger pictures they are made twice.
const MAX_RETAINED_PX: i64 = 1 << 23;

/// The share of a bake's progress for finding the surfaces that are seen.
const SURFACES_SHARE: f32 = 0.35;

/// The share of that for the pinhole picture; the rest is for patches.
const SURVEY_SHARE: f32 = 0.8;

/// Bakes the light field of `camera`'s square aperture. `camera` must be valid. The same input gives the same bits for any
/// number of threads.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn bake(
    tracer: &Tracer,
    radiance: &dyn Radiance,
    camera: &Camera,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<Salf, Cancelled> {
    bake_on(None, tracer, radiance, camera, options, progress).map(|(salf, _)| salf)
}

/// The same as [`bake`], where a `device`, if there is one, answers what of the aperture is visible, as far as it can: to the precision of its
/// floats. Also tells how much light of outliers was spread.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn bake_on(
    device: Option<&dyn SightDevice>,
    tracer: &Tracer,
    radiance: &dyn Radiance,
    camera: &Camera,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(Salf, Outliers), Cancelled> {
    let baker = BlockBaker::new(tracer, radiance, camera, options);
    let domain = baker.domain;
    let IVec2 { x: columns, y: rows } = domain.blocks();
    let retains_surveys = domain.extent().as_i64vec2().element_product() <= MAX_RETAINED_PX;

    let rows: Vec<i32> = (0..rows).collect();
    let surveying = Stage::named(progress, "surfaces", 0.0, SURFACES_SHARE);
    let surveyed = map_rows(&rows, &Stage::new(&surveying, 0.0, SURVEY_SHARE), |&row| {
        // A row of a large picture takes long: what a cancelled one leaves out is never used.
        let columns = (0..columns).take_while(|_| !progress.cancelled());
        let blocks = columns.map(|column| domain.cells_of_block(IVec2::new(column, row)));
        if retains_surveys {
            let surveys: Vec<_> = blocks.map(|cells| baker.survey_cells(&cells)).collect();
            let depths =
                surveys.iter().flatten().map(|survey| (survey.cell, survey.depths)).collect::<Vec<_>>();
            return (depths, surveys);
        }
        let depths = blocks.flatten().map(|cell| (cell, baker.depths(cell)));
        (depths.collect(), Vec::new())
    })?;
    let depths = surveyed.iter().flat_map(|(depths, _)| depths.iter().copied());
    let whole = [IVec2::splat(-domain.margin), domain.extent()];
    let occluders = Occluders::new(whole, baker.view.radius_per_kappa_px, depths);
    let retained: Vec<Vec<CellSurvey>> = surveyed.into_iter().flat_map(|(_, surveys)| surveys).collect();

    let mut patches_of_block = patches(&baker, &|_| true, &Stage::new(&surveying, SURVEY_SHARE, 1.0))?;
    let blocks: Vec<IVec2> = rows.iter().flat_map(|&y| (0..columns).map(move |x| IVec2::new(x, y))).collect();
    let numbered: Vec<_> = blocks.iter().copied().enumerate().collect();
    let looking = Stage::named(progress, "visibility", SURFACES_SHARE, 1.0);
    let device = device.filter(|_| camera.aperture_radius > 0.0);
    let device = device
        .and_then(|device| device.prepare(tracer, &baker.view.aperture_square(), &baker.patterns.all()));
    let content_of = |number: usize, block: IVec2| {
        let patches = patches_of_block.get(&domain.corner_of_block(block)).map_or(&[][..], Vec::as_slice);
        let surveys = match retained.get(number) {
            Some(surveys) => Surveys::Retained(surveys),
            None => Surveys::Made(baker.survey_cells(&domain.cells_of_block(block))),
        };
        (surveys, patches)
    };
    let sampler =
        BlockSampler { baker: &baker, occluders: &occluders, device: device.as_deref(), content_of };
    let (parts, outliers) = pack_blocks(&sampler, &numbered, &looking)?;
    blocks.iter().for_each(|&block| drop(patches_of_block.remove(&domain.corner_of_block(block))));
    let outside = outside_domain(patches_of_block);
    let samples = Samples::join(parts.into_iter().chain(outside));
    let baked_on = if device.is_some() { BakedOn::Card } else { BakedOn::Processor };
    let margin_px = domain.margin as u32;
    Ok((Salf { camera: camera.clone(), margin_px, carried: options.carried, baked_on, samples }, outliers))
}

/// Bakes numbered blocks, in rows, and packs their samples, with those of splats.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn pack_blocks<'a>(
    sampler: &BlockSampler<'a, impl Fn(usize, IVec2) -> (Surveys<'a>, &'a [Sample]) + Sync>,
    blocks: &[(usize, IVec2)],
    progress: &dyn Progress,
) -> Result<(Vec<Samples>, Outliers), Cancelled> {
    let baker = sampler.baker;
    let merge = |all: Outliers, outliers: &Outliers| all.merged(*outliers);
    let corner = |block: IVec2| baker.domain.corner_of_block(block);
    let Some(splats) = &baker.tracer.scene().splats else {
        let (samples, outliers): (Vec<_>, Vec<_>) = sampler
            .sample(blocks, progress, |block, (baked, outliers)| {
                (baker.pack(corner(block), baked), outliers)
            })?
            .into_iter()
            .unzip();
        return Ok((samples, outliers.iter().fold(Outliers::default(), merge)));
    };
    let bands = SplatBands::new(baker, splats);
    let (mut packed, mut all) = (Vec::with_capacity(blocks.len()), Outliers::default());
    for band in blocks.chunk_by(|(_, a), (_, b)| bands.band(a.y) == bands.band(b.y)) {
        let share = |done: usize| done as f32 / blocks.len() as f32;
        let stage = Stage::new(progress, share(packed.len()), share(packed.len() + band.len()));
        let (mut baked, outliers): (Vec<BlockSamples>, Vec<_>) = sampler
            .sample(band, &Stage::new(&stage, 0.0, 0.1), |block, (baked, outliers)| {
                ((corner(block), baked), outliers)
            })?
            .into_iter()
            .unzip();
        all = outliers.iter().fold(all, merge);
        bands.add(&mut baked, &Stage::new(&stage, 0.1, 1.0))?;
        packed.par_extend(baked.into_par_iter().map(|(corner, baked)| baker.pack(corner, baked)));
    }
    Ok((packed, all))
}

/// The samples that are placed on surfaces, of selected blocks, by the corners of their blocks.
pub fn patches(
    baker: &BlockBaker,
    is_selected: &(dyn Fn(IVec2) -> bool + Sync),
    progress: &dyn Progress,
) -> Result<HashMap<IVec2, Vec<Sample>>, Cancelled> {
    let triangles: Vec<u32> = baker.placement.on_surface().collect();
    let chunks: Vec<_> = triangles.chunks(256).collect();
    let patches = map_rows(&chunks, progress, |chunk| {
        let of = |&triangle: &u32| surface_patches::samples(baker, triangle, is_selected);
        chunk.iter().flat_map(of).collect::<Vec<_>>()
    })?;
    let mut of_block: HashMap<IVec2, Vec<Sample>> = HashMap::new();
    for patch in patches.into_iter().flatten() {
        of_block.entry(block_corner(patch.center.floor().as_ivec2())).or_default().push(patch);
    }
    Ok(of_block)
}

/// The given samples of the blocks outside the domain, block by block, row by row.
pub fn outside_domain(patches: HashMap<IVec2, Vec<Sample>>) -> impl Iterator<Item = Samples> {
    let mut blocks: Vec<_> = patches.into_iter().collect();
    blocks.sort_by_key(|(corner, _)| (corner.y, corner.x));
    blocks.into_iter().map(|(_, patches)| Samples::from(patches))
}
