//! From a scene to its atlas.

pub mod child;
mod engine;
mod part_mesh;
mod patches;
mod planar;
mod reusable_charts;
mod surface_patch;
mod xatlas;

use crate::packing::overlap::has_overlaps;
use crate::packing::unpacked_chart::{UnpackedChart, signed_area};
use crate::packing::{PackedCharts, pack};
use crate::{Atlas, AtlasError, UnwrapOptions, UvPolicy};
use child::{ChildError, ChildProgram};
use engine::{Engine, flatten_with_uvunwrap};
use glam::{DVec2, DVec3, Vec2};
use part_mesh::{CheckedPart, PartMesh};
use patches::PATCH_TRIANGLES;
use progress::{Progress, Stage};
use rayon::prelude::*;
use reusable_charts::is_badly_stretched;
use scene::Scene;
use std::collections::{BTreeMap, HashMap};
use surface_patch::{FlattenedPatch, SurfacePatch, UNPLACED};

impl Atlas {
    /// Gives every triangle of the scene a place of its own, and every Gaussian splat a texel.
    ///
    /// Every scene with a triangle gets an atlas: what the engines fail on is projected, and triangles without area
    /// get places without area. Deviations from the options are listed in [`Atlas::notes`].
    ///
    /// # Errors
    /// [`AtlasError::Cancelled`]; [`AtlasError::NoTriangles`]; [`AtlasError::TooManyCharts`] if there are more
    /// separate pieces than the largest atlas holds.
    pub fn unwrap(
        scene: &Scene,
        options: &UnwrapOptions,
        progress: &dyn Progress,
    ) -> Result<Self, AtlasError> {
        if scene.triangles.is_empty() {
            return Err(AtlasError::NoTriangles);
        }
        if let Some(splats) = &scene.splats {
            return match scene.without_splats() {
                Some(surfaces) => Self::unwrap(&surfaces, options, progress)?.with_splats(scene, splats),
                None => Self::of_splats(scene, splats),
            };
        }
        if let Some(floor) = &scene.floor {
            return Self::unwrap(&scene.without_floor(), options, progress)?.with_floor(scene, floor);
        }
        let parts: Vec<PreparedPart> = (0..scene.parts.len() as u32)
            .into_par_iter()
            .map(|part| {
                progress.check()?;
                Ok(PreparedPart::new(scene, part, options.uv))
            })
            .collect::<Result<_, AtlasError>>()?;
        progress.report(0.1);

        let mut notes = Vec::new();
        let mut charts = flatten_patches(&parts, options, &Stage::new(progress, 0.1, 0.8), &mut notes)?;
        charts.extend(parts.iter().flat_map(|part| part.charts.iter().cloned()));
        // A part without any area gets a chart of one point.
        for (part, prepared) in parts.iter().enumerate() {
            if prepared.meshes.is_empty() && !prepared.degenerate.is_empty() {
                let triangles = prepared.degenerate.clone();
                let corners = vec![[DVec2::ZERO; 3]; triangles.len()];
                charts.push(UnpackedChart { part: part as u32, triangles, corners, can_rotate: false });
            }
        }
        charts.sort_by_key(|chart| (chart.part, chart.triangles[0]));

        let packed = pack(&charts, options.density, options.gutter, &Stage::new(progress, 0.8, 1.0))?;
        notes.extend(packed.notes.iter().cloned());
        let mut atlas = assemble(scene, &charts, packed, &parts);
        atlas.notes = notes;
        progress.report(1.0);
        Ok(atlas)
    }
}

/// A part during unwrapping: what needs no engine is already a chart.
struct PreparedPart {
    meshes: Vec<PartMesh>,
    degenerate: Vec<u32>,
    charts: Vec<UnpackedChart>,
    /// What is for the engines.
    patches: Vec<PatchOfMesh>,
}

/// A piece of a mesh, or a part of one.
struct PatchOfMesh {
    /// Index of the mesh.
    mesh: usize,
    triangles: Vec<u32>,
    /// Whether it is a part of a piece that is too large for the engines.
    is_cut: bool,
}

impl PreparedPart {
    fn new(scene: &Scene, part: u32, policy: UvPolicy) -> Self {
        let checked = CheckedPart::new(scene, part);
        let reused = match policy {
            UvPolicy::Auto => reusable_charts::reusable_charts(scene, part, &checked),
            UvPolicy::Ignore => None,
        };
        let CheckedPart { meshes, degenerate } = checked;
        let mut prepared = Self { meshes, degenerate, charts: Vec::new(), patches: Vec::new() };
        match reused {
            Some(charts) => prepared.charts = charts,
            None => prepared.cut_patches(),
        }
        prepared
    }

