//! A stroke over several charts, one of them mirrored: no crack, and the same map whatever the rhythm of the events.

#[allow(dead_code, reason = "only its container is needed")]
mod tiny_glb;

use document::{Document, StrokePoint, view_ray};
use focus::{Brush, Focus, FocusMap, ViewFrame};
use glam::{DVec2, Mat2, Vec2};
use lens::{Camera, FocusOffset};
use project::{RecordedStep, RecordedStroke};
use render::{RenderOptions, render};
use serde_json::json;
use session::{Command, Session, SessionOptions};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Half the wall's width and height, and its depth, m.
const HALF: [f32; 2] = [2.0, 0.75];
const DEPTH: f32 = 4.0;

/// How an artist laid out the strips of the wall: upright, mirrored, a quarter turn, mirrored and turned.
const LAID_OUT: [[[f32; 2]; 2]; 4] = [
    [[1.0, 0.0], [0.0, 1.0]],
    [[-1.0, 0.0], [0.0, 1.0]],
    [[0.0, 1.0], [-1.0, 0.0]],
    [[0.0, 1.0], [1.0, 0.0]],
];

/// Writes a wall of upright strips, as many as there are layouts, each an island of the texture coordinates.
fn write_wall(file: &Path, layouts: &[[[f32; 2]; 2]]) {
    let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    let half = Vec2::new(HALF[0] / layouts.len() as f32, HALF[1]);
    for (k, layout) in layouts.iter().enumerate() {
        let middle = half.x * (2 * k + 1) as f32 - HALF[0];
        let first = positions.len() as u16;
        for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from) {
            positions.push([middle + corner.x * half.x, corner.y * half.y, -DEPTH]);
            // Islands in squares of their own, 2 units of the wall wide and high.
            let place = Mat2::from_cols_array_2d(layout) * (corner * half);
            let uv = (place / 2.0 + Vec2::new(0.5 + k as f32, 0.5)) / layouts.len() as f32;
            uvs.push(uv.to_array());
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    let mut bin: Vec<u8> = Vec::new();
    let mut view = |bytes: Vec<u8>| {
        let view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() });
        bin.extend(bytes);
        view
    };
    let bytes =
        |numbers: &mut dyn Iterator<Item = f32>| numbers.flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let views = [
        view(bytes(&mut positions.iter().flatten().copied())),
        view(bytes(&mut uvs.iter().flatten().copied())),
        view(indices.iter().flat_map(|index| index.to_le_bytes()).collect()),
    ];
    let doc = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "name": "wall", "mesh": 0 }, { "name": "front", "camera": 0 }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.3, "znear": 0.1, "aspectRatio": 2.5 } }],
        "materials": [{
            "name": "white",
            "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.8, 0.8, 1.0] },
            "extensions": { "KHR_materials_unlit": {} },
        }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0,
        }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3",
              "min": [-HALF[0], -HALF[1], -DEPTH], "max": [HALF[0], HALF[1], -DEPTH] },
            { "bufferView": 1, "componentType": 5126, "count": uvs.len(), "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": indices.len(), "type": "SCALAR" },
        ],
        "bufferViews": views,
        "buffers": [{ "byteLength": bin.len() }],
    });
    std::fs::write(file, tiny_glb::container(&doc, &bin)).unwrap();
}

fn begun(file: &Path) -> Document {
    Document::create(
        file,
        &Default::default(),
        &Default::default(),
        &Default::default(),
        &progress::Unwatched,
    )
    .unwrap()
}

/// The shot camera, small and with a wide lens focused on the wall.
fn camera(document: &Document) -> Camera {
    let focus_distance = f64::from(DEPTH);
    Camera { width: 250, height: 100, focus_distance, aperture_radius: 0.05, ..document.camera.clone() }
}

