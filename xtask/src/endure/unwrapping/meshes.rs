//! Twenty kinds of meshes that are hard to flatten.

use crate::endure::harness::seeded::Seeded;
use std::f64::consts::{PI, TAU};

/// How many kinds there are.
pub const KINDS: usize = 20;

/// Positions and triangles.
#[derive(Default)]
pub struct Mesh {
    /// The positions.
    pub positions: Vec<[f32; 3]>,
    /// Three positions each.
    pub triangles: Vec<[u32; 3]>,
}

/// The mesh of a kind with about this many triangles, and what it is.
pub fn mesh(kind: usize, size: usize, seed: usize) -> (&'static str, Mesh) {
    let mut random = Seeded::new(seed);
    let side = ((size as f64 / 2.0).sqrt() as usize).max(2);
    match kind {
        0 => ("every other triangle without area", without_area(size, &mut random)),
        1 => ("every triangle twice, once turned over", doubled(grid(side, side, flat))),
        2 => ("many pages on one edge", pages(size)),
        3 => ("huge coordinates", scaled(grid(side, side, wave), 4e14)),
        4 => ("tiny coordinates", scaled(grid(side, side, wave), 1e-18)),
        5 => ("slivers a million times as long as wide", slivers(size)),
        6 => ("a Möbius strip", grid(size / 2, 1, moebius)),
        7 => (
            "two spheres through each other",
            joined(grid(side, side / 2 + 1, ball(0.0)), grid(side, side / 2 + 1, ball(0.7))),
        ),
        8 => ("loose triangles", loose(size, &mut random)),
        9 => ("a fan around one vertex", fan(size, 1.0, |_| 0.3)),
        10 => ("spikes around one vertex", fan(size, 1.0, |k| if k % 2 == 0 { 1.0 } else { 0.02 })),
        11 => ("a Klein bottle", grid(side, side, klein)),
        12 => ("a sphere with every other triangle turned over", turned(grid(side, side / 2 + 1, ball(0.0)))),
        13 => ("a sheet folded onto itself", grid(side, side, folded)),
        14 => ("a fan four times around one vertex", fan(size, 4.0, |k| 1.0 + 0.1 * (k % 3) as f64)),
        15 => ("from a millionth to a million", many_scales(size, &mut random)),
        16 => ("triangles of random vertices", soup(size, &mut random)),
        17 => ("triangles that touch at points only", chain(size)),
        18 => ("a wall of open boxes that share their edges", boxes(size)),
        // Positions beyond 1e15 are left out on reading, and said.
        _ => ("the largest and the smallest numbers that are read", extremes(size, &mut random)),
    }
}

impl Mesh {
    fn push(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position.map(|c| c as f32));
        self.positions.len() as u32 - 1
    }

    fn triangle(&mut self, corners: [[f64; 3]; 3]) {
        let corners = corners.map(|corner| self.push(corner));
        self.triangles.push(corners);
    }

    /// The smallest height of a triangle.
    pub fn smallest_height(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|index| self.positions[index as usize].map(f64::from));
        let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let length = |v: [f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
        let (u, v, w) = (minus(b, a), minus(c, a), minus(c, b));
        let longest = length(u).max(length(v)).max(length(w));
        // Of unit size, so that no product overflows or vanishes.
        let [u, v] = [u, v].map(|side| side.map(|c| c / longest));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        length(cross) * longest
    }
}

/// A surface over [0, 1]², in cells of two triangles that share their vertices.
fn grid(columns: usize, rows: usize, surface: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            mesh.push(surface(column as f64 / columns as f64, row as f64 / rows as f64));
        }
    }
    let at = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let corners =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            mesh.triangles.push([corners[0], corners[1], corners[2]]);
            mesh.triangles.push([corners[0], corners[2], corners[3]]);
        }
    }
    mesh
}

fn flat(u: f64, v: f64) -> [f64; 3] {
    [u, v, 0.0]
}

