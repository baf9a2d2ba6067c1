//! What is painted where: gradients, selections, symmetric and cloned strokes.

mod strip;

use focus::{
    Brush, BrushMode, Canvas, Channels, FillTarget, FocusMap, Gradient, GradientLine, GradientShape,
    PenSample, Selection, SelectionResult, Stroke, SurfaceHit, Symmetry, ViewFrame, draw_gradient,
    fill_selected,
};
use glam::{DMat4, DVec2, DVec3, Vec3};
use lens::FocusOffset;
use strip::{DENSITY, SIZE, blank, brush, hit, strip};

/// Of the front, by x and y.
fn t_at(canvas: &Canvas, map: &FocusMap, x: f64, y: f64) -> f64 {
    let place = DVec3::new(x, y, 0.0);
    let front = canvas.texels().filter(|texel| texel.normal == Vec3::Z);
    let nearest = front
        .min_by(|a, b| a.position.distance(place).total_cmp(&b.position.distance(place)))
        .expect("the strip has a front");
    map.at(nearest.x, nearest.y).t
}

fn selection(canvas: &Canvas, chosen: impl Fn(DVec3) -> bool) -> Selection {
    match Selection::from_predicate(canvas, |texel| chosen(texel.position)) {
        SelectionResult::Some(selection) => selection,
        other => panic!("some of it: {other:?}"),
    }
}

const WORLD: Gradient = Gradient {
    shape: GradientShape::Linear,
    line: GradientLine::World([DVec3::new(1.0, 0.5, 0.0), DVec3::new(3.0, 0.5, 0.0)]),
    from: FocusOffset::new(1.4, 1.0),
    to: None,
    symmetry: Symmetry { mirror: [false; 3], radial: 1, center: [0.0; 3], axes: focus::WORLD_AXES },
};

#[test]
fn gradients_run_evenly_across_charts_in_world_and_on_screen() {
    let canvas = strip();
    let half_texel = 0.5 / DENSITY as f64;
    let drawn = |gradient: &Gradient| {
        let mut map = blank();
        let changed = draw_gradient(&mut map, &canvas, gradient, Channels::All, None).unwrap();
        assert!(!changed.is_empty());
        map
    };
    let linear = drawn(&WORLD);
    for k in 0..40 {
        let x = 0.05 + 0.1 * k as f64;
        let expected = 1.0 + 0.4 * (1.0 - ((x - 1.0) / 2.0).clamp(0.0, 1.0));
        let found = t_at(&canvas, &linear, x, 0.3);
        assert!((found - expected).abs() < 0.2 * 1.01 * half_texel * 2.0, "{x}: {found} for {expected}");
    }
    let radial = drawn(&Gradient { shape: GradientShape::Radial, ..WORLD });
    assert!((t_at(&canvas, &radial, 0.0, 0.5) - 1.2).abs() < 0.02, "the same on both sides of its start");
    assert!((t_at(&canvas, &radial, 2.0, 0.5) - 1.2).abs() < 0.02);
    let two = drawn(&Gradient { to: Some(FocusOffset::new(0.6, 0.5)), ..WORLD });
    assert!(
        (t_at(&canvas, &two, 2.0, 0.5) - 1.0).abs() < 0.02 && t_at(&canvas, &two, 3.9, 0.5) == 0.6f32 as f64
    );

    // Seen from 4 in front of its middle, half the view's height is 4 tan(yfov / 2).
    let pose = DMat4::from_translation(DVec3::new(2.0, 0.5, 4.0));
    let view = ViewFrame {
        camera_to_world: pose,
        yfov: 2.0 * 0.25f64.atan(),
        aspect: 2.0,
        shift: glam::DVec2::ZERO,
    };
    let ends = [1.0, 3.0].map(|x| view.position(DVec3::new(x, 0.5, 0.0)).unwrap());
    assert_eq!(ends, [DVec2::new(0.25, 0.5), DVec2::new(0.75, 0.5)]);
    let on_screen = drawn(&Gradient { line: GradientLine::View(view, ends), ..WORLD });
    for x in [0.5, 1.5, 2.0, 2.7, 3.5] {
        let [a, b] = [&linear, &on_screen].map(|map| t_at(&canvas, map, x, 0.7));
        assert!((a - b).abs() < 1e-5, "seen straight on, both are one: {a} {b}");
    }

    // Mirrored about the middle: from both ends inward.
    let symmetry = Symmetry { mirror: [true, false, false], center: [2.0, 0.0, 0.0], ..Symmetry::default() };
    let line = GradientLine::World([DVec3::new(0.0, 0.5, 0.0), DVec3::new(2.0, 0.5, 0.0)]);
    let both = drawn(&Gradient { line, symmetry, ..WORLD });
    for x in [0.3, 1.05, 1.7] {
        let [a, b] = [x, 4.0 - x].map(|x| t_at(&canvas, &both, x, 0.5));
        assert!((a - b).abs() < 1e-5 && a > 1.02, "{a} {b}");
    }
    let nowhere = GradientLine::World([DVec3::ONE; 2]);
    let bad = Gradient { line: nowhere, ..WORLD };
    assert!(draw_gradient(&mut blank(), &canvas, &bad, Channels::All, None).is_err());
}

