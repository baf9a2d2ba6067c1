//! Painting on a strip that is cut into two charts, the second one turned and mirrored.

mod strip;

use focus::{
    Brush, BrushMode, Canvas, CanvasTexel, Channels, Edit, FillTarget, FocusMap, PenSample, Stroke, fill,
};
use glam::{DVec3, Vec3};
use lens::FocusOffset;
use std::sync::Arc;
use strip::{DENSITY, SIZE, blank, brush, hit, strip};

fn draw(map: &mut FocusMap, canvas: &Arc<Canvas>, brush: &Brush, path: &[[f64; 2]]) -> Option<Edit> {
    let mut stroke = Stroke::begin(map, canvas.clone(), brush.clone()).unwrap();
    for &[x, y] in path {
        stroke.extend(map, hit(x, y), PenSample::default());
    }
    stroke.commit(map)
}

#[test]
fn a_dab_depends_on_world_positions_only() {
    let canvas = strip();
    let brush = Brush { strength: 0.8, ..brush(BrushMode::Set) };
    let mut map = blank();
    let mut stroke = Stroke::begin(&map, canvas.clone(), brush.clone()).unwrap();
    // On the cut between the charts.
    let changed = stroke.extend(&mut map, hit(2.0, 0.5), PenSample::default());
    let mut painted = [0; 3];
    for texel in canvas.texels() {
        let t = map.texel(texel.x, texel.y)[0] as f64;
        let distance = texel.position.distance(DVec3::new(2.0, 0.5, 0.0));
        let facing = texel.normal == Vec3::Z;
        let expected = if facing { 1.0 + 0.5 * 0.8 * brush.falloff(distance / 0.25) } else { 1.0 };
        assert!((t - expected).abs() < 1e-5, "{t} for {expected} at {}", texel.position);
        painted[texel.chart as usize] += usize::from(t != 1.0);
    }
    assert!(painted[0] > 20 && painted[0] == painted[1] && painted[2] == 0, "{painted:?}");
    // The gutter follows its source, and is reported with it.
    let (source, gutter) = ([1 + 2 * DENSITY, 10], [2 + 2 * DENSITY, 10]);
    assert_ne!(map.at(source[0], source[1]), FocusOffset::STANDARD);
    assert_eq!(map.at(gutter[0], gutter[1]), map.at(source[0], source[1]));
    assert!(changed.texels.contains(&source) && changed.texels.contains(&gutter));
    let differing = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let differing: Vec<_> = differing.filter(|&[x, y]| map.at(x, y) != FocusOffset::STANDARD).collect();
    assert_eq!(changed.texels, differing);
    let rectangles = changed.rectangles();
    let held = |&[x, y]: &[u32; 2]| {
        let [columns, rows] = &rectangles[&[x / focus::TILE_SIDE, y / focus::TILE_SIDE]];
        columns.contains(&x) && rows.contains(&y)
    };
    assert!(changed.texels.iter().all(held));
}

#[test]
fn without_a_normal_limit_thin_walls_are_painted_through() {
    let canvas = strip();
    let through = |map: &FocusMap| {
        let back = canvas.texels().filter(|texel| texel.chart == 2);
        back.filter(|texel| map.at(texel.x, texel.y) != FocusOffset::STANDARD).count()
    };
    let mut map = blank();
    draw(&mut map, &canvas, &brush(BrushMode::Set), &[[1.0, 0.5], [3.0, 0.5]]);
    assert_eq!(through(&map), 0);
    let through_and_through = Brush { normal_limit_degrees: 180.0, ..brush(BrushMode::Set) };
    draw(&mut map, &canvas, &through_and_through, &[[1.0, 0.5], [3.0, 0.5]]);
    assert!(through(&map) > 100);
}

