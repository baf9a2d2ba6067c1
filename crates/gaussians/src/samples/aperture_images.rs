//! What of each cluster, and of what lies behind splats, each cell of the aperture sees.

use super::clusters::{Cluster, Clusters};
use super::eye_picture::{EyePicture, Kept, WantedRays};
use crate::view::{EyeRaster, GaussianView, RayGrid, TILE};
use glam::{DVec2, DVec3, Vec2, Vec3};
use half::f16;
use lens::Optics;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::RangeInclusive;

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
    /// Clusters of which no cell sees more, px², are looked at from a quarter of the cells: whose field is so coarse that more are not wanted.
    pub coarse_below_px2: f32,
    /// Rays of a pixel's side, at least 1: a cluster is looked up on the nearest.
    pub rays_per_px: u32,
}

/// What the cells of the aperture see; row 0 at v = −R, column 0 at u = −R.
pub struct ApertureImages {
    lattice: CellLattice,
    /// For each of the first cells, a value for each cluster, then for each point.
    first: Vec<Vec<f16>>,
    /// For each of the other cells, a value for each target that they look at.
    others: Vec<Vec<f16>>,
    /// For each cluster and point its place in `others`; [`NOWHERE`] where a value of the first cells stands for its neighbours.
    places: Vec<u32>,
    /// For each cluster, the sum of its light over the first cells, and of its shares.
    light: Vec<(Vec3, f32)>,
}

const NOWHERE: u32 = u32::MAX;

/// Values that vary no more than from this part of the largest to it are taken for one.
const EVEN: f32 = 0.9;

impl ApertureImages {
    /// For each cell, the share of a ray from it through the cluster that its members send, times the area that a pixel of the cluster's tilted surface
    /// takes from there, px².
    pub fn shares(&self, cluster: usize) -> impl Iterator<Item = f32> {
        self.values(cluster)
    }

    /// Linear RGB radiance of a cluster: the mean over the cells, by share; 0 where no cell sees it.
    pub fn radiance(&self, cluster: usize) -> Vec3 {
        let (light, share) = self.light[cluster];
        if share > 0.0 { light / share } else { Vec3::ZERO }
    }

    /// For each cell, the share of a ray through the point that splats in front of it let through.
    pub fn transmittances(&self, point: usize) -> impl Iterator<Item = f32> {
        self.values(self.light.len() + point)
    }

    fn values(&self, target: usize) -> impl Iterator<Item = f32> {
        let place = self.places[target];
        let value = move |from: &CellSource| match *from {
            CellSource { other: Some(other), .. } if place != NOWHERE => self.others[other][place as usize],
            CellSource { first, .. } => self.first[first][target],
        };
        self.lattice.sources.iter().map(move |from| value(from).to_f32())
    }

    /// Whether a target is looked at from the other cells, too: not if the first see it alike, or not at all, or hardly.
    fn is_uneven(&self, target: usize, least: f32) -> bool {
        let values = self.first.iter().map(|cell| cell[target].to_f32());
        let (low, high) = values.fold((f32::INFINITY, 0.0), |(a, b): (f32, f32), v| (a.min(v), b.max(v)));
        low < EVEN * high && high >= least
    }
}

/// Where the value of a cell comes from.
#[derive(Clone, Copy)]
struct CellSource {
    /// The first cell of its block.
    first: usize,
    /// Itself, if it is another.
    other: Option<usize>,
}

/// The cells of a square aperture in the order in which they are looked from: one of each block of 2 × 2, of each row and each column as many, then the
/// others.
struct CellLattice {
    /// Column and row of the first cells.
    first: Vec<[u32; 2]>,
    /// Of the others.
    others: Vec<[u32; 2]>,
    /// Row by row.
    sources: Vec<CellSource>,
}

impl CellLattice {
    /// Of `side` × `side` cells; less than 8, or not in fours, are all first.
    fn new(side: u32) -> Self {
        let is_parted = side >= 8 && side.is_multiple_of(4);
        let first_of = |[column, row]: [u32; 2]| match is_parted {
            true => [column / 2 * 2 + row / 2 % 2, row / 2 * 2 + column / 2 % 2],
            false => [column, row],
        };
        let cells = || (0..side).flat_map(|row| (0..side).map(move |column| [column, row]));
        let (first, others): (Vec<_>, Vec<_>) = cells().partition(|cell| first_of(*cell) == *cell);
        let source = |cell: [u32; 2]| CellSource {
            first: first.iter().position(|other| *other == first_of(cell)).unwrap_or(0),
            other: others.iter().position(|other| *other == cell),
        };
        Self { sources: cells().map(source).collect(), first, others }
    }
}