#[test]
fn on_a_layer_a_gradient_fades_by_its_mask() {
    let canvas = strip();
    let mut map = FocusMap::transparent(SIZE[0], SIZE[1]);
    draw_gradient(&mut map, &canvas, &WORLD, Channels::All, None).unwrap();
    for texel in canvas.texels().filter(|texel| texel.normal == Vec3::Z) {
        let along = ((texel.position.x - 1.0) / 2.0).clamp(0.0, 1.0);
        let mask = map.mask_at(texel.x, texel.y);
        assert!((mask as f64 - (1.0 - along)).abs() < 1e-6);
        assert!(mask == 0.0 || (map.at(texel.x, texel.y).t - 1.4).abs() < 1e-6, "full paint, thinner");
    }
}

#[test]
fn what_is_not_selected_is_never_painted() {
    let canvas = strip();
    let left = selection(&canvas, |position| position.x < 1.0);
    let check = |map: &FocusMap, what: &str| {
        let mut painted = 0;
        for texel in canvas.texels() {
            let changed = map.at(texel.x, texel.y) != FocusOffset::STANDARD;
            assert!(texel.position.x < 1.0 || !changed, "{what} at {}", texel.position);
            painted += usize::from(changed);
        }
        assert!(painted > 20, "{what}: {painted}");
    };
    for mode in [BrushMode::Set, BrushMode::Add] {
        let mut map = blank();
        let stroke = Stroke::begin(&map, canvas.clone(), brush(mode)).unwrap();
        let mut stroke = stroke.with_selection(Some(left.clone()));
        for x in [0.2, 3.0] {
            stroke.extend(&mut map, hit(x, 0.5), PenSample::default());
        }
        check(&map, "stroke");
    }
    let mut map = blank();
    let sharp = (FocusOffset::SHARP, Channels::All);
    fill_selected(&mut map, &canvas, &[FillTarget::Everything], sharp, Some(&left)).unwrap();
    check(&map, "fill");
    let mut map = blank();
    draw_gradient(&mut map, &canvas, &WORLD, Channels::All, Some(&left)).unwrap();
    check(&map, "gradient");
    // A dab smaller than a texel, on a frozen one.
    let tiny = Brush { radius: 1e-4, ..brush(BrushMode::Set) };
    let mut map = blank();
    let mut stroke = Stroke::begin(&map, canvas.clone(), tiny).unwrap().with_selection(Some(left));
    assert!(stroke.extend(&mut map, hit(2.0, 0.5), PenSample::default()).is_empty());
    // One that has no neighbours to be sharpened against.
    let tiny = Brush { radius: 1e-4, ..brush(BrushMode::Sharpen) };
    let mut map = blank();
    let before = map.to_rows();
    let mut stroke = Stroke::begin(&map, canvas.clone(), tiny).unwrap();
    let _ = stroke.extend(&mut map, hit(2.0, 0.5), PenSample::default());
    assert_eq!(map.to_rows(), before);
}