    /// Turns flat pieces into charts and the others into patches.
    fn cut_patches(&mut self) {
        for (index, mesh) in self.meshes.iter().enumerate() {
            let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
            for piece in mesh.connected_pieces(&all, |_, _| true) {
                if let [single] = piece[..] {
                    let triangle = mesh.triangles[single as usize];
                    self.charts.push(UnpackedChart::from_triangle(
                        mesh.part,
                        triangle,
                        mesh.corner_positions(single),
                    ));
                } else if let Some(chart) = planar::flat_chart(mesh, &piece) {
                    self.charts.push(chart);
                } else {
                    let patches = patches::cut_into_patches(mesh, piece);
                    let is_cut = patches.len() > 1;
                    let patch = |triangles| PatchOfMesh { mesh: index, triangles, is_cut };
                    self.patches.extend(patches.into_iter().map(patch));
                }
            }
        }
    }
}

/// The charts of all patches: by each engine in turn, and by projection where they fail.
fn flatten_patches(
    parts: &[PreparedPart],
    options: &UnwrapOptions,
    progress: &dyn Progress,
    notes: &mut Vec<String>,
) -> Result<Vec<UnpackedChart>, AtlasError> {
    let work: Vec<(&PartMesh, &PatchOfMesh)> = parts
        .iter()
        .flat_map(|part| part.patches.iter().map(|patch| (&part.meshes[patch.mesh], patch)))
        .collect();
    if work.is_empty() {
        return Ok(Vec::new());
    }
    let requests: Vec<SurfacePatch> =
        work.par_iter().map(|(mesh, patch)| SurfacePatch::new(mesh, &patch.triangles)).collect();
    let is_cut: Vec<bool> = work.iter().map(|(_, patch)| patch.is_cut).collect();
    let flattened = run_engines(&requests, &is_cut, options, progress, notes)?;
    let charts: Vec<Vec<UnpackedChart>> = work
        .par_iter()
        .zip(&flattened)
        .map(|(&(mesh, PatchOfMesh { triangles, .. }), flattened)| {
            progress.check()?;
            Ok(match flattened {
                Some(flattened) => sound_charts(mesh, triangles, flattened),
                None => planar::planar_charts(mesh, triangles),
            })
        })
        .collect::<Result<_, AtlasError>>()?;
    let failed = flattened.iter().filter(|f| f.is_none()).count();
    if failed > 0 {
        notes.push(format!(
            "{failed} of {} patches were projected: every unwrapping engine failed on them",
            work.len()
        ));
    }
    Ok(charts.concat())
}

/// Flattens patches by one engine after another: whole pieces by xatlas first, parts of large ones by uvunwrap, which makes fewer and less
/// stretched charts of them in half the time (of small pieces it makes more).
fn run_engines(
    patches: &[SurfacePatch],
    is_cut: &[bool],
    options: &UnwrapOptions,
    progress: &dyn Progress,
    notes: &mut Vec<String>,
) -> Result<Vec<Option<FlattenedPatch>>, AtlasError> {
    let mut flattened: Vec<Option<FlattenedPatch>> = vec![None; patches.len()];
    let open = |flattened: &[Option<FlattenedPatch>], is_wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..patches.len()).filter(|&i| flattened[i].is_none() && is_wanted(i)).collect()
    };
    let share = |count: usize| count as f32 / patches.len() as f32;
    if let Some(path) = &options.child {
        let program = ChildProgram { path, arguments: &options.child_arguments, deadline: options.deadline };
        type IsWanted<'a> = &'a dyn Fn(usize) -> bool;
        let rounds: [(Engine, IsWanted<'_>); 3] = [
            (Engine::Xatlas, &|patch| !is_cut[patch]),
            (Engine::Uvunwrap, &|_| true),
            (Engine::Xatlas, &|patch| is_cut[patch]),
        ];
        for (engine, is_wanted) in rounds {
            let waiting = open(&flattened, is_wanted);
            if waiting.is_empty() {
                continue;
            }
            let requests: Vec<&SurfacePatch> = waiting.iter().map(|&i| &patches[i]).collect();
            let done = flattened.iter().flatten().count();
            let stage = Stage::new(progress, share(done), share(done + waiting.len()));
            match child::flatten_in_children(&program, engine, &requests, batch_size(&requests), &stage) {
                Ok(answers) => {
                    if answers.lost > 0 {
                        notes.push(format!(
                            "{} failed on {} batches of patches",
                            engine.name(),
                            answers.lost
                        ));
                    }
                    for (&i, answer) in waiting.iter().zip(answers.flattened) {
                        let triangles = patches[i].corners.len();
                        flattened[i] = answer.filter(|answer| answer.chart.len() == triangles);
                    }
                }
                Err(ChildError::Cancelled) => return Err(AtlasError::Cancelled),
                Err(ChildError::OutOfMemory) => return Err(AtlasError::OutOfMemory),
                Err(ChildError::Unusable(reason)) => {
                    notes.push(format!("unwrapping ran in this process: {reason}"));
                    return flatten_here(patches, flattened, progress);
                }
            }
        }
        return Ok(flattened);
    }
    flatten_here(patches, flattened, progress)
}

