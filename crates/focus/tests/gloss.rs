//! Gloss that obeys the paint: the third number that is painted, there only where something uses it.

mod strip;

use focus::{
    BlendMode, Brush, BrushMode, Channels, FillTarget, Focus, FocusLayer, FocusMap, FocusRecipe, Gradient,
    GradientLine, GradientShape, LayerStack, PenSample, RecipeEntry, Stroke, Symmetry, draw_gradient, fill,
};
use glam::DVec3;
use lens::FocusOffset;
use scene::SurfaceField;
use std::sync::Arc;
use strip::{SIZE, blank, brush, hit, strip};

const GLOSSY: FocusOffset = FocusOffset::new(1.5, 0.75).with_gloss(1.0);

/// A stroke along the middle of the strip's left half.
fn painted(map: &mut FocusMap, brush: Brush) -> focus::Edit {
    let mut stroke = Stroke::begin(map, strip(), brush).unwrap();
    for x in [0.5, 1.0, 1.5] {
        stroke.extend(map, hit(x, 0.5), PenSample::default());
    }
    stroke.commit(map).expect("something was painted")
}

/// Where the stroke has its full strength.
fn middle(map: &FocusMap) -> FocusOffset {
    map.at(2 + 16, 2 + 8)
}

#[test]
fn a_brush_takes_the_gloss_along_and_leaves_none_behind_when_undone() {
    let mut map = blank();
    let plain = painted(&mut map, brush(BrushMode::Set));
    assert!(!map.has_gloss() && map.gloss_rows().is_none(), "a brush that says nothing of it");
    let without = map.clone();
    let edit = painted(&mut map, Brush { target: GLOSSY, ..brush(BrushMode::Set) });
    assert_eq!(middle(&map), GLOSSY);
    assert!(map.has_gloss() && map != without);
    assert!(edit.bytes() > plain.bytes(), "its tiles count");
    let fading = strip().texels().filter(|t| (0.01..0.99).contains(&map.gloss_at(t.x, t.y))).count();
    assert!(fading > 20, "it fades toward the rim: {fading} texels");
    let painted = map.clone();
    let changed = edit.revert(&mut map);
    assert!(map == without && !map.has_gloss(), "nothing of it is kept");
    assert!(!changed.is_empty(), "t and anchor were the same already");
    edit.apply(&mut map);
    assert_eq!(map, painted);
}

#[test]
fn modes_and_channels_touch_it_as_they_touch_the_anchor() {
    let set = |channels| Brush { channels, target: GLOSSY, ..brush(BrushMode::Set) };
    let mut map = blank();
    painted(&mut map, set(Channels::T));
    assert!(!map.has_gloss());
    painted(&mut map, set(Channels::Gloss));
    assert_eq!(middle(&map), FocusOffset::new(1.5, 0.0).with_gloss(1.0));

    // Added up to 1, taken away down to 0; a target without it changes nothing.
    let step = |mode, gloss: f64| {
        let target = FocusOffset::new(1.01, 0.0).with_gloss(gloss);
        Brush { target, flow: 0.1, ..brush(mode) }
    };
    let mut map = blank();
    painted(&mut map, step(BrushMode::Add, 0.5));
    let added = middle(&map).gloss;
    assert!(added > 0.15 && added < 1.0, "{added}");
    painted(&mut map, step(BrushMode::Add, 0.0));
    assert_eq!(middle(&map).gloss, added);
    (0..3).for_each(|_| drop(painted(&mut map, step(BrushMode::Add, 1.0))));
    assert_eq!(middle(&map).gloss, 1.0);
    (0..6).for_each(|_| drop(painted(&mut map, step(BrushMode::Subtract, 1.0))));
    assert_eq!(middle(&map).gloss, 0.0);
}

#[test]
fn resets_fills_and_gradients_carry_it() {
    let canvas = strip();
    let mut map = blank();
    for target in [FillTarget::Everything, FillTarget::Background] {
        fill(&mut map, &canvas, target, GLOSSY, Channels::All).unwrap();
    }
    assert_eq!((middle(&map), map.background), (GLOSSY, GLOSSY));
    assert_eq!(map.gloss_at(1, 2 + 8), 1.0, "gutters, too");
    painted(&mut map, brush(BrushMode::Reset));
    assert_eq!(middle(&map), FocusOffset::STANDARD);
    assert!(fill(&mut map, &canvas, FillTarget::Everything, GLOSSY.with_gloss(1.1), Channels::All).is_err());

    let line = GradientLine::World([DVec3::ZERO, DVec3::X * 4.0]);
    let to = Some(FocusOffset::STANDARD);
    let gradient =
        Gradient { shape: GradientShape::Linear, line, from: GLOSSY, to, symmetry: Symmetry::default() };
    let mut map = blank();
    draw_gradient(&mut map, &canvas, &gradient, Channels::All, None).unwrap();
    for texel in canvas.texels() {
        let expected = 1.0 - (texel.position.x / 4.0).clamp(0.0, 1.0);
        assert!((map.gloss_at(texel.x, texel.y) as f64 - expected).abs() < 1e-6);
    }
}

