//! What of each cluster, and of what lies behind splats, each cell of the aperture sees.

use super::clusters::{Cluster, Clusters};
use crate::view::{EyeRaster, Follow, GaussianView, Hit, LANES, LaneHits, RayGrid, TileRow, end_at};
use glam::{DVec2, DVec3, Vec3};
use half::f16;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// A place of the pinhole picture, and how far away it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicturePoint {
    /// Its place in the pinhole picture, px (y down).
    pub pixel: DVec2,
    /// 1/z, 0 at infinity.
    pub inverse_depth: f64,
}

/// What aperture images are made of.
pub struct ApertureScene<'a> {
    /// The splats.
    pub view: &'a GaussianView<'a>,
    /// Their clusters.
    pub clusters: &'a Clusters,
    /// Points of other things, in front of splats or behind them.
    pub points: &'a [PicturePoint],
    /// The depth at which a ray from an aperture point (scene units) in a camera-space direction (z = 1) ends at a surface; infinite where there is
    /// none.
    pub ray_end: &'a (dyn Fn(DVec2, DVec3) -> f64 + Sync),
    /// Pixels about the picture in which clusters lie.
    pub margin_px: u32,
}

/// What the cells of the aperture see; row 0 at v = −R, column 0 at u = −R.
pub struct ApertureImages {
    /// For each cell, a value for each cluster, then for each point.
    cells: Vec<Vec<f16>>,
    /// For each cluster, the sum of its light over the cells, and of its shares.
    light: Vec<(Vec3, f32)>,
}

/// Values that vary no more than from this part of the largest to it are taken for one.
const EVEN: f32 = 0.9;

impl ApertureImages {
    /// Whether the values of a cluster or point differ among some cells.
    fn varies(&self, cells: &[usize], index: usize) -> bool {
        let values = cells.iter().map(|cell| self.cells[*cell][index].to_f32());
        let (least, largest) =
            values.fold((f32::INFINITY, 0.0), |(a, b): (f32, f32), v| (a.min(v), b.max(v)));
        least < EVEN * largest
    }

    /// Gives what was not wanted of `others` the mean of the `first` cells.
    fn fill(&mut self, first: &[usize], others: &[usize], is_wanted: &[bool]) {
        if others.is_empty() {
            return;
        }
        for index in (0..is_wanted.len()).filter(|index| !is_wanted[*index]) {
            let sum: f32 = first.iter().map(|cell| self.cells[*cell][index].to_f32()).sum();
            let mean = f16::from_f32(sum / first.len() as f32);
            others.iter().for_each(|cell| self.cells[*cell][index] = mean);
        }
    }

    /// For each cell, the share of a ray from it through the cluster that its members send, times the area that a pixel of the cluster's tilted surface
    /// takes from there, px².
    pub fn shares(&self, cluster: usize) -> impl Iterator<Item = f32> {
        self.cells.iter().map(move |values| values[cluster].to_f32())
    }

    /// Linear RGB radiance of a cluster: the mean over the cells, by share; 0 where no cell sees it.
    pub fn radiance(&self, cluster: usize) -> Vec3 {
        let (light, share) = self.light[cluster];
        if share > 0.0 { light / share } else { Vec3::ZERO }
    }

    /// For each cell, the share of a ray through the point that splats in front of it let through.
    pub fn transmittances(&self, point: usize) -> impl Iterator<Item = f32> {
        let index = self.light.len() + point;
        self.cells.iter().map(move |values| values[index].to_f32())
    }
}

/// Rays of a pixel's side of the grid that finds candidates: tiles of 4 px.
const GRID_RAYS_PER_PX: u32 = 2;

/// A ray toward a cluster or a point: its place on the grid, and which.
#[derive(Clone, Copy)]
struct Target {
    tile_row: u32,
    tile_column: u32,
    index: usize,
}

