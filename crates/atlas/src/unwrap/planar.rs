//! Unwrapping without an engine: project along the mean normal, split where that folds or overlaps.
//!
//! It cannot fail: a piece that does not project well is halved, and a single triangle is laid out undistorted. Used
//! for flat pieces, where it is exact, and for whatever the engines fail on.

use crate::packing::overlap::has_overlaps;
use crate::packing::unpacked_chart::{UnpackedChart, signed_area};
use crate::unwrap::part_mesh::PartMesh;
use glam::{DVec2, DVec3};

/// Triangles grow into a piece while their normal is within this cosine of its first triangle's (45°).
const GROW_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A piece counts as flat if every normal is this close to the mean one: 1 − cos of 0.5°.
const MAX_FLATNESS_ERROR: f64 = 4e-5;

/// The planar charts of these triangles of a mesh.
pub(crate) fn planar_charts(mesh: &PartMesh, triangles: &[u32]) -> Vec<UnpackedChart> {
    let mut charts = Vec::new();
    let normal = |t: u32| mesh.area_normal(t).normalize_or_zero();
    for piece in mesh.connected_pieces(triangles, |first, t| normal(first).dot(normal(t)) > GROW_COSINE) {
        split_until_sound(mesh, piece, &mut charts);
    }
    charts
}

/// The chart of a connected piece if it is flat (and, projected, free of overlap).
pub(crate) fn flat_chart(mesh: &PartMesh, triangles: &[u32]) -> Option<UnpackedChart> {
    let normal = mean_normal(mesh, triangles)?;
    let flat = |&t: &u32| mesh.area_normal(t).normalize_or_zero().dot(normal) > 1.0 - MAX_FLATNESS_ERROR;
    if !triangles.iter().all(flat) {
        return None;
    }
    project_to_plane(mesh, triangles)
}

fn split_until_sound(mesh: &PartMesh, piece: Vec<u32>, charts: &mut Vec<UnpackedChart>) {
    let mut pieces = vec![piece];
    while let Some(piece) = pieces.pop() {
        if let [single] = piece[..] {
            let corners = mesh.corner_positions(single);
            charts.push(UnpackedChart::from_triangle(mesh.part, mesh.triangles[single as usize], corners));
        } else if let Some(chart) = project_to_plane(mesh, &piece) {
            charts.push(chart);
        } else {
            for half in halves(mesh, piece) {
                // A half need not be connected, but a chart must be.
                pieces.extend(mesh.connected_pieces(&half, |_, _| true));
            }
        }
    }
}

/// The two halves of a piece by position along its longest extent.
fn halves(mesh: &PartMesh, mut piece: Vec<u32>) -> [Vec<u32>; 2] {
    let (low, high) = piece.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &t| {
        (low.min(mesh.middle(t)), high.max(mesh.middle(t)))
    });
    let axis = (high - low).max_position();
    let at = piece.len() / 2;
    let key = |t: &u32| mesh.middle(*t)[axis];
    piece.select_nth_unstable_by(at, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let second = piece.split_off(at);
    [piece, second]
}

fn mean_normal(mesh: &PartMesh, triangles: &[u32]) -> Option<DVec3> {
    triangles.iter().map(|&t| mesh.area_normal(t)).sum::<DVec3>().try_normalize()
}

/// The projection along the mean normal, if every triangle faces it and none overlap.
fn project_to_plane(mesh: &PartMesh, triangles: &[u32]) -> Option<UnpackedChart> {
    let normal = mean_normal(mesh, triangles)?;
    let (x, y) = normal.any_orthonormal_pair();
    let origin = mesh.middle(triangles[0]);
    let flat = |p: DVec3| DVec2::new((p - origin).dot(x), (p - origin).dot(y));
    let worlds: Vec<_> = triangles.iter().map(|&t| mesh.corner_positions(t)).collect();
    let corners: Vec<_> = worlds.iter().map(|w| w.map(flat)).collect();
    // (x, y, normal) is right-handed, so front faces run from x to y.
    if !corners.iter().all(|&c| signed_area(c) > 0.0) || has_overlaps(&corners) {
        return None;
    }
    let scene_triangles = triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
    let mut chart = UnpackedChart { part: mesh.part, triangles: scene_triangles, corners, can_rotate: true };
    chart.scale_to_world(&worlds)?;
    Some(chart)
}