/// The images of clusters and points over `cells` × `cells` cells of the square aperture: for each, a ray from the cell's middle,
///
/// ```text
/// D = (x, y)/z − U/z      share = Σ w of members · max(0, 1 − U·∇(1/z))      transmittance = Π (1 − α) of what is nearer
/// ```
///
/// or, since many of them lie beside each other, the nearest ray of a grid ([`ApertureScene::rays_per_px`]).
///
/// The second factor is exact for a plane: how its pixels grow as the eye moves to U.
///
/// A quarter of the cells comes first, one of each 2 × 2. What they see alike, or not at all, is taken for so in the others, too: most clusters and points.
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
    let bake = Bake::new(scene);
    let (clusters, targets) = (scene.clusters.list.len(), scene.clusters.list.len() + scene.points.len());
    let mut images = ApertureImages {
        lattice: CellLattice::new(cells),
        first: Vec::new(),
        others: Vec::new(),
        places: Vec::new(),
        light: vec![(Vec3::ZERO, 0.0); clusters],
    };
    let CellLattice { first, others, .. } = &images.lattice;
    let middle = |index: u32| f64::from(2 * index + 1) / f64::from(cells) - 1.0;
    let eye = |[column, row]: [u32; 2]| {
        DVec2::new(middle(column), middle(row)) * scene.view.optics().aperture_radius
    };
    let mut done = 0;
    let mut report = || {
        progress.report(done as f32 / (cells * cells) as f32);
        done += 1;
    };
    let all: Vec<u32> = (0..targets as u32).collect();
    for cell in first {
        report();
        let light = Some(&mut images.light[..]);
        images.first.push(bake.values(eye(*cell), &all, light, progress)?);
    }
    let is_wanted = |target: &u32| {
        let is_cluster = (*target as usize) < clusters;
        images.is_uneven(*target as usize, if is_cluster { scene.coarse_below_px2 } else { 0.0 })
    };
    let wanted: Vec<u32> = all.into_par_iter().filter(is_wanted).collect();
    for cell in others {
        report();
        images.others.push(bake.values(eye(*cell), &wanted, None, progress)?);
    }
    images.places = vec![NOWHERE; targets];
    (0..).zip(&wanted).for_each(|(place, target)| images.places[*target as usize] = place);
    Ok(images)
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
        scene.rays_per_px.max(1),
    )
}

/// What the cells look at, and the splats that they can meet.
struct Bake<'v> {
    scene: &'v ApertureScene<'v>,
    grid: RayGrid,
    /// The rows of tiles in which targets lie, from whatever point of the aperture.
    tile_rows: RangeInclusive<u32>,
    /// The splats that rays toward targets can meet: of a band of a picture few of all.
    view: GaussianView<'v>,
    /// The members of clusters, as `view` numbers them.
    members: Vec<u32>,
    spots: Vec<Spot>,
}

/// Where a target is in the pinhole picture, and how it moves as the eye does.
#[derive(Clone, Copy)]
struct Spot {
    pixel: Vec2,
    /// Change of `pixel` for each unit of the aperture point, px.
    motion_px: f32,
}

impl Spot {
    fn new(point: &PicturePoint, optics: &Optics) -> Self {
        let focal_px = optics.half_height_px / optics.tan_half_yfov;
        let motion_px = (optics.standard_kappa(point.inverse_depth) * focal_px) as f32;
        Self { pixel: point.pixel.as_vec2(), motion_px }
    }

    /// Its place as the aperture point `u` (scene units) sees it, px.
    #[inline]
    fn seen_from(self, u: Vec2) -> Vec2 {
        self.pixel + self.motion_px * Vec2::new(u.x, -u.y)
    }
}

