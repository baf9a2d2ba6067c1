//! Building blocks of the scene: surfaces over the unit square, and objects made of them.

use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A point of a surface: the input of a shader.
#[derive(Clone, Copy)]
pub struct Place {
    /// Over the surface, both in [0, 1].
    pub uv: Vec2,
    /// In the world.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

/// Appearance of a surface at a point.
#[derive(Clone, Copy)]
pub struct Skin {
    /// Diffuse reflectance.
    pub albedo: Vec3,
    /// Emitted radiance.
    pub glow: Vec3,
    /// Share of light transmitted from behind, as through a leaf.
    pub translucency: f32,
    /// Wetness: strength of a reflecting coat.
    pub wetness: f32,
    /// Angular variance of the coat's reflection, rad².
    pub ripple: f32,
    /// Unit normal, finer than the mesh's.
    pub normal: Vec3,
}

impl Skin {
    /// A matt one.
    pub fn matt(place: &Place, albedo: Vec3) -> Self {
        Self {
            albedo,
            glow: Vec3::ZERO,
            translucency: 0.0,
            wetness: 0.0,
            ripple: 0.006,
            normal: place.normal,
        }
    }
}

/// A shader: the appearance of a surface at every point.
pub type SkinShader = Arc<dyn Fn(&Place) -> Skin + Send + Sync>;

/// The shader of one matt colour.
pub fn plain(albedo: Vec3) -> SkinShader {
    Arc::new(move |place| Skin::matt(place, albedo))
}

/// A grid of points over the unit square (or one triangle), and how many texels of the light sheet it gets.
#[derive(Clone)]
pub struct Surface {
    /// Points in a row (u).
    pub columns: usize,
    /// Rows (v).
    pub rows: usize,
    /// Row by row; three corners for a triangle.
    pub points: Vec<Vec3>,
    /// Texels along u and v.
    pub texels: [usize; 2],
    /// Its shader.
    pub shader: SkinShader,
    /// Whether both sides are visible, and lit alike.
    pub thin: bool,
}

impl Surface {
    /// The grid of `f(u, v)`. The front is where ∂u × ∂v points.
    pub fn grid(
        columns: usize,
        rows: usize,
        texels: [usize; 2],
        shader: SkinShader,
        f: impl Fn(f32, f32) -> Vec3,
    ) -> Self {
        let at = |i: usize, n: usize| i as f32 / (n - 1) as f32;
        let points = (0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .map(|(i, j)| f(at(i, columns), at(j, rows)));
        let points = points.collect();
        Self { columns, rows, points, texels, shader, thin: false }
    }

    /// One flat triangle, counter-clockwise from the front.
    pub fn facet(corners: [Vec3; 3], texels: usize, shader: SkinShader) -> Self {
        Self { columns: 0, rows: 0, points: corners.to_vec(), texels: [texels; 2], shader, thin: false }
    }

    /// A flat quadrilateral, counter-clockwise from the front; u runs from the first corner to the second.
    pub fn quad(corners: [Vec3; 4], texels: [usize; 2], shader: SkinShader) -> Self {
        let [a, b, c, d] = corners;
        Self { columns: 2, rows: 2, points: vec![a, b, d, c], texels, shader, thin: false }
    }

    /// The same, visible and lit from both sides.
    pub fn thin(mut self) -> Self {
        self.thin = true;
        self
    }

    /// Whether it is a lone triangle.
    pub fn is_facet(&self) -> bool {
        self.columns == 0
    }

    /// The place of (u, v). A facet's corners are (0, 0), (1, 0) and (0, 1); beyond its long side the place
    /// stays on it.
    pub fn place(&self, uv: Vec2) -> Place {
        if self.is_facet() {
            let [a, b, c] = [self.points[0], self.points[1], self.points[2]];
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
            let excess = ((uv.x + uv.y - 1.0) / 2.0).max(0.0);
            let (u, v) = ((uv.x - excess).max(0.0), (uv.y - excess).max(0.0));
            return Place { uv, position: a + (b - a) * u + (c - a) * v, normal };
        }
        let cell = |t: f32, n: usize| {
            let x = t * (n - 1) as f32;
            let i = (x as usize).min(n - 2);
            (i, x - i as f32)
        };
        let ((i, fu), (j, fv)) = (cell(uv.x, self.columns), cell(uv.y, self.rows));
        let at = |i: usize, j: usize| self.points[j * self.columns + i];
        // On the very triangle, so that no place lies beneath the mesh.
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        let position =
            if fu >= fv { a + (b - a) * fu + (c - b) * fv } else { a + (c - d) * fu + (d - a) * fv };
        let corner = |i: usize, j: usize| self.vertex_normal(i, j);
        let normal =
            corner(i, j).lerp(corner(i + 1, j), fu).lerp(corner(i, j + 1).lerp(corner(i + 1, j + 1), fu), fv);
        Place { uv, position, normal: normal.normalize_or(Vec3::Y) }
    }

    fn vertex_normal(&self, i: usize, j: usize) -> Vec3 {
        let at = |i: usize, j: usize| self.points[j * self.columns + i];
        let along = |j: usize| at((i + 1).min(self.columns - 1), j) - at(i.saturating_sub(1), j);
        let across = |i: usize| at(i, (j + 1).min(self.rows - 1)) - at(i, j.saturating_sub(1));
        // At a pole a whole row is one point: the neighbouring row gives the missing direction.
        let mut du = along(j);
        if du.length_squared() < 1e-14 {
            du = along(if j == 0 { 1 } else { j - 1 });
        }
        // Closed around u (a seam): the first and the last column are the same points.
        if self.columns > 3
            && at(0, j).distance_squared(at(self.columns - 1, j)) < 1e-12
            && (i == 0 || i == self.columns - 1)
        {
            let seam = at(1, j) - at(self.columns - 2, j);
            if seam.length_squared() > 1e-14 {
                du = seam;
            }
        }
        du.cross(across(i)).normalize_or_zero()
    }

    /// Its triangles as indices into `points`, without those that have no area.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        if self.is_facet() {
            return vec![[0, 1, 2]];
        }
        let mut triangles = Vec::new();
        for j in 0..self.rows - 1 {
            for i in 0..self.columns - 1 {
                let k = (j * self.columns + i) as u32;
                let below = k + self.columns as u32;
                triangles.push([k, k + 1, below + 1]);
                triangles.push([k, below + 1, below]);
            }
        }
        triangles.retain(|t| {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            (b - a).cross(c - a).length() > 1e-10
        });
        triangles
    }

    /// The (u, v) of a point of `points`.
    pub fn uv_of(&self, point: usize) -> Vec2 {
        if self.is_facet() {
            return [Vec2::ZERO, Vec2::X, Vec2::Y][point];
        }
        let (i, j) = (point % self.columns, point / self.columns);
        Vec2::new(i as f32 / (self.columns - 1) as f32, j as f32 / (self.rows - 1) as f32)
    }
}

/// Light of an object.
#[derive(Clone, Copy)]
pub enum Shine {
    /// Baked into the sheet.
    Baked,
    /// Emission: colour (largest component 1) and strength.
    Emitter(Vec3, f32),
}

/// A named object: a node, a mesh and a material of its own.
pub struct Object {
    /// Name of all three.
    pub name: &'static str,
    /// Its surfaces.
    pub surfaces: Vec<Surface>,
    /// Its light.
    pub shine: Shine,
}

impl Object {
    /// An object with baked light.
    pub fn baked(name: &'static str, surfaces: Vec<Surface>) -> Self {
        Self { name, surfaces, shine: Shine::Baked }
    }
}