#[test]
fn radial_symmetry_turns_strokes_about_the_vertical() {
    let canvas = strip();
    let turned = Brush {
        radial: 2,
        mirror_center: [2.0, 0.0, -0.025],
        normal_limit_degrees: 90.0,
        ..brush(BrushMode::Set)
    };
    let mut map = blank();
    let mut stroke = Stroke::begin(&map, canvas.clone(), turned).unwrap();
    stroke.extend(&mut map, hit(0.6, 0.5), PenSample::default());
    let back = canvas.texels().filter(|texel| texel.normal == -Vec3::Z);
    let painted: Vec<_> = back.filter(|t| map.at(t.x, t.y).t > 1.0).map(|texel| texel.position.x).collect();
    assert!(painted.len() > 20 && painted.iter().all(|x| (x - 3.4).abs() < 0.26), "half a turn: the back");
    assert!(t_at(&canvas, &map, 0.6, 0.5) > 1.4 && t_at(&canvas, &map, 3.4, 0.5) == 1.0);
    assert!(Brush { radial: 0, ..Brush::default() }.problem().is_some());
}

#[test]
fn a_drawn_falloff_is_followed_to_the_rim() {
    let canvas = strip();
    // A ring: nothing in the middle, all half way out, nothing at the rim.
    let ring = focus::Curve::new([[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]).unwrap();
    let drawn = Brush { drawn_falloff: Some(ring.clone()), radius: 0.4, ..brush(BrushMode::Set) };
    let mut map = blank();
    let mut stroke = Stroke::begin(&map, canvas.clone(), drawn.clone()).unwrap();
    stroke.extend(&mut map, hit(1.0, 0.5), PenSample::default());
    for texel in canvas.texels().filter(|texel| texel.normal == Vec3::Z) {
        let distance = texel.position.distance(DVec3::new(1.0, 0.5, 0.0)) / 0.4;
        let expected = if distance <= 1.0 { 1.0 + 0.5 * ring.evaluate(distance) } else { 1.0 };
        assert!((map.at(texel.x, texel.y).t - expected).abs() < 1e-5, "{distance}");
    }
    let beyond = focus::Curve::new([[0.0, 1.5]]);
    assert!(Brush { drawn_falloff: beyond, ..drawn.clone() }.problem().is_some());
    let text = serde_json::to_string(&drawn).unwrap();
    assert_eq!(serde_json::from_str::<Brush>(&text).unwrap(), drawn);
}

#[test]
fn cloning_takes_what_stood_there_when_the_stroke_began() {
    let canvas = strip();
    let mut map = blank();
    let source = brush(BrushMode::Set);
    let mut stroke = Stroke::begin(&map, canvas.clone(), source).unwrap();
    stroke.extend(&mut map, hit(0.8, 0.5), PenSample::default());
    let painted = map.clone();
    // From the left chart onto the turned one, across the cut.
    let clone = Brush {
        clone_offset: [-2.0, 0.0, 0.0],
        radius: 0.4,
        hardness: 1.0,
        spacing: 0.1,
        ..brush(BrushMode::Clone)
    };
    let mut stroke = Stroke::begin(&map, canvas.clone(), clone).unwrap();
    for x in [2.6, 2.8, 3.0] {
        let place = SurfaceHit { position: DVec3::new(x, 0.5, 0.0), normal: Some(Vec3::Z) };
        stroke.extend(&mut map, place, PenSample::default());
    }
    for x in [0.55, 0.7, 0.8, 0.95] {
        let [from, to] = [t_at(&canvas, &painted, x, 0.5), t_at(&canvas, &map, x + 2.0, 0.5)];
        assert!((from - to).abs() < 1e-6, "{x}: {from} {to}");
    }
    assert!(t_at(&canvas, &map, 2.8, 0.5) > 1.4);
    assert_eq!(t_at(&canvas, &map, 0.8, 0.5), t_at(&canvas, &painted, 0.8, 0.5));
}