#[test]
fn how_events_are_bunched_does_not_matter() {
    let canvas = strip();
    let corners = [[0.5, 0.25], [1.5, 0.25], [1.5, 0.75], [3.5, 0.75]];
    // Halves and quarters of the pieces are exact in binary, so the dabs must be the same to the bit.
    let mut fine = vec![corners[0]];
    for pair in corners.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        for share in [0.25, 0.25, 0.5, 0.625, 1.0] {
            fine.push([a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]);
        }
    }
    for mode in [BrushMode::Set, BrushMode::Add, BrushMode::Smooth] {
        let brush = Brush { strength: 0.3, ..brush(mode) };
        let mut start = blank();
        draw(&mut start, &canvas, &self::brush(BrushMode::Set), &[[1.0, 0.5]]);
        let (mut coarse_map, mut fine_map, mut control) = (start.clone(), start.clone(), start);
        draw(&mut coarse_map, &canvas, &brush, &corners);
        draw(&mut fine_map, &canvas, &brush, &fine);
        assert!(coarse_map == fine_map, "{mode:?}");
        draw(&mut control, &canvas, &brush, &[corners[0], corners[3]]);
        assert!(coarse_map != control, "{mode:?}: a shortcut must differ");
    }
}

#[test]
fn a_stroke_washes_and_adding_builds_up() {
    let canvas = strip();
    let scrub: Vec<_> = (0..40).map(|i| [if i % 2 == 0 { 1.0 } else { 1.6 }, 0.5]).collect();
    let peak = |map: &FocusMap| map.to_rows().iter().map(|texel| texel[0]).fold(0.0, f32::max);

    let mut map = blank();
    let wash = Brush { strength: 0.4, ..brush(BrushMode::Set) };
    draw(&mut map, &canvas, &wash, &scrub);
    assert!((peak(&map) - 1.2).abs() < 1e-6, "{}", peak(&map));
    // A second stroke goes on from there.
    draw(&mut map, &canvas, &wash, &scrub);
    assert!((peak(&map) - 1.32).abs() < 1e-6, "{}", peak(&map));

    let mut map = blank();
    draw(&mut map, &canvas, &Brush { strength: 0.4, ..brush(BrushMode::Add) }, &scrub);
    assert_eq!(peak(&map), 2.0, "up to the limit");
    draw(&mut map, &canvas, &Brush { offset_limits: [0.0, 1.0], ..brush(BrushMode::Add) }, &scrub);
    assert_eq!(peak(&map), 2.0, "what lies beyond the limit stays");
    draw(&mut map, &canvas, &Brush { channels: Channels::T, ..brush(BrushMode::Subtract) }, &scrub);
    let rows = map.to_rows();
    assert_eq!(rows.iter().map(|texel| texel[0]).fold(9.0, f32::min), 0.0);
    assert_eq!(rows.iter().map(|texel| texel[1]).fold(0.0, f32::max), 1.0, "the anchor was not touched");
}

#[test]
fn reset_gives_exactly_the_standard() {
    let canvas = strip();
    let mut map = blank();
    let odd = Brush { target: FocusOffset::new(0.123, 0.789), ..brush(BrushMode::Set) };
    draw(&mut map, &canvas, &odd, &[[0.5, 0.5], [3.5, 0.5]]);
    let wide = Brush { radius: 1.0, hardness: 1.0, ..brush(BrushMode::Reset) };
    draw(&mut map, &canvas, &wide, &[[0.0, 0.5], [4.0, 0.5]]);
    assert!(map == blank());
}

#[test]
fn smoothing_keeps_constants_and_evens_out_a_step_across_the_cut() {
    let canvas = strip();
    let smooth = Brush { radius: 0.4, hardness: 1.0, ..brush(BrushMode::Smooth) };
    let odd = FocusMap::new(SIZE[0], SIZE[1], FocusOffset::new(0.1, 0.3));
    let mut map = odd.clone();
    assert!(draw(&mut map, &canvas, &smooth, &[[1.0, 0.5], [3.0, 0.4]]).is_none());
    assert!(map == odd);

    // A step exactly on the cut: afterwards it runs the same way on both sides.
    let mut map = blank();
    let two = FocusOffset::new(2.0, 0.0);
    fill(&mut map, &canvas, FillTarget::Chart(1), two, Channels::All).unwrap();
    draw(&mut map, &canvas, &smooth, &[[2.0, 0.5]]);
    let t_at = |x: f64| {
        let place = DVec3::new(x, 0.5 + 0.5 / DENSITY as f64, 0.0);
        let texel = canvas.texels().find(|texel| texel.position.distance(place) < 1e-6).unwrap();
        map.at(texel.x, texel.y).t
    };
    let step = 0.5 / DENSITY as f64;
    let (left, right) = (t_at(2.0 - step), t_at(2.0 + step));
    assert!(left > 1.2 && right < 1.8 && right - left < 0.4, "{left} {right}");
    assert!((left + right - 3.0).abs() < 1e-3, "the two sides mirror each other: {left} {right}");
}

