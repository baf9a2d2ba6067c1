//! Parting the splats of chief rays.

use crate::view::{Eye, EyeRaster, Follow, GaussianView, Hit, LANES, LaneHits, RayGrid};
use glam::{DVec2, DVec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;

/// Where chief rays are parted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterOptions {
    /// Maximum difference of the circles of confusion of two members, px of radius at any focus: |Δ(1/z)|·R·f.
    pub extent_px: f64,
    /// Maximum difference of those of two members that follow each other, px.
    pub gap_px: f64,
    /// Pixels about the picture that have clusters, too.
    pub margin_px: u32,
    /// The rows of pixels that have clusters, 0 at the top of the margin, multiples of 8; `None` for all.
    pub rows: Option<[u32; 2]>,
}

impl Default for ClusterOptions {
    /// Extents of 2 px, gaps of 1 px, no margin, all rows.
    fn default() -> Self {
        Self { extent_px: 2.0, gap_px: 1.0, margin_px: 0, rows: None }
    }
}

/// Splats of one chief ray that are drawn as one sample, a pixel wide.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// Its place in the pinhole picture, px (y down).
    pub pixel: DVec2,
    /// Mean 1/z of its members, by weight.
    pub inverse_depth: f64,
    /// ∇(1/z) over the slopes x/z and y/z, mean by weight: how its surface is tilted.
    pub gradient: DVec2,
    /// The member with the largest weight, an index into the view: whose focus the sample takes.
    pub heaviest: u32,
    /// Its members in [`Clusters::members`].
    pub members: Range<usize>,
}

/// The clusters of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clusters {
    /// Row by row, those of a pixel from near to far.
    pub list: Vec<Cluster>,
    /// The members of all, indices into the view, those of a cluster in ascending order.
    pub members: Vec<u32>,
}

impl Clusters {
    /// The members of a cluster.
    pub fn members(&self, cluster: &Cluster) -> &[u32] {
        &self.members[cluster.members.clone()]
    }

    /// Adds the clusters of a chief ray, `hits` being all splats that it meets.
    fn push_ray(&mut self, eye: &Eye<'_>, pixel: DVec2, hits: &mut [Hit], options: &ClusterOptions) {
        let optics = eye.view().optics();
        // The radius of the circle of confusion for each unit of κ, whatever the focus.
        let radius_px = optics.splat_radius_px(1.0);
        let direction = eye.view().direction(eye.point(), pixel);
        hits.sort_by(|a, b| a.depth.total_cmp(&b.depth).then(a.splat.cmp(&b.splat)));
        let mut rest = &hits[..];
        while let Some(nearest) = rest.first() {
            let is_near =
                |pair: &[Hit], limit: f64| radius_px * (1.0 / pair[0].depth - 1.0 / pair[1].depth) <= limit;
            let more = rest.windows(2).take_while(|pair| {
                is_near(pair, options.gap_px) && is_near(&[*nearest, pair[1]], options.extent_px)
            });
            let (members, farther) = rest.split_at(1 + more.count());
            self.push(eye, direction, pixel, members);
            rest = farther;
        }
    }

    fn push(&mut self, eye: &Eye<'_>, direction: DVec3, pixel: DVec2, hits: &[Hit]) {
        let (mut transmittance, mut sum) = (1.0, 0.0);
        let (mut inverse_depth, mut gradient, mut heaviest) = (0.0, DVec2::ZERO, (0.0, hits[0].splat));
        for hit in hits {
            let weight = transmittance * hit.alpha;
            transmittance *= 1.0 - hit.alpha;
            sum += weight;
            inverse_depth += weight / hit.depth;
            gradient += weight * eye.inverse_depth_gradient(hit.splat, direction);
            if weight > heaviest.0 {
                heaviest = (weight, hit.splat);
            }
        }
        let start = self.members.len();
        self.members.extend(hits.iter().map(|hit| hit.splat));
        self.members[start..].sort_unstable();
        self.list.push(Cluster {
            pixel,
            inverse_depth: inverse_depth / sum,
            gradient: gradient / sum,
            heaviest: heaviest.1,
            members: start..self.members.len(),
        });
    }

    fn append(&mut self, mut other: Self) {
        let offset = self.members.len();
        for cluster in &mut other.list {
            cluster.members = cluster.members.start + offset..cluster.members.end + offset;
        }
        self.list.append(&mut other.list);
        self.members.append(&mut other.members);
    }
}

/// The clusters of all pixels of a view's picture and of a margin about it, a chief ray through the middle of each. Nothing is cut off: what is hidden
/// from the aperture's centre may be visible from its rim.
///
/// # Errors
/// `progress` cancels.
pub fn cluster_picture(
    view: &GaussianView<'_>,
    options: &ClusterOptions,
    progress: &dyn Progress,
) -> Result<Clusters, Cancelled> {
    let camera = view.camera();
    let grid = RayGrid::new(camera.width, camera.height, options.margin_px, 1);
    let raster = EyeRaster::new(view, DVec2::ZERO, &grid);
    let tile_rows = options.rows.map_or(0..grid.tile_rows(), |rows| {
        let [first, end] = rows.map(|row| row.div_ceil(LANES as u32).min(grid.tile_rows()));
        first..end
    });
    let rows: Vec<Clusters> = tile_rows
        .into_par_iter()
        .map(|index| {
            progress.check()?;
            let tiles = raster.tile_row(index);
            let (mut clusters, mut lanes) = (Clusters::default(), LaneHits::default());
            tiles.for_each_tile(&raster.eye, |columns, tracer| {
                for row in tiles.rays.clone() {
                    let pixels: Vec<DVec2> = columns.clone().map(|column| grid.pixel(column, row)).collect();
                    let directions: Vec<DVec3> =
                        pixels.iter().map(|pixel| view.direction(DVec2::ZERO, *pixel)).collect();
                    tracer.trace(row, &directions, Follow::All, &mut lanes);
                    for (pixel, hits) in pixels.iter().zip(&mut lanes.hits) {
                        clusters.push_ray(&raster.eye, *pixel, hits, options);
                    }
                }
            });
            Ok(clusters)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut clusters = Clusters::default();
    rows.into_iter().for_each(|row| clusters.append(row));
    Ok(clusters)
}