impl<'v> Bake<'v> {
    fn new(scene: &'v ApertureScene<'v>) -> Self {
        let grid = grid_of_all(scene);
        let radius = scene.view.optics().aperture_radius;
        let targets = scene.clusters.list.len() + scene.points.len();
        let optics = scene.view.optics();
        let spot = |target: usize| Spot::new(&point_of(scene, target), &optics);
        let spots: Vec<Spot> = (0..targets).into_par_iter().map(spot).collect();
        let row = |spot: &Spot, v: f64| grid.ray_at(spot.seen_from(Vec2::new(0.0, v as f32)))[1] / TILE;
        let rows = |spot: &Spot| [-radius, radius].map(|v| row(spot, v));
        let none = || [u32::MAX, 0];
        let hull = |a: [u32; 2], b: [u32; 2]| [a[0].min(b[0]).min(b[1]), a[1].max(b[0]).max(b[1])];
        let [first, last] = spots.par_iter().map(rows).fold(none, hull).reduce(none, hull);
        let tile_rows = first.min(last)..=last;
        let numbers = grid.seen_in_rows(scene.view, tile_rows.clone());
        let mut number_of = vec![u32::MAX; scene.view.len()];
        (0..).zip(&numbers).for_each(|(number, splat)| number_of[*splat as usize] = number);
        let members = scene.clusters.members.par_iter().map(|splat| number_of[*splat as usize]).collect();
        Self { view: scene.view.of_some(&numbers), scene, grid, tile_rows, members, spots }
    }

    /// The values of `targets`, in ascending order, as the aperture point `u` sees them. Their light is added to `light`, which has a place for each cluster;
    /// `targets` are all then.
    fn values(
        &self,
        u: DVec2,
        targets: &[u32],
        light: Option<&mut [(Vec3, f32)]>,
        progress: &dyn Progress,
    ) -> Result<Vec<f16>, Cancelled> {
        let wanted = WantedRays::new(&self.grid, self.tile_rows.clone());
        let ray = |target: u32| wanted.number(self.spots[target as usize].seen_from(u.as_vec2()));
        targets.par_iter().for_each(|target| {
            let before = match self.scene.clusters.list.get(*target as usize) {
                Some(cluster) => self.members_of(cluster).last().map_or(0, |last| last + 1),
                None => u32::MAX,
            };
            wanted.ask(ray(*target), before);
        });
        let raster = match light {
            Some(_) => EyeRaster::new(&self.view, u, &self.grid),
            None => EyeRaster::without_light(&self.view, u, &self.grid),
        };
        let kept = Kept { gains: light.is_some(), veils: !self.scene.points.is_empty() };
        let picture = EyePicture::new(&raster, &wanted, self.scene.ray_end, kept, progress)?;
        let cluster_value = |cluster: &Cluster, target: u32, mut add: Option<&mut (Vec3, f32)>| {
            let (ray, area) = (ray(target), (1.0 - u.dot(cluster.gradient)).max(0.0) as f32);
            let (mut share, mut light) = (0.0, Vec3::ZERO);
            picture.for_each_member(ray, self.members_of(cluster), |splat, weight| {
                share += weight * area;
                if add.is_some() {
                    light += weight * area * raster.radiance(splat);
                }
            });
            if let Some((sum, shares)) = add.as_deref_mut().filter(|_| share > 0.0) {
                *sum += light * picture.gain(ray);
                *shares += share;
            }
            f16::from_f32(share)
        };
        let point_value = |point: &PicturePoint, target: u32| {
            let depth = if point.inverse_depth > 0.0 { 1.0 / point.inverse_depth } else { f64::INFINITY };
            f16::from_f32(picture.transmittance(ray(target), depth))
        };
        let list = &self.scene.clusters.list;
        let clusters = targets.partition_point(|target| (*target as usize) < list.len());
        let (clusters, points) = targets.split_at(clusters);
        let mut values: Vec<f16> = match light {
            Some(light) => {
                let each = clusters.par_iter().zip(light);
                each.map(|(target, light)| cluster_value(&list[*target as usize], *target, Some(light)))
                    .collect()
            }
            None => {
                let each = clusters.par_iter();
                each.map(|target| cluster_value(&list[*target as usize], *target, None)).collect()
            }
        };
        let points = points
            .par_iter()
            .map(|target| point_value(&self.scene.points[*target as usize - list.len()], *target));
        values.par_extend(points);
        Ok(values)
    }

    fn members_of(&self, cluster: &Cluster) -> &[u32] {
        &self.members[cluster.members.clone()]
    }
}

/// The place of a cluster, or of a point behind them.
fn point_of(scene: &ApertureScene<'_>, index: usize) -> PicturePoint {
    match scene.clusters.list.get(index) {
        Some(&Cluster { pixel, inverse_depth, .. }) => PicturePoint { pixel, inverse_depth },
        None => scene.points[index - scene.clusters.list.len()],
    }
}
