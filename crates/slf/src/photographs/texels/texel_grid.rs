//! The texels that light is stored at, and interpolation between them.

use atlas::{Atlas, NO_TEXEL, TexelMap};
use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use scene::{Scene, SurfacePoint};

/// Layout of the texels in the atlas: all that a lookup needs.
#[derive(Debug, PartialEq)]
pub(crate) struct TexelGrid {
    /// Factor from positions in the caller's atlas to positions in this grid.
    pub scale: f64,
    pub width: u32,
    pub height: u32,
    /// By triangle: its corners in the caller's atlas.
    pub corners: Vec<[Vec2; 3]>,
    /// By row and column: the texel's number, or [`NO_TEXEL`].
    pub index: Vec<u32>,
}

/// Texels of a surface, at the resolution that its photographs support.
pub(crate) struct Texels {
    pub grid: TexelGrid,
    /// By texel: column and row.
    places: Vec<[u32; 2]>,
    points: Vec<SurfacePoint>,
    positions: Vec<DVec3>,
    /// By texel: unit geometric normal of the front.
    normals: Vec<Vec3>,
    /// By texel: unit interpolated normal of the front.
    shading_normals: Vec<Vec3>,
    /// By texel: world area.
    areas: Vec<f32>,
}

/// Up to four texels around a point and their weights, which sum to 1.
pub(crate) type TexelWeights = [(u32, f32); 4];

impl Texels {
    /// The covered texels of an atlas whose resolution is multiplied by `scale`.
    pub fn new(scene: &Scene, atlas: &Atlas, scale: f64) -> Self {
        let side = |side: u32| (f64::from(side) * scale).ceil().max(1.0) as u32;
        let scaled = |corners: &[Vec2; 3]| corners.map(|corner| corner * scale as f32);
        let finer = Atlas {
            width: side(atlas.width),
            height: side(atlas.height),
            corners: atlas.corners.iter().map(scaled).collect(),
            chart_of: atlas.chart_of.clone(),
            charts: Vec::new(),
            hash: String::new(),
            density: atlas.density * scale,
            notes: Vec::new(),
        };
        let TexelMap { width, height, texels, index, .. } = finer.texel_map(scene);
        let normal = |point: SurfacePoint| scene.area_normal(point.triangle).normalize_or_zero().as_vec3();
        let shading_normals =
            texels.par_iter().map(|texel| scene.shading_normal(texel.centroid).as_vec3()).collect();
        Self {
            grid: TexelGrid { scale, width, height, corners: atlas.corners.clone(), index },
            places: texels.iter().map(|texel| [texel.x, texel.y]).collect(),
            points: texels.iter().map(|texel| texel.centroid).collect(),
            positions: texels.par_iter().map(|texel| texel.centroid.position(scene)).collect(),
            normals: texels.par_iter().map(|texel| normal(texel.centroid)).collect(),
            shading_normals,
            areas: texels.iter().map(|texel| texel.area as f32).collect(),
        }
    }

    /// The number of covered texels.
    pub fn count(&self) -> usize {
        self.positions.len()
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [u32; 2] {
        [self.grid.width, self.grid.height]
    }

    /// The middle of the surface that a texel covers.
    pub fn point(&self, texel: usize) -> SurfacePoint {
        self.points[texel]
    }

    /// The position of a texel's point, in the world.
    pub fn position(&self, texel: usize) -> DVec3 {
        self.positions[texel]
    }

    /// The geometric unit normal at a texel's point.
    pub fn normal(&self, texel: usize) -> Vec3 {
        self.normals[texel]
    }

    /// The interpolated unit normal at a texel's point.
    pub fn shading_normal(&self, texel: usize) -> Vec3 {
        self.shading_normals[texel]
    }

    /// The area of surface that a texel covers, square scene units.
    pub fn area(&self, texel: usize) -> f32 {
        self.areas[texel]
    }

    /// Column and row of a texel in the grid.
    pub fn place(&self, texel: usize) -> [u32; 2] {
        self.places[texel]
    }
}

impl TexelGrid {
    /// The number of the texel at a column and row; `None` if none is covered there.
    pub fn at(&self, x: i64, y: i64) -> Option<usize> {
        let is_inside = x >= 0 && y >= 0 && x < i64::from(self.width) && y < i64::from(self.height);
        let number = is_inside.then(|| self.index[y as usize * self.width as usize + x as usize])?;
        (number != NO_TEXEL).then_some(number as usize)
    }

    /// Position of a point, in texels from the upper left corner; `None` if the atlas has no place for it.
    pub fn place(&self, point: SurfacePoint) -> Option<DVec2> {
        let corners = self.corners.get(point.triangle as usize)?.map(Vec2::as_dvec2);
        let [a, b, c] = point.weights();
        let place = (corners[0] * a + corners[1] * b + corners[2] * c) * self.scale;
        place.is_finite().then_some(place)
    }

    /// The texels around a point, for bilinear interpolation; `None` if the atlas has no place for it.
    pub fn around(&self, point: SurfacePoint) -> Option<TexelWeights> {
        let at = self.place(point)? - 0.5;
        let floor = at.floor();
        let share = at - floor;
        let (x, y) = (floor.x as i64, floor.y as i64);
        let mut around = [(0, 0.0); 4];
        let mut sum = 0.0;
        for (k, slot) in around.iter_mut().enumerate() {
            let (dx, dy) = (k as i64 & 1, k as i64 >> 1);
            let weight = DVec2::new(
                if dx == 0 { 1.0 - share.x } else { share.x },
                if dy == 0 { 1.0 - share.y } else { share.y },
            );
            if let Some(texel) = self.at(x + dx, y + dy) {
                *slot = (texel as u32, (weight.x * weight.y) as f32);
                sum += slot.1;
            }
        }
        if sum <= 0.0 {
            // The texel of a place without area may be one step away.
            let (x, y) = (at.x.round() as i64, at.y.round() as i64);
            let steps = [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];
            let texel = steps.into_iter().find_map(|[dx, dy]| self.at(x + dx, y + dy))?;
            return Some([
                (texel as u32, 1.0),
                (texel as u32, 0.0),
                (texel as u32, 0.0),
                (texel as u32, 0.0),
            ]);
        }
        Some(around.map(|(texel, weight)| (texel, weight / sum)))
    }
}
