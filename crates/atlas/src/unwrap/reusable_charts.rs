//! An artist's own texture coordinates, reused where they are sound.

use crate::packing::overlap::has_overlaps;
use crate::packing::unpacked_chart::{UnpackedChart, signed_area};
use crate::unwrap::part_mesh::CheckedPart;
use glam::{DVec2, DVec3, Vec2};
use scene::Scene;
use std::collections::HashMap;

/// How far outside [0, 1] coordinates may lie: rounding of exporters.
const UV_TOLERANCE: f32 = 1e-4;

/// A triangle is badly stretched if its density in some direction is less than this fraction of the mean density.
const MIN_DENSITY: f64 = 0.25;

/// A flattening is rejected if more than this fraction of its area is badly stretched.
const MAX_STRETCHED_SHARE: f64 = 0.02;

/// The islands of a part's first sound UV set as charts.
pub(crate) fn reusable_charts(scene: &Scene, part: u32, checked: &CheckedPart) -> Option<Vec<UnpackedChart>> {
    let triangles: Vec<u32> = checked.meshes.iter().flat_map(|m| m.triangles.iter().copied()).collect();
    if triangles.is_empty() {
        return None;
    }
    let has_uv = scene.parts[part as usize].has_uv;
    (0..2u8)
        .filter(|&set| has_uv[set as usize])
        .find_map(|set| charts_of_uv_set(scene, part, &triangles, set))
}

fn charts_of_uv_set(scene: &Scene, part: u32, triangles: &[u32], set: u8) -> Option<Vec<UnpackedChart>> {
    let within = -UV_TOLERANCE..=1.0 + UV_TOLERANCE;
    let uv: Vec<[Vec2; 3]> = triangles.iter().map(|&t| scene.corner_uv(t, set)).collect();
    // NaN is in no range.
    if !uv.iter().flatten().all(|c| within.contains(&c.x) && within.contains(&c.y)) {
        return None;
    }
    let plane: Vec<[DVec2; 3]> = uv.iter().map(|t| t.map(Vec2::as_dvec2)).collect();
    if plane.iter().any(|&t| signed_area(t) == 0.0) || has_overlaps(&plane) {
        return None;
    }
    let mut charts = Vec::new();
    let (mut total, mut stretched) = (0.0, 0.0);
    for island in connected_components(scene, triangles, &uv) {
        let worlds: Vec<[DVec3; 3]> = island.iter().map(|&i| scene.corners(triangles[i])).collect();
        let mut chart = UnpackedChart {
            part,
            triangles: island.iter().map(|&i| triangles[i]).collect(),
            corners: island.iter().map(|&i| plane[i]).collect(),
            can_rotate: false,
        };
        chart.scale_to_world(&worlds)?;
        if chart.corners.iter().any(|&c| signed_area(c) <= 0.0) {
            return None;
        }
        let (chart_total, chart_stretched) = stretched_area(&chart, &worlds);
        total += chart_total;
        stretched += chart_stretched;
        charts.push(chart);
    }
    (stretched <= MAX_STRETCHED_SHARE * total).then_some(charts)
}

/// Whether too much of a chart in world lengths is badly stretched.
pub(crate) fn is_badly_stretched(chart: &UnpackedChart, worlds: &[[DVec3; 3]]) -> bool {
    let (total, stretched) = stretched_area(chart, worlds);
    stretched > MAX_STRETCHED_SHARE * total
}

/// World area of a chart in world lengths, and how much of it is badly stretched.
fn stretched_area(chart: &UnpackedChart, worlds: &[[DVec3; 3]]) -> (f64, f64) {
    let (mut total, mut stretched) = (0.0, 0.0);
    for (&plane, &world) in chart.corners.iter().zip(worlds) {
        let flat = crate::packing::unpacked_chart::flatten_triangle(world);
        let world_area = signed_area(flat);
        total += world_area;
        // The map surface → plane; its smaller singular value is the minimum density.
        let edges = glam::DMat2::from_cols(flat[1] - flat[0], flat[2] - flat[0]);
        let map = glam::DMat2::from_cols(plane[1] - plane[0], plane[2] - plane[0]) * edges.inverse();
        let squares = map.x_axis.length_squared() + map.y_axis.length_squared();
        let determinant = map.determinant();
        let largest =
            (0.5 * (squares + (squares * squares - 4.0 * determinant * determinant).max(0.0).sqrt())).sqrt();
        let smallest_stretch = determinant.abs() / largest;
        // NaN: a needle whose shape was lost to rounding.
        if smallest_stretch.is_nan() || smallest_stretch < MIN_DENSITY {
            stretched += world_area;
        }
    }
    (total, stretched)
}

/// Indices of the triangles of each connected component; triangles are connected by corners of equal position and
/// coordinates.
fn connected_components(scene: &Scene, triangles: &[u32], uv: &[[Vec2; 3]]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..triangles.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut first_with: HashMap<([u64; 3], [u32; 2]), usize> = HashMap::new();
    for (i, (&triangle, uv)) in triangles.iter().zip(uv).enumerate() {
        for (position, uv) in scene.corners(triangle).into_iter().zip(uv) {
            let key =
                ((position + DVec3::ZERO).to_array().map(f64::to_bits), uv.to_array().map(f32::to_bits));
            let other = *first_with.entry(key).or_insert(i);
            let (a, b) = (root(&mut parent, i), root(&mut parent, other));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut islands: Vec<Vec<usize>> = Vec::new();
    let mut number: HashMap<usize, usize> = HashMap::new();
    for i in 0..triangles.len() {
        let root = root(&mut parent, i);
        let island = *number.entry(root).or_insert_with(|| {
            islands.push(Vec::new());
            islands.len() - 1
        });
        islands[island].push(i);
    }
    islands
}