/// Flattens what is not flattened yet in this process, by the engine that does not crash.
fn flatten_here(
    patches: &[SurfacePatch],
    mut flattened: Vec<Option<FlattenedPatch>>,
    progress: &dyn Progress,
) -> Result<Vec<Option<FlattenedPatch>>, AtlasError> {
    for (n, (patch, place)) in patches.iter().zip(&mut flattened).enumerate() {
        progress.check()?;
        if place.is_none() {
            *place = flatten_with_uvunwrap(patch, &|| progress.cancelled());
        }
        progress.report((n + 1) as f32 / patches.len() as f32);
    }
    progress.check()?;
    Ok(flattened)
}

/// Triangles of a child's batch: enough that starting the process does not matter, few enough that all cores stay
/// busy.
fn batch_size(patches: &[&SurfacePatch]) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let triangles: usize = patches.iter().map(|p| p.corners.len()).sum();
    (triangles / (3 * cores)).clamp(PATCH_TRIANGLES, 4 * PATCH_TRIANGLES)
}

/// An engine's charts, checked: whatever folds, overlaps or is badly stretched is projected instead.
fn sound_charts(mesh: &PartMesh, triangles: &[u32], flattened: &FlattenedPatch) -> Vec<UnpackedChart> {
    let mut by_chart: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, &chart) in flattened.chart.iter().enumerate() {
        by_chart.entry(chart).or_default().push(i);
    }
    let mut charts = Vec::new();
    let mut left: Vec<u32> = Vec::new();
    for (number, mut members) in by_chart {
        if number == UNPLACED {
            left.extend(members.iter().map(|&i| triangles[i]));
            continue;
        }
        let plane = |i: usize| flattened.corners[i].map(|[x, y]| DVec2::new(x.into(), y.into()));
        let orientation = members.iter().map(|&i| signed_area(plane(i))).sum::<f64>().signum();
        members.retain(|&i| {
            let sound = signed_area(plane(i)) * orientation > 0.0;
            if !sound {
                left.push(triangles[i]);
            }
            sound
        });
        if members.is_empty() {
            continue;
        }
        let worlds: Vec<[DVec3; 3]> = members.iter().map(|&i| mesh.corner_positions(triangles[i])).collect();
        let mut chart = UnpackedChart {
            part: mesh.part,
            triangles: members.iter().map(|&i| mesh.triangles[triangles[i] as usize]).collect(),
            corners: members.iter().map(|&i| plane(i)).collect(),
            can_rotate: true,
        };
        let sound = chart.scale_to_world(&worlds).is_some()
            && !is_badly_stretched(&chart, &worlds)
            && !has_overlaps(&chart.corners);
        if sound {
            charts.push(chart);
        } else {
            left.extend(members.iter().map(|&i| triangles[i]));
        }
    }
    charts.extend(planar::planar_charts(mesh, &left));
    charts
}

/// Puts the packed charts and the degenerate triangles into the atlas.
fn assemble(scene: &Scene, charts: &[UnpackedChart], packed: PackedCharts, parts: &[PreparedPart]) -> Atlas {
    let mut corners = vec![[Vec2::ZERO; 3]; scene.triangles.len()];
    let mut chart_of = vec![0; scene.triangles.len()];
    let mut placed = vec![false; scene.triangles.len()];
    for (number, (chart, places)) in charts.iter().zip(&packed.corners).enumerate() {
        for (&triangle, &place) in chart.triangles.iter().zip(places) {
            corners[triangle as usize] = place;
            chart_of[triangle as usize] = number as u32;
            placed[triangle as usize] = true;
        }
    }
    for prepared in parts.iter().filter(|part| !part.meshes.is_empty() && !part.degenerate.is_empty()) {
        // A triangle without area lies in a corner of a neighbour, or else of the part's first triangle.
        let mut at_vertex: HashMap<u32, (Vec2, u32)> = HashMap::new();
        for &triangle in prepared.meshes.iter().flat_map(|mesh| &mesh.triangles) {
            let vertices = scene.triangles[triangle as usize].vertices;
            for (vertex, corner) in vertices.into_iter().zip(corners[triangle as usize]) {
                at_vertex.entry(vertex).or_insert((corner, chart_of[triangle as usize]));
            }
        }
        let first = prepared.meshes[0].triangles[0] as usize;
        let fallback = (corners[first][0], chart_of[first]);
        for &triangle in prepared.degenerate.iter().filter(|&&t| !placed[t as usize]) {
            let vertices = scene.triangles[triangle as usize].vertices;
            let (place, chart) = vertices.iter().find_map(|v| at_vertex.get(v).copied()).unwrap_or(fallback);
            corners[triangle as usize] = [place; 3];
            chart_of[triangle as usize] = chart;
        }
    }
    let part_of_chart: Vec<u32> = charts.iter().map(|chart| chart.part).collect();
    Atlas::new([packed.width, packed.height], corners, chart_of, &part_of_chart, packed.density)
}
