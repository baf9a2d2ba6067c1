//! The pinhole picture from a point of the aperture, as lists of what its rays meet.
//!
//! A ray answers for all clusters that lie nearest to it: what it meets of each is looked up by the numbers of its members. So there are as many rays as
//! pixels, however many clusters a pixel has.

use crate::view::{EyeRaster, Follow, Hit, LANES, LaneHits, RayGrid, TILE, end_at};
use glam::{DVec2, DVec3, Vec2, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::RangeInclusive;
use std::sync::atomic::{AtomicU32, Ordering};

/// Rays of a tile.
const TILE_RAYS: usize = LANES * TILE as usize;

/// What a ray meets of a splat.
#[derive(Clone, Copy)]
struct SplatShare {
    /// Number in the eye's view.
    splat: u32,
    /// Share of the ray that the splat sends.
    weight: f32,
}

/// The same as something that may hide other things.
#[derive(Clone, Copy)]
struct Veil {
    /// Share of what is behind that it stops.
    alpha: f32,
    /// Depth of the greatest response.
    depth: f32,
}

/// Which rays of some rows of tiles are wanted, and to which splat each.
pub(super) struct WantedRays<'g> {
    grid: &'g RayGrid,
    tile_rows: RangeInclusive<u32>,
    /// For each ray the number of the first splat that nobody asks for; 0 where the ray is not wanted. Tile by tile.
    before: Vec<AtomicU32>,
}

impl<'g> WantedRays<'g> {
    /// None yet.
    pub fn new(grid: &'g RayGrid, tile_rows: RangeInclusive<u32>) -> Self {
        let rays = tile_rows.clone().count() * grid.tile_columns() as usize * TILE_RAYS;
        let mut before = Vec::new();
        before.resize_with(rays, AtomicU32::default);
        Self { grid, tile_rows, before }
    }

    /// The number of the ray nearest to a pixel position.
    #[inline]
    pub fn number(&self, pixel: Vec2) -> usize {
        let [column, row] = self.grid.ray_at(pixel);
        let (first, last) = (*self.tile_rows.start(), *self.tile_rows.end());
        let tile_row = (row / TILE).clamp(first, last) - first;
        let tile = tile_row as usize * self.grid.tile_columns() as usize + (column / TILE) as usize;
        tile * TILE_RAYS + (row % TILE * TILE + column % TILE) as usize
    }

    /// Asks for what a ray meets of the splats before `before`.
    pub fn ask(&self, number: usize, before: u32) {
        self.before[number].fetch_max(before, Ordering::Relaxed);
    }
}

/// What is kept of each ray, beside its splats.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    /// How its light is decoded: it is followed to its end.
    pub gains: bool,
    /// How what it meets hides what is behind.
    pub veils: bool,
}

/// The rays of a row of tiles, tile by tile.
#[derive(Default)]
struct RayRow {
    /// Where the list of each ray starts; one more for the end.
    starts: Vec<u32>,
    shares: Vec<SplatShare>,
    veils: Vec<Veil>,
    gains: Vec<Vec3>,
}

/// The lists of what the rays from a point of the aperture meet.
pub(super) struct EyePicture {
    rows: Vec<RayRow>,
    rays_of_row: usize,
}

impl EyePicture {
    /// Traces the rays that are wanted. `ray_end` tells the depth at which a ray from the aperture point in a direction (z = 1) ends.
    pub fn new(
        raster: &EyeRaster<'_>,
        wanted: &WantedRays<'_>,
        ray_end: &(dyn Fn(DVec2, DVec3) -> f64 + Sync),
        kept: Kept,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let rays_of_row = wanted.grid.tile_columns() as usize * TILE_RAYS;
        let rows = wanted.before.par_chunks(rays_of_row).enumerate();
        let trace = |(number, before): (usize, &[AtomicU32])| {
            progress.check()?;
            let tile_row = wanted.tile_rows.start() + number as u32;
            let row = TracedRow { raster, grid: wanted.grid, ray_end, kept, tile_row };
            Ok(row.trace(before))
        };
        Ok(Self { rows: rows.map(trace).collect::<Result<_, Cancelled>>()?, rays_of_row })
    }

    /// What a ray meets of `members`, numbers in ascending order: of each its number and its share of the ray.
    #[inline]
    pub fn for_each_member(&self, ray: usize, members: &[u32], mut visit: impl FnMut(u32, f32)) {
        let (row, range) = self.list(ray);
        let shares = &row.shares[range];
        let mut members = members.iter().copied();
        let Some(mut member) = members.next() else { return };
        for share in shares {
            while member < share.splat {
                match members.next() {
                    Some(next) => member = next,
                    None => return,
                }
            }
            if member == share.splat {
                visit(member, share.weight);
            }
        }
    }