#[test]
fn a_dab_smaller_than_a_texel_takes_the_texel_under_it() {
    let canvas = strip();
    let mut map = blank();
    let tiny = Brush { radius: 1e-4, ..brush(BrushMode::Set) };
    draw(&mut map, &canvas, &tiny, &[[1.0, 0.5]]).unwrap();
    let painted = canvas.texels().filter(|t| map.at(t.x, t.y) != FocusOffset::STANDARD).count();
    assert_eq!(painted, 1);
    assert!(
        draw(&mut map, &canvas, &tiny, &[[1.0, 1.5]]).is_none(),
        "off the surface there is nothing to paint"
    );
}

#[test]
fn strokes_that_are_empty_aborted_or_impossible_leave_no_trace() {
    let canvas = strip();
    let mut map = blank();
    assert!(draw(&mut map, &canvas, &brush(BrushMode::Set), &[]).is_none());
    assert!(draw(&mut map, &canvas, &brush(BrushMode::Reset), &[[1.0, 0.5]]).is_none());
    let mut stroke = Stroke::begin(&map, canvas.clone(), brush(BrushMode::Set)).unwrap();
    let changed = stroke.extend(&mut map, hit(1.0, 0.5), PenSample::default());
    assert!(map != blank());
    assert_eq!(stroke.abort(&mut map), changed);
    assert!(map == blank());
    let bad = Brush { radius: f64::NAN, ..Brush::default() };
    assert!(Stroke::begin(&map, canvas.clone(), bad).is_err());
    assert!(Stroke::begin(&FocusMap::new(3, 3, FocusOffset::SHARP), canvas, Brush::default()).is_err());
}

#[test]
fn pressure_and_lifting() {
    let canvas = strip();
    let mut map = blank();
    let mut stroke = Stroke::begin(&map, canvas.clone(), brush(BrushMode::Set)).unwrap();
    stroke.extend(&mut map, hit(0.5, 0.5), PenSample { pressure: 0.5 });
    stroke.lift();
    stroke.extend(&mut map, hit(3.5, 0.5), PenSample { pressure: 1.0 });
    let peak = |range: std::ops::Range<f64>| {
        let inside = canvas.texels().filter(|texel| range.contains(&texel.position.x));
        inside.map(|texel| map.at(texel.x, texel.y).t).fold(0.0, f64::max)
    };
    assert_eq!([peak(0.0..1.0), peak(1.0..3.0), peak(3.0..4.0)], [1.25, 1.0, 1.5]);
}

#[test]
fn fills_reach_what_they_name() {
    let canvas = strip();
    let count = |target| {
        let mut map = blank();
        fill(&mut map, &canvas, target, FocusOffset::SHARP, Channels::All).unwrap();
        let painted = canvas.texels().filter(|t| map.at(t.x, t.y) == FocusOffset::SHARP);
        (painted.count() as u32 / (DENSITY * DENSITY), map.background == FocusOffset::SHARP)
    };
    assert_eq!(count(FillTarget::Chart(1)), (2, false));
    assert_eq!(count(FillTarget::Part(0)), (4, false));
    assert_eq!(count(FillTarget::Node(1)), (4, false));
    assert_eq!(count(FillTarget::Material(0)), (8, false));
    assert_eq!(count(FillTarget::Everything), (8, false));
    assert_eq!(count(FillTarget::Background), (0, true));
}