/// The images of clusters and points over `cells` × `cells` cells of the square aperture: for each, a ray from the cell's middle,
///
/// ```text
/// D = (x, y)/z − U/z      share = Σ w of members · max(0, 1 − U·∇(1/z))      transmittance = Π (1 − α) of what is nearer
/// ```
///
/// The second factor is exact for a plane: how its pixels grow as the eye moves to U.
///
/// Two cells of each row and of each column come first. What they see alike, or not at all, is taken for so in the others, too: most clusters and points.
///
/// # Errors
/// `progress` cancels.
///
/// # Panics
/// `cells` is 0.
pub fn aperture_images(
    scene: &ApertureScene<'_>,
    cells: u32,
    progress: &dyn Progress,
) -> Result<ApertureImages, Cancelled> {
    assert!(cells > 0);
    let (clusters, count) = (scene.clusters.list.len(), (cells * cells) as usize);
    let mut images = ApertureImages { cells: Vec::new(), light: vec![(Vec3::ZERO, 0.0); clusters] };
    let grid = grid_of_all(scene);
    let targets = clusters + scene.points.len();
    let reachable = ReachableSplats::new(scene, &grid, targets);
    images.cells = vec![Vec::new(); count];
    let (first, others): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|cell| is_first(*cell, cells as usize));
    let mut is_wanted = vec![true; targets];
    for (done, &cell) in first.iter().chain(&others).enumerate() {
        if done == first.len() {
            is_wanted = (0..targets).into_par_iter().map(|index| images.varies(&first, index)).collect();
        }
        progress.report(done as f32 / count as f32);
        let middle = |index: usize| (2.0 * index as f64 + 1.0) / f64::from(cells) - 1.0;
        let u = DVec2::new(middle(cell % cells as usize), middle(cell / cells as usize));
        let u = u * scene.view.optics().aperture_radius;
        let bake = CellBake::new(scene, &reachable, &grid, u, &is_wanted);
        let mut values = vec![f16::ZERO; targets];
        for (index, share, light) in bake.run(progress)? {
            values[index] = f16::from_f32(share);
            if let Some((sum, shares)) = images.light.get_mut(index) {
                *sum += light;
                *shares += share;
            }
        }
        images.cells[cell] = values;
    }
    images.fill(&first, &others, &is_wanted);
    Ok(images)
}

/// Whether a cell is among those that are looked through first: of 8 × 8 a quarter, two of each row and of each column.
fn is_first(cell: usize, side: usize) -> bool {
    side < 8 || (cell % side + 3 * (cell / side)).is_multiple_of(4)
}

/// A grid that holds the places of clusters from all of the aperture: what is so near that it lies beyond is seen at its edge.
fn grid_of_all(scene: &ApertureScene<'_>) -> RayGrid {
    /// What is moved farther into the margin hardly lands in the picture.
    const MARGINS: u32 = 3;
    let camera = scene.view.camera();
    let margin = scene.margin_px.saturating_mul(MARGINS).saturating_add(16);
    RayGrid::new(
        camera.width,
        camera.height,
        margin.min(8 * camera.width.max(camera.height)),
        GRID_RAYS_PER_PX,
    )
}

/// The splats that rays toward targets can meet, from whatever point of the aperture: of a band of a picture few of all.
struct ReachableSplats<'v> {
    view: GaussianView<'v>,
    /// What the splats of `view` are in the scene's view.
    numbers: Vec<u32>,
}

impl<'v> ReachableSplats<'v> {
    fn new(scene: &ApertureScene<'v>, grid: &RayGrid, targets: usize) -> Self {
        let radius = scene.view.optics().aperture_radius;
        let rows =
            |index: usize| [-radius, radius].map(|y| target_tile(scene, grid, DVec2::new(0.0, y), index)[1]);
        let none = || [u32::MAX, 0];
        let hull = |a: [u32; 2], b: [u32; 2]| [a[0].min(b[0]).min(b[1]), a[1].max(b[0]).max(b[1])];
        let [first, last] = (0..targets).into_par_iter().map(rows).fold(none, hull).reduce(none, hull);
        let numbers = grid.seen_in_rows(scene.view, first..=last);
        Self { view: scene.view.of_some(&numbers), numbers }
    }
}