#[test]
fn between_texels_it_is_interpolated_and_bounded() {
    let mut map = FocusMap::new(80, 4, FocusOffset::STANDARD);
    map.set_gloss(70, 1, 1.0);
    assert_eq!(map.sample(glam::DVec2::new(70.25, 1.5)).gloss, 0.75);
    assert_eq!(map.sample(glam::DVec2::new(20.0, 1.5)).gloss, 0.0);
    let boxed = |x: f64| map.bounds([glam::DVec2::new(x, 0.0), glam::DVec2::new(x + 1.0, 3.0)]);
    assert_eq!(boxed(69.0).map(|focus| focus.gloss), [0.0, 1.0]);
    assert_eq!(boxed(30.0).map(|focus| focus.gloss), [0.0, 0.0]);
    let mut rows = map.gloss_rows().unwrap();
    let mut again = FocusMap::new(80, 4, FocusOffset::STANDARD);
    assert!(again.set_gloss_rows(&rows) && again == map);
    rows[5] = 1.5;
    assert!(again.set_gloss_rows(&rows) && !again.is_valid());
    assert!(!again.set_gloss_rows(&rows[1..]));
}

#[test]
fn layers_join_it() {
    let filled = |gloss: f64| {
        let mut map = FocusMap::new(SIZE[0], SIZE[1], FocusOffset::new(1.1, 0.5).with_gloss(gloss));
        map.add_mask();
        map
    };
    let joined = |blend, opacity| {
        let mut layers = LayerStack::from_map(filled(0.4));
        let above = FocusLayer { blend, opacity, ..FocusLayer::from_map("above", filled(0.8)) };
        assert!(layers.insert(above));
        let map = layers.composite();
        assert!((map.gloss_at(3, 3) as f64 - map.background.gloss).abs() < 1e-6);
        map.background.gloss
    };
    let cases = [
        (BlendMode::Set, 1.0, 0.8),
        (BlendMode::Set, 0.5, 0.6),
        (BlendMode::Mix, 0.25, 0.5),
        (BlendMode::Add, 0.5, 0.8),
        (BlendMode::Add, 1.0, 1.0),
        (BlendMode::MultiplyDefocus, 1.0, 0.4),
    ];
    for (blend, opacity, expected) in cases {
        let found = joined(blend, opacity);
        assert!((found - expected).abs() < 1e-6, "{blend:?} {opacity}: {found}, not {expected}");
    }
    // A change of gloss alone is a change.
    let mut layers = LayerStack::from_map(blank());
    let mut map = layers.composite();
    let brush = Brush { target: GLOSSY, channels: Channels::Gloss, ..brush(BrushMode::Set) };
    painted(&mut layers.active_mut().map, brush);
    let changed = layers.recomposite_all(&mut map);
    assert!(changed.texels.contains(&[2 + 16, 2 + 8]) && map == layers.active().map);
    assert!(layers.insert(FocusLayer::from_map("clear", FocusMap::transparent(SIZE[0], SIZE[1]))));
    assert_eq!(layers.composite(), map, "a layer that counts nowhere");
}

#[test]
fn a_recipe_with_gloss_affects_carried_light() {
    let scene = Arc::new(scene::Scene::default());
    let concerns = |gloss: f64| {
        let recipe =
            FocusRecipe { default: RecipeEntry::Value(GLOSSY.with_gloss(gloss)), ..FocusRecipe::default() };
        recipe.evaluate(&scene).unwrap().affects_carried_light()
    };
    assert_eq!([0.0, 0.5].map(concerns), [false, true]);
    let error = FocusRecipe::constant(GLOSSY.with_gloss(2.0)).evaluate(&scene).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("gloss in [0, 1]"), "{error}");
    assert!(!Focus::constant(scene, FocusOffset::SHARP).affects_carried_light());
}

#[test]
fn brushes_without_gloss_are_written_as_before() {
    let text = serde_json::to_string(&Brush::default()).unwrap();
    assert!(!text.contains("gloss") && text.contains("\"channels\":\"both\""), "{text}");
    for brush in [
        Brush { target: GLOSSY, ..Brush::default() },
        Brush { channels: Channels::Gloss, ..Brush::default() },
    ] {
        let text = serde_json::to_string(&brush).unwrap();
        assert!(text.contains("gloss"), "{text}");
        assert_eq!(serde_json::from_str::<Brush>(&text).unwrap(), brush);
    }
    let wrong = Brush { target: GLOSSY.with_gloss(f64::NAN), ..Brush::default() };
    assert!(wrong.problem().unwrap().contains("gloss"));
}
