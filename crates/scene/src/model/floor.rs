//! The floor that was put under a scene: a disc of rings.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::ops::Range;

/// The floor of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Whether it is there; otherwise all its vertices are one point, which nothing sees.
    pub is_shown: bool,
    /// The middle of the disc.
    pub center: DVec3,
    /// The radius of the disc, in scene units.
    pub radius: f64,
    pub(crate) first_triangle: u32,
    pub(crate) first_vertex: u32,
}

/// Corners of each ring.
const SECTORS: u32 = 48;
/// The radii of its rings over its own, and its opacity there: linear between them.
const RINGS: [(f64, f32); 8] =
    [(0.12, 1.0), (0.25, 1.0), (0.4, 1.0), (0.55, 0.96), (0.65, 0.8), (0.8, 0.4), (0.9, 0.12), (1.0, 0.0)];

impl Floor {
    /// Number of its triangles.
    pub const TRIANGLES: u32 = SECTORS * (2 * RINGS.len() as u32 - 1);
    pub(crate) const VERTICES: u32 = 1 + SECTORS * RINGS.len() as u32;

    /// Its triangles.
    pub fn triangles(&self) -> Range<u32> {
        self.first_triangle..self.first_triangle + Self::TRIANGLES
    }

    /// A vertex of the unit disc: its place, counter-clockwise seen from above (x, z), and its opacity.
    pub(crate) fn disc_vertex(vertex: u32) -> (DVec2, f32) {
        let Some(on_ring) = vertex.checked_sub(1) else { return (DVec2::ZERO, 1.0) };
        let (radius, opacity) = RINGS[(on_ring / SECTORS) as usize];
        let (sin, cos) = (TAU * f64::from(on_ring % SECTORS) / f64::from(SECTORS)).sin_cos();
        (radius * DVec2::new(cos, -sin), opacity)
    }

    /// The vertices of a triangle of the unit disc.
    pub(crate) fn disc_triangle(triangle: u32) -> [u32; 3] {
        let (sector, row) = (triangle % SECTORS, triangle / SECTORS);
        let at = |ring: u32, sector: u32| 1 + ring * SECTORS + sector % SECTORS;
        match row.checked_sub(1) {
            None => [0, at(0, sector), at(0, sector + 1)],
            Some(row) if row % 2 == 0 => {
                [at(row / 2, sector), at(row / 2 + 1, sector), at(row / 2 + 1, sector + 1)]
            }
            Some(row) => [at(row / 2, sector), at(row / 2 + 1, sector + 1), at(row / 2, sector + 1)],
        }
    }

    /// The corners of one of its triangles on the unit disc, x and z of the scene, whether it is shown or not.
    pub fn corners_on_disc(&self, triangle: u32) -> [DVec2; 3] {
        Self::disc_triangle(triangle - self.first_triangle).map(|vertex| Self::disc_vertex(vertex).0)
    }
}
