//! The card against the processor, and the shader without a card.

use super::*;
use crate::formats::{Frame, Node, Query, Target, Triangle};
use glam::{DVec2, DVec3};
use graphics_card::BackendChoice;
use scene::{Scene, SurfacePoint};
use test_scenes::{Mesh, unlit_scene_of};
use trace::{PointSet, SightQuery, Viewpoint};

#[test]
fn the_shader_is_valid_and_reads_what_rust_writes() {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let source = formats::source();
    let module =
        naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).expect("it is valid");
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let sizes = [
        ("Node", size_of::<Node>()),
        ("Triangle", size_of::<Triangle>()),
        ("Target", size_of::<Target>()),
        ("Query", size_of::<Query>()),
        ("Frame", size_of::<Frame>()),
        ("Answer", 4 * formats::ANSWER_WORDS),
    ];
    for (name, size) in sizes {
        let (handle, _) = module.types.iter().find(|(_, of)| of.name.as_deref() == Some(name)).expect(name);
        assert_eq!(layouter[handle].size as usize, size, "{name}");
    }
}

/// A card, also one in software; says so where there is none.
fn gpu() -> Option<Gpu> {
    match Gpu::open(BackendChoice::Gpu, None) {
        Ok(gpu) => gpu,
        Err(absent) => {
            eprintln!("skipped: {absent}");
            None
        }
    }
}

/// A pseudo-random number in [0, 1).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as f64 / (1u64 << 31) as f64
}

/// Leaves before a tessellated wall, far from the world's origin.
fn leaves(away: DVec3) -> Arc<Scene> {
    let state = &mut 7u64;
    let mut meshes = Vec::new();
    for k in 0..300 {
        let at = DVec3::new(random(state) - 0.5, random(state) - 0.5, random(state) * 1.5) + away;
        let side = |state: &mut u64| {
            (DVec3::new(random(state), random(state), random(state)) - 0.5)
                * if k % 5 == 0 { 0.002 } else { 0.1 }
        };
        meshes.push((Mesh::rectangle(at, side(state), side(state)), [0.5; 3]));
    }
    for k in 0..64 {
        let corner = DVec3::new(f64::from(k % 8) / 8.0 - 0.5, f64::from(k / 8) / 8.0 - 0.5, -0.2) + away;
        meshes.push((Mesh::rectangle(corner, DVec3::X / 8.0, DVec3::Y / 8.0), [0.5; 3]));
    }
    unlit_scene_of(meshes.iter().map(|(mesh, color)| (mesh, *color)))
}

/// Places in a grid of `side` × `side` cells.
fn places(side: usize) -> TargetPoints {
    let state = &mut 3u64;
    let at = |cell: usize, state: &mut u64| {
        let corner = DVec2::new((cell % side) as f64, (cell / side) as f64);
        (corner + DVec2::new(random(state), random(state))) * (2.0 / side as f64) - 1.0
    };
    TargetPoints::new(&(0..side * side).map(|cell| at(cell, state)).collect::<Vec<_>>())
}

/// Answers of card and processor to many queries; how many bits differ, how many are hidden, how many answers are left to the processor.
fn compared(gpu: &Gpu, scene: Arc<Scene>, square: Square) -> [usize; 4] {
    let tracer = Tracer::new(scene.clone());
    let targets = [places(16), places(8)];
    let sight = CardSight::new(gpu.clone());
    let prepared = sight.prepare(&tracer, &square, &targets.each_ref()).expect("the card works");
    let state = &mut 11u64;
    let query = |k: u32, state: &mut u64| {
        let [a, b] = [random(state), random(state)];
        let barycentric = DVec2::new(a, b * (1.0 - a));
        let triangle = (random(state) * scene.triangles.len() as f64) as u32;
        let from = match k % 10 {
            0 => Viewpoint::Infinity(DVec3::new(a - 0.5, b - 0.5, -1.0)),
            _ => Viewpoint::Surface(SurfacePoint { triangle, barycentric }),
        };
        SightQuery { from, target: k % 2 }
    };
    let queries: Vec<_> = (0..3000).map(|k| query(k, state)).collect();
    let hidden = prepared.hidden(&queries).expect("the card works");
    let [mut differing, mut both, mut left, mut open] = [0; 4];
    for (query, hidden) in queries.iter().zip(hidden) {
        let targets = &targets[query.target as usize];
        let Some(hidden) = hidden else {
            left += 1;
            continue;
        };
        let here = tracer.square_visibility(query.from, &square, targets).hidden;
        let there =
            tracer.visibility_from_hidden(query.from, &square, targets, hidden).hidden & targets.all();
        let count = |set: PointSet| set.iter().count();
        differing += count(here - there) + count(there - here);
        both += count(here & there);
        open += count(targets.all() - here);
    }
    [differing, both, left, open]
}

#[test]
fn a_card_sees_what_the_processor_sees() {
    let Some(gpu) = gpu() else { return };
    for away in [DVec3::ZERO, DVec3::new(3000.0, -500.0, 80.0)] {
        let square =
            Square { center: DVec3::new(0.05, 0.0, 2.5) + away, right: DVec3::X * 0.1, up: DVec3::Y * 0.1 };
        let [differing, both, left, open] = compared(&gpu, leaves(away), square);
        eprintln!(
            "{}: {differing} of {both} hidden and {open} visible points differ, {left} left",
            gpu.name()
        );
        assert!(both > 50_000 && open > 50_000, "{both} {open}");
        assert!(differing * 10_000 < both, "{differing} of {both}");
        assert!(left < 30, "{left}");
    }
}

#[test]
fn a_lost_card_answers_nothing() {
    let Some(gpu) = gpu() else { return };
    let tracer = Tracer::new(leaves(DVec3::ZERO));
    let square = Square { center: DVec3::Z * 2.5, right: DVec3::X * 0.1, up: DVec3::Y * 0.1 };
    let targets = [places(16)];
    let sight = CardSight::new(gpu.clone());
    let prepared = sight.prepare(&tracer, &square, &targets.each_ref()).expect("the card works");
    let query = SightQuery { from: Viewpoint::Infinity(DVec3::NEG_Z), target: 0 };
    assert_eq!(prepared.hidden(&[query]).map(|answers| answers.len()), Some(1));
    gpu.destroy();
    assert!(prepared.hidden(&[query]).is_none());
    assert!(sight.prepare(&tracer, &square, &targets.each_ref()).is_none());
}