/// The tile (column, row) of the ray from the aperture point `u` through a target.
fn target_tile(scene: &ApertureScene<'_>, grid: &RayGrid, u: DVec2, index: usize) -> [u32; 2] {
    let optics = scene.view.optics();
    let PicturePoint { pixel, inverse_depth } = point_of(scene, index);
    let kappa = optics.standard_kappa(inverse_depth);
    let shift = kappa * u / optics.tan_half_yfov * optics.half_height_px;
    grid.tile_at(pixel + DVec2::new(shift.x, -shift.y))
}

/// The rays of one cell.
struct CellBake<'v> {
    raster: EyeRaster<'v>,
    reachable: &'v ReachableSplats<'v>,
    scene: &'v ApertureScene<'v>,
    /// In the order of tiles.
    targets: Vec<Target>,
}

impl<'v> CellBake<'v> {
    fn new(
        scene: &'v ApertureScene<'v>,
        reachable: &'v ReachableSplats<'v>,
        grid: &'v RayGrid,
        u: DVec2,
        is_wanted: &[bool],
    ) -> Self {
        let target = |index: usize| {
            let [tile_column, tile_row] = target_tile(scene, grid, u, index);
            Target { tile_row, tile_column, index }
        };
        let wanted = (0..is_wanted.len()).into_par_iter().filter(|index| is_wanted[*index]);
        let mut targets: Vec<Target> = wanted.map(target).collect();
        targets.par_sort_unstable_by_key(|target| (target.tile_row, target.tile_column, target.index));
        Self { raster: EyeRaster::new(&reachable.view, u, grid), reachable, scene, targets }
    }

    /// Share and light of what the cell sees.
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
                directions.extend(targets.iter().map(|target| self.direction(target.index)));
                tracer.trace(&directions, Follow::Visible, &mut lanes);
                let rays = directions.iter().zip(lanes.hits.iter_mut().zip(lanes.rest));
                for (target, (direction, (hits, rest))) in targets.iter().zip(rays) {
                    let (share, light) = self.share(target.index, *direction, hits, rest);
                    if share > 0.0 {
                        results.push((target.index, share, light));
                    }
                }
            }
        }
        results
    }

    /// The direction of the ray through a target.
    fn direction(&self, index: usize) -> DVec3 {
        let PicturePoint { pixel, inverse_depth } = point_of(self.scene, index);
        let chief = self.raster.eye.view().direction(DVec2::ZERO, pixel);
        chief - (self.raster.eye.point() * inverse_depth).extend(0.0)
    }

    /// What a target sends along the ray through it, and its light: of a point what splats let through, and none.
    fn share(&self, index: usize, direction: DVec3, hits: &mut Vec<Hit>, rest: f64) -> (f32, Vec3) {
        let Some(cluster) = self.scene.clusters.list.get(index) else {
            let inverse_depth = point_of(self.scene, index).inverse_depth;
            let rest = if inverse_depth > 0.0 { end_at(hits, 1.0 / inverse_depth) } else { rest };
            return (rest as f32, Vec3::ZERO);
        };
        let u = self.raster.eye.point();
        let end = (self.scene.ray_end)(u, direction);
        if end < f64::INFINITY {
            end_at(hits, end);
        }
        let mut members = self.scene.clusters.members(cluster).iter().copied().peekable();
        let area = (1.0 - u.dot(cluster.gradient)).max(0.0);
        let (mut share, mut light) = (0.0, Vec3::ZERO);
        // Hits and members are in the same order.
        for hit in hits.iter() {
            let number = self.reachable.numbers[hit.splat as usize];
            while members.next_if(|member| *member < number).is_some() {}
            if members.peek() != Some(&number) {
                continue;
            }
            let weight = (hit.weight * area) as f32;
            share += weight;
            light += weight * self.raster.radiance(hit.splat);
        }
        (share, light * self.raster.light(hits).gain)
    }
}

/// The place of a cluster, or of a point behind them.
fn point_of(scene: &ApertureScene<'_>, index: usize) -> PicturePoint {
    match scene.clusters.list.get(index) {
        Some(&Cluster { pixel, inverse_depth, .. }) => PicturePoint { pixel, inverse_depth },
        None => scene.points[index - scene.clusters.list.len()],
    }
}