fn wave(u: f64, v: f64) -> [f64; 3] {
    [u, v, 0.2 * (7.0 * u).sin() * (5.0 * v).cos()]
}

fn ball(shift: f64) -> impl Fn(f64, f64) -> [f64; 3] {
    move |u, v| {
        let (longitude, latitude) = (TAU * u, PI * (v - 0.5));
        [longitude.cos() * latitude.cos() + shift, latitude.sin(), longitude.sin() * latitude.cos()]
    }
}

fn moebius(u: f64, v: f64) -> [f64; 3] {
    let (angle, across) = (TAU * u, 0.4 * (v - 0.5));
    let radius = 1.0 + across * (angle / 2.0).cos();
    [radius * angle.cos(), radius * angle.sin(), across * (angle / 2.0).sin()]
}

/// The figure-eight immersion.
fn klein(u: f64, v: f64) -> [f64; 3] {
    let (around, across) = (TAU * u, TAU * v);
    let radius = 2.0 + (around / 2.0).cos() * across.sin() - (around / 2.0).sin() * (2.0 * across).sin();
    let height = (around / 2.0).sin() * across.sin() + (around / 2.0).cos() * (2.0 * across).sin();
    [radius * around.cos(), radius * around.sin(), height]
}

/// There and back in four layers that lie exactly on each other.
fn folded(u: f64, v: f64) -> [f64; 3] {
    let along = 4.0 * u;
    let back = along % 2.0;
    [if back > 1.0 { 2.0 - back } else { back }, v, 0.0]
}

fn scaled(mesh: Mesh, by: f32) -> Mesh {
    let positions = mesh.positions.iter().map(|position| position.map(|c| c * by)).collect();
    Mesh { positions, ..mesh }
}

fn joined(mut mesh: Mesh, other: Mesh) -> Mesh {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
    mesh
}

fn turned(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(0, 1));
    mesh
}

fn doubled(mut mesh: Mesh) -> Mesh {
    let again: Vec<_> = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    mesh.triangles.extend(again);
    mesh
}

fn without_area(size: usize, random: &mut Seeded) -> Mesh {
    let side = ((size as f64 / 4.0).sqrt() as usize).max(2);
    let mut mesh = grid(side, side, wave);
    let count = mesh.positions.len();
    for k in 0..mesh.triangles.len() {
        let [a, b, _] = mesh.triangles[k];
        let other = random.below(count) as u32;
        let triangle = match k % 3 {
            0 => [other; 3],
            1 => [a, b, b],
            _ => {
                let [p, q] = [a, b].map(|index| mesh.positions[index as usize].map(f64::from));
                let middle = mesh.push([0, 1, 2].map(|axis| (p[axis] + q[axis]) / 2.0));
                [a, middle, b]
            }
        };
        mesh.triangles.push(triangle);
    }
    mesh
}

fn pages(size: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let (low, high) = (mesh.push([0.0; 3]), mesh.push([0.0, 1.0, 0.0]));
    for k in 0..size / 2 {
        let angle = TAU * k as f64 / (size / 2) as f64;
        let outer = [mesh.push([angle.cos(), 0.0, angle.sin()]), mesh.push([angle.cos(), 1.0, angle.sin()])];
        mesh.triangles.extend([[low, outer[0], high], [high, outer[0], outer[1]]]);
    }
    mesh
}

fn slivers(size: usize) -> Mesh {
    grid(size / 2, 1, |u, v| [u * size as f64 / 2.0 * 1e-6, v, 1e-7 * (40.0 * u).sin()])
}

fn loose(size: usize, random: &mut Seeded) -> Mesh {
    let mut mesh = Mesh::default();
    let mut unit = || random.below(1 << 20) as f64 / f64::from(1 << 20);
    for _ in 0..size {
        let (middle, reach) = ([10.0 * unit(), 10.0 * unit(), 10.0 * unit()], 0.01 + unit());
        let mut corner = || middle.map(|c| c + reach * (unit() - 0.5));
        let corners = [corner(), corner(), corner()];
        mesh.triangle(corners);
    }
    mesh
}

