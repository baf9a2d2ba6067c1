//! Exact coverage of every texel: texel ∩ triangle by polygon clipping in f64 (promise P1).
//!
//! The atlas is processed in bands of rows, in parallel. Within its band a triangle is cut into rows and each row
//! into texels; every piece adds its world area and moment to its texel. World area per atlas area is constant over a
//! triangle, so the pieces of a triangle sum to its world area whatever its shape in the atlas.
//!
//! A triangle that has area in the world but none in the atlas (a needle thinner than f32 can resolve at its place)
//! gives its whole area to the texel at the middle of its place, at its own centroid.

use crate::Atlas;
use crate::texels::clip::Polygon;
use glam::{DVec2, Vec2};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};

/// Rows per band: enough that few triangles touch two bands, few enough that a band's cells stay in cache.
const BAND_ROWS: u32 = 8;

/// A texel that covers some surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasTexel {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Exact world area of texel ∩ surface.
    pub area: f64,
    /// The surface point at the centroid of what the texel covers (of its largest piece, if it covers several and the
    /// common centroid does not lie on that piece's triangle).
    pub centroid: SurfacePoint,
}

/// The sums of one texel.
#[derive(Clone, Copy)]
struct Cell {
    /// World area.
    area: f64,
    /// World area times atlas position relative to the texel's corner.
    moment: DVec2,
    /// The largest piece: its world area, triangle and centroid (atlas position).
    largest: f64,
    triangle: u32,
    centroid: DVec2,
}

const EMPTY_CELL: Cell =
    Cell { area: 0.0, moment: DVec2::ZERO, largest: 0.0, triangle: u32::MAX, centroid: DVec2::ZERO };

impl Atlas {
    /// Every texel that covers some surface, in row order. Their areas sum to the mesh's (promise P1).
    pub fn texels(&self, scene: &Scene) -> Vec<AtlasTexel> {
        let bands = Bands::new(self, scene);
        let rows: Vec<Vec<AtlasTexel>> =
            (0..bands.count).into_par_iter().map(|band| bands.texels(band)).collect();
        rows.concat()
    }
}

/// The triangles that touch each band.
struct Bands<'a> {
    atlas: &'a Atlas,
    scene: &'a Scene,
    count: usize,
    /// `triangles[start[b]..start[b + 1]]` touch band b.
    start: Vec<u32>,
    triangles: Vec<u32>,
}

impl<'a> Bands<'a> {
    fn new(atlas: &'a Atlas, scene: &'a Scene) -> Self {
        let count = atlas.height.div_ceil(BAND_ROWS).max(1) as usize;
        let ranges: Vec<(u32, u32)> =
            atlas.corners.par_iter().map(|corners| band_range(corners, count)).collect();
        let mut start = vec![0u32; count + 1];
        for &(first, last) in &ranges {
            for band in first..=last {
                start[band as usize + 1] += 1;
            }
        }
        for band in 0..count {
            start[band + 1] += start[band];
        }
        let mut next = start.clone();
        let mut triangles = vec![0; start[count] as usize];
        for (triangle, &(first, last)) in ranges.iter().enumerate() {
            for band in first..=last {
                triangles[next[band as usize] as usize] = triangle as u32;
                next[band as usize] += 1;
            }
        }
        Self { atlas, scene, count, start, triangles }
    }

    fn texels(&self, band: usize) -> Vec<AtlasTexel> {
        let width = self.atlas.width;
        let top = band as u32 * BAND_ROWS;
        let rows = BAND_ROWS.min(self.atlas.height.saturating_sub(top));
        let mut cells = vec![EMPTY_CELL; (rows * width) as usize];
        for &triangle in &self.triangles[self.start[band] as usize..self.start[band + 1] as usize] {
            self.add_triangle(triangle, top, rows, &mut cells);
        }
        let covered = cells.iter().enumerate().filter(|(_, cell)| cell.area > 0.0);
        covered
            .map(|(i, cell)| {
                let (x, y) = (i as u32 % width, top + i as u32 / width);
                AtlasTexel { x, y, area: cell.area, centroid: self.surface_point(cell, x, y) }
            })
            .collect()
    }