#[test]
fn a_thousand_edits_undo_and_redo_to_the_bit() {
    let canvas = strip();
    let mut history = Vec::new();
    let mut map = blank();
    let mut states = vec![map.clone()];
    let mut seed = 7u32;
    let mut random = || {
        seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
        (seed >> 8) as f64 / (1 << 24) as f64
    };
    while states.len() <= 1000 {
        let modes =
            [BrushMode::Set, BrushMode::Add, BrushMode::Subtract, BrushMode::Smooth, BrushMode::Reset];
        let target = FocusOffset::new(2.0 * random(), random());
        let brush = Brush {
            radius: 0.05 + 0.2 * random(),
            strength: random(),
            mode: modes[(random() * 5.0) as usize],
            target,
            ..Brush::default()
        };
        let edit = match (random() * 20.0) as u32 {
            0 => {
                let before = map.clone();
                let target = [FillTarget::Chart(0), FillTarget::Node(1), FillTarget::Background];
                fill(&mut map, &canvas, target[(random() * 3.0) as usize], brush.target, Channels::All)
                    .unwrap();
                Edit::from_difference("Fill", &before, &map)
            }
            _ => {
                let path = [[4.0 * random(), random()], [4.0 * random(), random()]];
                draw(&mut map, &canvas, &brush, &path)
            }
        };
        if let Some(edit) = edit {
            history.push(edit);
            states.push(map.clone());
        }
    }
    for (edit, expected) in history.iter().rev().zip(states.iter().rev().skip(1)) {
        edit.revert(&mut map);
        assert!(map == *expected);
    }
    for (edit, expected) in history.iter().zip(&states[1..]) {
        edit.apply(&mut map);
        assert!(map == *expected);
    }
}

#[test]
fn a_mirrored_stroke_paints_both_sides_alike_across_charts() {
    let canvas = strip();
    let mirrored =
        Brush { mirror: [true, false, false], mirror_center: [2.0, 0.0, 0.0], ..brush(BrushMode::Set) };
    let mut map = blank();
    draw(&mut map, &canvas, &mirrored, &[[0.6, 0.5], [1.1, 0.4]]).unwrap();
    let mut both = blank();
    draw(&mut both, &canvas, &brush(BrushMode::Set), &[[0.6, 0.5], [1.1, 0.4]]).unwrap();
    draw(&mut both, &canvas, &brush(BrushMode::Set), &[[3.4, 0.5], [2.9, 0.4]]).unwrap();
    let mut painted = 0;
    for texel in canvas.texels() {
        let [a, b] = [&map, &both].map(|map| map.texel(texel.x, texel.y));
        assert!(
            (a[0] - b[0]).abs() < 1e-5 && (a[1] - b[1]).abs() < 1e-5,
            "{a:?} {b:?} at {}",
            texel.position
        );
        painted += usize::from(a[0] != 1.0 && texel.chart == 1);
    }
    assert!(painted > 50, "the other chart is painted: {painted}");
    // Back of the strip: mirrored in depth as well, where the surface faces the other way.
    let deep =
        Brush { mirror: [true, false, true], mirror_center: [2.0, 0.0, -0.025], ..brush(BrushMode::Set) };
    let mut map = blank();
    draw(&mut map, &canvas, &deep, &[[0.6, 0.5]]).unwrap();
    let at = |x: f64, chart: u32| {
        let nearest = canvas.texels().filter(|t| t.chart == chart).min_by(|a, b| {
            let distance = |t: &CanvasTexel| (t.position.x - x).abs() + (t.position.y - 0.5).abs();
            distance(a).total_cmp(&distance(b))
        });
        let texel = nearest.unwrap();
        map.texel(texel.x, texel.y)[0]
    };
    for (x, chart) in [(0.6, 0), (3.4, 1), (0.6, 2), (3.4, 2)] {
        assert!(at(x, chart) > 1.4, "{x} on chart {chart}: {}", at(x, chart));
    }
}