/// A stroke along the wall, over all of its strips: 200 dabs, a hundredth of a radius here and there.
fn stroke(camera: &Camera) -> RecordedStroke {
    let view = ViewFrame::from_camera(camera);
    let target = FocusOffset::new(1.02, 1.0);
    let brush = Brush { radius: 0.2, hardness: 0.3, target, ..Brush::default() };
    // The picture is 3.02 m wide at the wall's depth.
    let width = 2.0 * f64::from(DEPTH) * (camera.yfov / 2.0).tan() * camera.aspect();
    let length = 199.0 * brush.radius * brush.spacing;
    assert!(length > 2.0 * width, "it goes there and back: {length} m on {width} m");
    let points = 120;
    let point = |k: u32| {
        // There, back and there again, a little lower each time.
        let share = f64::from(k) / f64::from(points - 1) * 3.2;
        let across = (share % 2.0 - 1.0).abs();
        [0.08 + 0.84 * across, 0.35 + 0.08 * share, 0.6 + 0.4 * (share * 2.0).cos().abs()]
    };
    RecordedStroke {
        layer: "Paint".into(),
        brush,
        view: view.into(),
        points: (0..points).map(point).collect(),
    }
}

/// Where the strips meet, m.
const SEAMS: [f64; 3] = [-1.0, 0.0, 1.0];

/// Positions of the picture: every pixel's middle, and close to the seams, down to a tenth of a texel.
fn places(document: &Document, camera: &Camera) -> Vec<DVec2> {
    let [width, height] = [camera.width, camera.height].map(f64::from);
    let pixels =
        (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| DVec2::new(x.into(), y.into())));
    let mut places: Vec<DVec2> = pixels.map(|pixel| (pixel + 0.5) / DVec2::new(width, height)).collect();
    let texel = 1.0 / document.stage.atlas.density;
    for seam in SEAMS {
        for offset in [-4.0, -2.0, -1.0, -0.5, -0.1, 0.1, 0.5, 1.0, 2.0, 4.0] {
            let x = camera
                .pixel_from_q(
                    DVec2::new((seam + offset * texel) / f64::from(DEPTH), 0.0) / (camera.yfov / 2.0).tan(),
                )
                .x;
            places.extend((0..camera.height).map(|y| DVec2::new(x / width, (f64::from(y) + 0.5) / height)));
        }
    }
    places
}

/// κ at places of the picture.
fn kappas(document: &Document, map: &FocusMap, camera: &Camera, places: &[DVec2]) -> Vec<f64> {
    let view = ViewFrame::from_camera(camera);
    let kappa = |&at: &DVec2| {
        let hit = document::pick(document.stage.tracer(), &view_ray(&view, at))
            .expect("the wall fills the picture");
        let focus = map.sample(document.stage.atlas.position_of(hit.point));
        camera.optics().kappa(1.0 / camera.camera_from_world(hit.position).z, focus)
    };
    places.iter().map(kappa).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Coverage of the picture that a focus gives.
fn coverage(document: &Document, map: &FocusMap, camera: &Camera) -> Vec<f64> {
    let stage = &document.stage;
    let focus =
        Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), std::sync::Arc::new(map.clone()));
    let options = RenderOptions::default();
    let rendered = render(&stage.lit, camera, &focus, &options, &progress::Unwatched).unwrap();
    rendered.picture.coverage.iter().map(|c| f64::from(*c)).collect()
}

/// The wall as a brush would leave it that stops at charts: unpainted within a distance of the seams.
fn cracked(document: &Document, width: f64) -> FocusMap {
    let mut map = document.map.clone();
    let canvas = &document.stage.canvas;
    for (index, texel) in canvas.texels().enumerate() {
        if SEAMS.iter().any(|seam| (texel.position.x - seam).abs() < width) {
            for &[x, y] in [[texel.x, texel.y]].iter().chain(canvas.gutters_of(index)) {
                map.set(x, y, [1.0, 0.0]);
            }
        }
    }
    map
}