    /// Adds the pieces of a triangle that lie in rows `top..top + rows`.
    fn add_triangle(&self, triangle: u32, top: u32, rows: u32, cells: &mut [Cell]) {
        let world_area = 0.5 * self.scene.area_normal(triangle).length();
        // Also rejects NaN and infinite areas.
        if !(world_area > 0.0 && world_area.is_finite()) {
            return;
        }
        let width = self.atlas.width;
        let corners = self.atlas.corners[triangle as usize].map(Vec2::as_dvec2);
        let whole = Polygon::triangle(corners);
        let (atlas_area, middle) = whole.area_and_centroid();
        if atlas_area == 0.0 {
            let (x, y) = ((middle.x as u32).min(width - 1), (middle.y as u32).min(self.atlas.height - 1));
            if (top..top + rows).contains(&y) {
                add_piece(&mut cells[((y - top) * width + x) as usize], triangle, world_area, middle, x, y);
            }
            return;
        }
        let scale = world_area / atlas_area;
        let (low, high) = bounds(&corners);
        let first_row = (low.y as u32).max(top);
        let last_row = last_cell(high.y).min(top + rows - 1);
        // The part above the first row belongs to the bands before.
        let mut rest = whole;
        if low.y < f64::from(first_row) {
            rest = rest.split(1, f64::from(first_row)).1;
        }
        for y in first_row..=last_row {
            let mut strip = rest;
            if high.y > f64::from(y + 1) {
                (strip, rest) = rest.split(1, f64::from(y + 1));
            }
            let (left, right) = bounds(strip.corners());
            if left.x > right.x {
                continue;
            }
            for x in left.x as u32..=last_cell(right.x).min(width - 1) {
                let mut piece = strip;
                if right.x > f64::from(x + 1) {
                    (piece, strip) = strip.split(0, f64::from(x + 1));
                }
                let (area, centroid) = piece.area_and_centroid();
                if area * scale > 0.0 {
                    let cell = &mut cells[((y - top) * width + x) as usize];
                    add_piece(cell, triangle, area * scale, centroid, x, y);
                }
            }
        }
    }

    /// The surface point at the centroid.
    fn surface_point(&self, cell: &Cell, x: u32, y: u32) -> SurfacePoint {
        let triangle = cell.triangle;
        let corners = self.atlas.corners[triangle as usize].map(Vec2::as_dvec2);
        let common = DVec2::new(x.into(), y.into()) + cell.moment / cell.area;
        let inside = |b: &DVec2| b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0;
        let barycentric = barycentric(corners, common)
            .filter(inside)
            .or_else(|| barycentric_of_piece(corners, cell.centroid))
            .unwrap_or(DVec2::splat(1.0 / 3.0));
        SurfacePoint { triangle, barycentric }
    }
}

fn add_piece(cell: &mut Cell, triangle: u32, area: f64, centroid: DVec2, x: u32, y: u32) {
    cell.area += area;
    cell.moment += (centroid - DVec2::new(x.into(), y.into())) * area;
    if area > cell.largest {
        cell.largest = area;
        cell.triangle = triangle;
        cell.centroid = centroid;
    }
}

/// The first and last band that a triangle touches.
fn band_range(corners: &[Vec2; 3], bands: usize) -> (u32, u32) {
    let low = corners[0].y.min(corners[1].y).min(corners[2].y) as u32 / BAND_ROWS;
    let high = corners[0].y.max(corners[1].y).max(corners[2].y) as u32 / BAND_ROWS;
    let last = bands as u32 - 1;
    (low.min(last), high.min(last))
}

/// The last row or column of an interval that ends at `end`; one that ends at a border does not extend over it.
fn last_cell(end: f64) -> u32 {
    (end.ceil() as u32).saturating_sub(1)
}

fn bounds(corners: &[DVec2]) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    corners.iter().fold(none, |(low, high), &c| (low.min(c), high.max(c)))
}

/// Barycentrics b₁, b₂ of an atlas position in a triangle; `None` if the triangle has no area.
pub(crate) fn barycentric([a, b, c]: [DVec2; 3], position: DVec2) -> Option<DVec2> {
    let (ab, ac, ap) = (b - a, c - a, position - a);
    let determinant = ab.perp_dot(ac);
    let result = DVec2::new(ap.perp_dot(ac), ab.perp_dot(ap)) / determinant;
    (determinant != 0.0 && result.is_finite()).then_some(result)
}

/// The same for the centroid of a piece of the triangle, which lies inside: rounding may put it outside, and is
/// corrected.
fn barycentric_of_piece(corners: [DVec2; 3], centroid: DVec2) -> Option<DVec2> {
    let result = barycentric(corners, centroid)?.clamp(DVec2::ZERO, DVec2::ONE);
    Some(result / (result.x + result.y).max(1.0))
}