/// Triangles around one vertex, several times around it, each corner as far away as is said.
fn fan(size: usize, turns: f64, distance: impl Fn(usize) -> f64) -> Mesh {
    let mut mesh = Mesh::default();
    let middle = mesh.push([0.0; 3]);
    for k in 0..=size {
        let (angle, far) = (turns * TAU * k as f64 / size as f64, distance(k));
        mesh.push([far * angle.cos(), far * angle.sin(), 0.2 * (3.0 * angle / turns).sin() * turns]);
    }
    mesh.triangles.extend((0..size as u32).map(|k| [middle, k + 1, k + 2]));
    mesh
}

fn many_scales(size: usize, random: &mut Seeded) -> Mesh {
    let mut mesh = Mesh::default();
    for k in 0..size {
        let scale = 10f64.powf(12.0 * k as f64 / size as f64 - 6.0);
        let mut corner = || [0, 1, 2].map(|_| scale * (1.0 + random.below(1000) as f64 / 1000.0));
        let corners = [corner(), corner(), corner()];
        mesh.triangle(corners);
    }
    mesh
}

fn soup(size: usize, random: &mut Seeded) -> Mesh {
    let mut mesh = Mesh::default();
    let count = (size / 4).max(4);
    for _ in 0..count {
        let position = [0, 1, 2].map(|_| random.below(1000) as f64 / 1000.0);
        mesh.push(position);
    }
    mesh.triangles = (0..size).map(|_| [0, 1, 2].map(|_| random.below(count) as u32)).collect();
    mesh
}

fn chain(size: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let mut joint = mesh.push([0.0; 3]);
    for k in 0..size {
        let (x, turn) = (k as f64, 0.7 * k as f64);
        let side = mesh.push([x + 0.5, turn.cos(), turn.sin()]);
        let next = mesh.push([x + 1.0, 0.0, 0.0]);
        mesh.triangles.push([joint, side, next]);
        joint = next;
    }
    mesh
}

/// Five sides of each box; neighbours share vertices, so that four walls meet in an edge.
fn boxes(size: usize) -> Mesh {
    let count = ((size as f64 / 10.0).sqrt() as usize).max(1);
    let mut mesh = Mesh::default();
    for z in 0..2 {
        for y in 0..=count {
            for x in 0..=count {
                mesh.push([x as f64, y as f64, f64::from(z)]);
            }
        }
    }
    let at = |x: usize, y: usize, z: usize| ((z * (count + 1) + y) * (count + 1) + x) as u32;
    let mut quad = |corners: [u32; 4]| {
        mesh.triangles.extend([[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]);
    };
    for y in 0..count {
        for x in 0..count {
            quad([at(x, y, 0), at(x + 1, y, 0), at(x + 1, y + 1, 0), at(x, y + 1, 0)]);
            quad([at(x, y, 0), at(x, y, 1), at(x + 1, y, 1), at(x + 1, y, 0)]);
            quad([at(x, y, 0), at(x, y + 1, 0), at(x, y + 1, 1), at(x, y, 1)]);
            quad([at(x + 1, y, 0), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x + 1, y + 1, 0)]);
            quad([at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y + 1, 1), at(x, y + 1, 1)]);
        }
    }
    mesh
}

fn extremes(size: usize, random: &mut Seeded) -> Mesh {
    const NUMBERS: [f32; 10] =
        [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, 1e-45, f32::EPSILON, 1e14, -1e14, 9.9e14];
    let mut mesh = Mesh::default();
    for _ in 0..size {
        let first = mesh.positions.len() as u32;
        for _ in 0..3 {
            mesh.positions.push([0, 1, 2].map(|_| *random.one_of(&NUMBERS)));
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    mesh
}