#[test]
fn a_stroke_over_charts_and_a_mirrored_island_leaves_no_crack() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let [strips, whole] = ["strips", "whole"].map(|name| folder.join(format!("{name}.glb")));
    write_wall(&strips, &LAID_OUT);
    write_wall(&whole, &LAID_OUT[..1]);
    let (mut strips, mut whole) = (begun(&strips), begun(&whole));
    let camera = camera(&strips);
    let stroke = stroke(&camera);
    let steps = [RecordedStep::Stroke(stroke)];
    project::write_strokes(&folder.join("seams.json"), &steps).unwrap();
    for document in [&mut strips, &mut whole] {
        assert_eq!(document::replay(document, &steps).unwrap(), 1);
    }
    let charts = &strips.stage.atlas.charts;
    assert_eq!((charts.len(), whole.stage.atlas.charts.len()), (4, 1));
    // Which of the artist's islands run the other way round; texture coordinates run downward.
    let mirrored = [0, 2, 4, 6].map(|triangle| {
        let [a, b, c] = strips.stage.scene.corner_uv(triangle, 0);
        (b - a).perp_dot(c - a) < 0.0
    });
    assert_eq!(mirrored, [false, true, false, true]);

    // The same defocus everywhere as on a wall without seams, but for the texels' other places.
    let places = places(&strips, &camera);
    let found = kappas(&strips, &strips.map, &camera, &places);
    let expected = kappas(&whole, &whole.map, &camera, &places);
    let painted = expected.iter().fold(0.0f64, |most, kappa| most.max(kappa.abs()));
    let difference = largest_difference(&found, &expected) / painted;
    assert!(difference < 0.03, "{difference} of the painted defocus");
    let crack = kappas(&strips, &cracked(&strips, 1.0 / strips.stage.atlas.density), &camera, &places);
    let crack = largest_difference(&crack, &expected) / painted;
    assert!(crack > 0.3, "a crack of a texel is found: {crack}");

    // And the same picture: where defocus steps, coverage tells.
    let expected = coverage(&whole, &whole.map, &camera);
    let difference = largest_difference(&coverage(&strips, &strips.map, &camera), &expected);
    let crack = largest_difference(&coverage(&strips, &cracked(&strips, 0.02), &camera), &expected);
    assert!(difference < 0.1 && crack > 5.0 * difference, "{difference}, with a crack {crack}");
}

#[test]
fn a_stroke_paints_the_same_map_at_any_rate_of_events_and_frames() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strips.glb");
    write_wall(&file, &LAID_OUT);
    let mut replayed = begun(&file);
    let stroke = stroke(&camera(&replayed));
    document::replay(&mut replayed, &[RecordedStep::Stroke(stroke.clone())]).unwrap();
    // Events a frame, and how long a frame takes.
    for (events, pause) in [(1, 0), (1, 3), (7, 1), (500, 0)] {
        let keep_after = Duration::from_secs(3600);
        let options =
            SessionOptions { preview_size: 60, recovery_delay: keep_after, ..SessionOptions::default() };
        let mut session = Session::new(options).unwrap();
        session.apply(Command::Open(file.clone())).unwrap();
        while session.document().is_none() {
            session.poll();
            std::thread::sleep(Duration::from_millis(2));
        }
        session.apply(Command::SetBrush(stroke.brush.clone())).unwrap();
        for (k, point) in stroke.points.iter().enumerate() {
            let point = StrokePoint::from_recorded(&stroke.view, point);
            let command = if k == 0 { Command::BeginStroke(point) } else { Command::ExtendStroke(point) };
            session.apply(command).unwrap();
            if k % events == 0 {
                session.poll();
                std::thread::sleep(Duration::from_millis(pause));
            }
        }
        session.apply(Command::CommitStroke).unwrap();
        assert!(session.document().unwrap().map == replayed.map, "{events} events every {pause} ms");
    }
    // And it can fail: a point less is another map.
    let mut shorter = begun(&file);
    let points = stroke.points[..110].to_vec();
    document::replay(&mut shorter, &[RecordedStep::Stroke(RecordedStroke { points, ..stroke })]).unwrap();
    assert!(shorter.map != replayed.map);
}