    /// How the light of a ray is decoded.
    pub fn gain(&self, ray: usize) -> Vec3 {
        self.rows[ray / self.rays_of_row].gains[ray % self.rays_of_row]
    }

    /// The share of a ray that splats before `depth` let through.
    pub fn transmittance(&self, ray: usize, depth: f64) -> f32 {
        let (row, range) = self.list(ray);
        let before = row.veils[range].iter().filter(|veil| f64::from(veil.depth) < depth);
        before.map(|veil| 1.0 - veil.alpha).product()
    }

    #[inline]
    fn list(&self, ray: usize) -> (&RayRow, std::ops::Range<usize>) {
        let (row, ray) = (&self.rows[ray / self.rays_of_row], ray % self.rays_of_row);
        (row, row.starts[ray] as usize..row.starts[ray + 1] as usize)
    }
}

/// A row of tiles that is traced.
struct TracedRow<'a> {
    raster: &'a EyeRaster<'a>,
    grid: &'a RayGrid,
    ray_end: &'a (dyn Fn(DVec2, DVec3) -> f64 + Sync),
    kept: Kept,
    tile_row: u32,
}

impl TracedRow<'_> {
    /// Traces the rays that are wanted to `before` each.
    fn trace(&self, before: &[AtomicU32]) -> RayRow {
        let mut result = RayRow::default();
        let tiles = before.chunks_exact(TILE_RAYS);
        let is_wanted = |tile: &[AtomicU32]| tile.iter().any(|before| before.load(Ordering::Relaxed) > 0);
        if !tiles.clone().any(is_wanted) {
            result.starts = vec![0; before.len() + 1];
            return result;
        }
        let tile_row = self.raster.tile_row(self.tile_row);
        let mut lanes = LaneHits::default();
        for (tile, before) in (0..).zip(tiles) {
            if !is_wanted(before) {
                result.pass(TILE_RAYS, self.kept);
                continue;
            }
            let tracer = tile_row.tracer(&self.raster.eye, tile);
            for (row, before) in (self.tile_row * TILE..).zip(before.chunks_exact(LANES)) {
                let before: [u32; LANES] = std::array::from_fn(|lane| before[lane].load(Ordering::Relaxed));
                if before.iter().all(|before| *before == 0) {
                    result.pass(LANES, self.kept);
                    continue;
                }
                let u = self.raster.eye.point();
                let direction = |lane: usize| {
                    self.raster.eye.view().direction(u, self.grid.pixel(tile * TILE + lane as u32, row))
                };
                let directions: [DVec3; LANES] = std::array::from_fn(direction);
                // How light is decoded depends on all of it.
                let before = match self.kept.gains {
                    true => before.map(|before| if before > 0 { u32::MAX } else { 0 }),
                    false => before,
                };
                tracer.trace(row, &directions, Follow::Before(before), &mut lanes);
                for ((hits, direction), before) in lanes.hits.iter_mut().zip(directions).zip(before) {
                    let end = if before > 0 { (self.ray_end)(u, direction) } else { f64::INFINITY };
                    self.keep(hits, end, &mut result);
                }
            }
        }
        result.starts.push(result.shares.len() as u32);
        result
    }

    /// Keeps a ray that ends at a depth.
    fn keep(&self, hits: &mut Vec<Hit>, end: f64, row: &mut RayRow) {
        row.starts.push(row.shares.len() as u32);
        if self.kept.veils {
            let veil = |hit: &Hit| Veil { alpha: hit.alpha as f32, depth: hit.depth as f32 };
            row.veils.extend(hits.iter().map(veil));
            // Lists are equally long: what is behind the end has no share.
            let count = hits.len();
            if end < f64::INFINITY {
                end_at(hits, end);
            }
            row.push_shares(hits);
            row.shares.extend((hits.len()..count).map(|_| SplatShare { splat: u32::MAX, weight: 0.0 }));
        } else {
            if end < f64::INFINITY {
                end_at(hits, end);
            }
            row.push_shares(hits);
        }
        if self.kept.gains {
            row.gains.push(self.raster.light(hits).gain);
        }
    }
}

impl RayRow {
    fn push_shares(&mut self, hits: &[Hit]) {
        let share = |hit: &Hit| SplatShare { splat: hit.splat, weight: hit.weight as f32 };
        self.shares.extend(hits.iter().map(share));
    }

    /// Passes some rays that are not wanted.
    fn pass(&mut self, rays: usize, kept: Kept) {
        self.starts.extend(std::iter::repeat_n(self.shares.len() as u32, rays));
        if kept.gains {
            self.gains.extend(std::iter::repeat_n(Vec3::ONE, rays));
        }
    }
}
