//! Gaussian splats in the light field.
//!
//! The splats on a pixel's chief ray are clusters ([`gaussians::cluster_picture`]), a sample each, with the address of the heaviest splat. Toward each of
//! 8 × 8 cells of the aperture (4 × 4 for rough pictures) a cluster has a share, and whatever else the light field shows has what splats in front of it let through. A share is a weight
//! and a pattern of bits ([`share_bits`]), like that of a pane, so that samples of splats are samples like all others.

mod share_bits;

use crate::baker::block_baker::BlockBaker;
use crate::domain::{Cell, Domain};
use crate::sample::{Sample, Visibility};
use crate::samples::{BakedSample, block_corner};
use gaussians::{
    ApertureImages, ApertureScene, ClusterOptions, Clusters, GaussianView, PicturePoint, aperture_images,
    cluster_picture,
};
use glam::{DVec2, DVec3, IVec2, Vec2, Vec3};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use scene::PlacedCloud;
use share_bits::{COARSE_BELOW_PX2, share_bits};
use std::collections::HashMap;

/// Pixels of a band.
const BAND_PX: i64 = 1 << 18;

/// Below this tolerance, px, clusters are looked up on rays at most a quarter of a pixel away, from it on on those of pixels.
const EXACT_BELOW_PX: f64 = 1.0;

/// The samples of a block, and the corner of the block.
pub type BlockSamples = (IVec2, Vec<BakedSample>);

/// The splats of a light field that is baked in bands of blocks: the images of all cells of a band are in memory at once, and its samples before they are
/// packed.
pub struct SplatBands<'a> {
    baker: &'a BlockBaker<'a>,
    splats: &'a PlacedCloud,
    view: GaussianView<'a>,
}

impl<'a> SplatBands<'a> {
    /// For the light field of `baker`.
    pub fn new(baker: &'a BlockBaker<'a>, splats: &'a PlacedCloud) -> Self {
        let camera = baker.view.camera;
        let view = GaussianView::with_pixel(&splats.cloud, &splats.placement, camera, baker.pixel_px);
        Self { baker, splats, view }
    }

    /// The band in which a row of blocks lies.
    pub fn band(&self, row: i32) -> i32 {
        let row_px = i64::from(self.baker.domain.extent().x) * i64::from(Domain::BLOCK);
        row / (BAND_PX / row_px).max(1) as i32
    }

    /// Adds the samples of splats to those of the blocks of a band, which are in rows, and takes from those what splats in front of them hide.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn add(&self, blocks: &mut [BlockSamples], progress: &dyn Progress) -> Result<(), Cancelled> {
        let clusters = self.clusters(blocks, &Stage::new(progress, 0.0, 0.1))?;
        let baked = blocks.iter().flat_map(|(_, samples)| samples);
        let points: Vec<PicturePoint> = baked.map(|baked| point_of(&baked.sample)).collect();
        let scene = ApertureScene {
            view: &self.view,
            clusters: &clusters,
            points: &points,
            ray_end: &|u, direction| self.ray_end(u, direction),
            margin_px: self.baker.domain.margin as u32,
            coarse_below_px2: COARSE_BELOW_PX2,
            rays_per_px: if self.baker.view.tolerance_px < EXACT_BELOW_PX { 2 } else { 1 },
        };
        let cells = if self.view.optics().aperture_radius == 0.0 { 1 } else { self.baker.splat_cells };
        let images = aperture_images(&scene, cells, &Stage::new(progress, 0.1, 1.0))?;

        let mut first = 0;
        for (_, samples) in blocks.iter_mut() {
            let numbers = first..first + samples.len();
            first = numbers.end;
            let veiled = |(number, baked)| veiled(baked, images.transmittances(number), number);
            *samples = numbers.zip(std::mem::take(samples)).filter_map(veiled).collect();
        }
        let block_at: HashMap<IVec2, usize> =
            blocks.iter().enumerate().map(|(index, (corner, _))| (*corner, index)).collect();
        let sample = |number: usize| self.sample(&clusters, &images, number);
        let samples: Vec<_> = (0..clusters.list.len()).into_par_iter().filter_map(sample).collect();
        for baked in samples {
            let corner = block_corner(baked.sample.center.floor().as_ivec2());
            // Other blocks of these rows are not wanted.
            if let Some(&index) = block_at.get(&corner) {
                blocks[index].1.push(baked);
            }
        }
        Ok(())
    }

    /// The clusters of the rows of these blocks.
    fn clusters(&self, blocks: &[BlockSamples], progress: &dyn Progress) -> Result<Clusters, Cancelled> {
        let row = |(corner, _): &BlockSamples| corner.y + self.baker.domain.margin;
        let first = blocks.iter().map(row).min().unwrap_or(0);
        let end = blocks.iter().map(row).max().unwrap_or(0) + Domain::BLOCK;
        let extent_px = self.baker.view.tolerance_px.max(self.baker.pixel_px);
        let options = ClusterOptions {
            extent_px,
            gap_px: 0.5 * extent_px,
            margin_px: self.baker.domain.margin as u32,
            rows: Some([first, end].map(|row| row as u32)),
        };
        cluster_picture(&self.view, &options, progress)
    }

    /// The depth of the nearest surface of a mesh along a ray from the aperture.
    fn ray_end(&self, u: DVec2, direction: DVec3) -> f64 {
        let camera = self.baker.view.camera;
        let ray = trace::Ray {
            origin: camera.world_from_camera(u.extend(0.0)),
            direction: camera.world_direction(direction),
            t_min: 0.0,
            t_max: f64::INFINITY,
            skip: None,
        };
        self.baker.tracer.first_hit(&ray).map_or(f64::INFINITY, |hit| hit.t)
    }

    /// The sample of a cluster; `None` if no cell of the aperture sees it.
    fn sample(&self, clusters: &Clusters, images: &ApertureImages, number: usize) -> Option<BakedSample> {
        let cluster = &clusters.list[number];
        let corner = cluster.pixel.floor().as_ivec2();
        let seed = [corner.x as u32, corner.y as u32, cluster.heaviest];
        let (weight, visibility) = share_bits(images.shares(number), &Visibility::Open, seed)?;
        let sample = Sample {
            center: cluster.pixel.as_vec2(),
            half_size: Vec2::splat(0.5),
            inverse_depth: cluster.inverse_depth as f32,
            weight,
            tilt: Vec2::ZERO,
            radiance: images.radiance(number),
            surface: Some(self.splats.address(self.view.cloud_index(cluster.heaviest) as u32)),
            is_carried: false,
            visibility,
        };
        Some(BakedSample { sample, part_of: Some((Cell { corner, side: 1 }, u64::MAX)), noisy: Vec3::ZERO })
    }
}

fn point_of(sample: &Sample) -> PicturePoint {
    PicturePoint { pixel: sample.center.as_dvec2(), inverse_depth: sample.inverse_depth.into() }
}

/// A sample behind splats; `None` if they hide it.
fn veiled(
    baked: BakedSample,
    transmittances: impl Iterator<Item = f32>,
    number: usize,
) -> Option<BakedSample> {
    let corner = baked.sample.center.floor().as_ivec2();
    let seed = [corner.x as u32, corner.y as u32, number as u32];
    let (share, visibility) = share_bits(transmittances, &baked.sample.visibility, seed)?;
    let (weight, tilt) = (baked.sample.weight * share, baked.sample.tilt * share);
    Some(BakedSample { sample: Sample { visibility, weight, tilt, ..baked.sample }, ..baked })
}
