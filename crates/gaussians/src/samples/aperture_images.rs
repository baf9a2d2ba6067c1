//! What of each cluster each cell of the aperture sees.

use super::clusters::{Cluster, Clusters};
use crate::view::{EyeRaster, Follow, GaussianView, Hit, LANES, LaneHits, RayGrid, TileRow};
use glam::{DVec2, DVec3, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// A cluster as the cells of the aperture see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ApertureImage {
    /// For each cell, row 0 at v = −R, column 0 at u = −R: the share of a ray from it through the cluster that its members send, times the area that a pixel of
    /// the cluster's tilted surface takes from there, px².
    pub shares: Box<[f32]>,
    /// Linear RGB radiance: the mean over the cells, by share; 0 where no cell sees it.
    pub radiance: Vec3,
}

/// Rays of a pixel's side of the grid that finds candidates: tiles of 4 px.
const GRID_RAYS_PER_PX: u32 = 2;

/// A ray toward a cluster: its place on the grid, and which cluster.
#[derive(Clone, Copy)]
struct Target {
    tile_row: u32,
    tile_column: u32,
    cluster: usize,
}

/// The images of clusters over `cells` × `cells` cells of the square aperture: for each, a ray from the cell's middle through the cluster,
///
/// ```text
/// D = (x, y)/z − U/z      share = Σ w of members · max(0, 1 − U·∇(1/z))
/// ```
///
/// The second factor is exact for a plane: how its pixels grow as the eye moves to U.
///
/// # Errors
/// `progress` cancels.
///
/// # Panics
/// `cells` is 0.
pub fn aperture_images(
    view: &GaussianView<'_>,
    clusters: &Clusters,
    cells: u32,
    progress: &dyn Progress,
) -> Result<Vec<ApertureImage>, Cancelled> {
    assert!(cells > 0);
    let count = (cells * cells) as usize;
    let shares: Box<[f32]> = vec![0.0; count].into();
    let mut images = vec![ApertureImage { shares, radiance: Vec3::ZERO }; clusters.list.len()];
    let grid = grid_of_all(view, clusters);
    for cell in 0..count {
        progress.report(cell as f32 / count as f32);
        let middle = |index: usize| (2.0 * index as f64 + 1.0) / f64::from(cells) - 1.0;
        let u = DVec2::new(middle(cell % cells as usize), middle(cell / cells as usize));
        let bake = CellBake::new(view, clusters, &grid, u * view.optics().aperture_radius);
        for (cluster, share, light) in bake.run(progress)? {
            images[cluster].shares[cell] = share;
            images[cluster].radiance += light;
        }
    }
    for image in &mut images {
        let sum: f32 = image.shares.iter().sum();
        image.radiance = if sum > 0.0 { image.radiance / sum } else { Vec3::ZERO };
    }
    Ok(images)
}

/// A grid that holds the places of all clusters, whatever part of the aperture they are viewed from.
fn grid_of_all(view: &GaussianView<'_>, clusters: &Clusters) -> RayGrid {
    let camera = view.camera();
    let [width, height] = [camera.width, camera.height].map(f64::from);
    let optics = view.optics();
    let beyond = |cluster: &Cluster| {
        let outside = (-cluster.pixel).max(cluster.pixel - DVec2::new(width, height)).max_element().max(0.0);
        outside + optics.splat_radius_px(optics.standard_kappa(cluster.inverse_depth)).abs()
    };
    let margin = clusters.list.iter().map(beyond).fold(0.0, f64::max);
    // What is so near that it lies pictures away is seen at the edge of the grid.
    let margin = margin.min(8.0 * width.max(height)).ceil() as u32 + 1;
    RayGrid::new(camera.width, camera.height, margin, GRID_RAYS_PER_PX)
}

/// The rays of one cell.
struct CellBake<'v> {
    raster: EyeRaster<'v>,
    clusters: &'v Clusters,
    /// In the order of tiles.
    targets: Vec<Target>,
}

impl<'v> CellBake<'v> {
    fn new(view: &'v GaussianView<'v>, clusters: &'v Clusters, grid: &'v RayGrid, u: DVec2) -> Self {
        let optics = view.optics();
        let target = |(index, cluster): (usize, &Cluster)| {
            let kappa = optics.standard_kappa(cluster.inverse_depth);
            let shift = kappa * u / optics.tan_half_yfov * optics.half_height_px;
            let [tile_column, tile_row] = grid.tile_at(cluster.pixel + DVec2::new(shift.x, -shift.y));
            Target { tile_row, tile_column, cluster: index }
        };
        let mut targets: Vec<Target> = clusters.list.par_iter().enumerate().map(target).collect();
        targets.par_sort_unstable_by_key(|target| (target.tile_row, target.tile_column, target.cluster));
        Self { raster: EyeRaster::new(view, u, grid), clusters, targets }
    }

    /// Share and light of each cluster that the cell sees.
    fn run(&self, progress: &dyn Progress) -> Result<Vec<(usize, f32, Vec3)>, Cancelled> {
        let rows: Vec<&[Target]> = self.targets.chunk_by(|a, b| a.tile_row == b.tile_row).collect();
        let row = |targets: &&[Target]| {
            progress.check()?;
            Ok(self.run_row(&self.raster.tile_row(targets[0].tile_row), targets))
        };
        let results: Result<Vec<_>, Cancelled> = rows.par_iter().map(row).collect();
        Ok(results?.into_iter().flatten().collect())
    }

    fn run_row(&self, tiles: &TileRow<'_>, targets: &[Target]) -> Vec<(usize, f32, Vec3)> {
        let (mut results, mut directions, mut lanes) = (Vec::new(), Vec::new(), LaneHits::default());
        for tile in targets.chunk_by(|a, b| a.tile_column == b.tile_column) {
            let tracer = tiles.tracer(&self.raster.eye, tile[0].tile_column);
            for targets in tile.chunks(LANES) {
                directions.clear();
                directions.extend(targets.iter().map(|target| self.direction(target)));
                tracer.trace(&directions, Follow::Visible, &mut lanes);
                for (target, hits) in targets.iter().zip(&lanes.hits) {
                    let (share, light) = self.share(target.cluster, hits);
                    if share > 0.0 {
                        results.push((target.cluster, share, light));
                    }
                }
            }
        }
        results
    }

    /// The direction of the ray through a cluster.
    fn direction(&self, target: &Target) -> DVec3 {
        let cluster = &self.clusters.list[target.cluster];
        let chief = self.raster.eye.view().direction(DVec2::ZERO, cluster.pixel);
        chief - (self.raster.eye.point() * cluster.inverse_depth).extend(0.0)
    }

    /// What the members of a cluster send along the ray through it, and its light.
    fn share(&self, index: usize, hits: &[Hit]) -> (f32, Vec3) {
        let cluster = &self.clusters.list[index];
        let members = self.clusters.members(cluster);
        let area = (1.0 - self.raster.eye.point().dot(cluster.gradient)).max(0.0);
        let (mut share, mut light) = (0.0, Vec3::ZERO);
        for hit in hits.iter().filter(|hit| members.binary_search(&hit.splat).is_ok()) {
            let weight = (hit.weight * area) as f32;
            share += weight;
            light += weight * self.raster.radiance(hit.splat);
        }
        (share, light * self.raster.light(hits).gain)
    }
}
