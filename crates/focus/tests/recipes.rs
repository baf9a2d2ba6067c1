//! Recipes on a small scene: which entry wins, what cannot be, and how they become a map.

use atlas::Atlas;
use focus::{
    Canvas, Channels, FillTarget, Focus, FocusError, FocusImage, FocusMap, FocusRecipe, FocusSource,
    RecipeEntry,
};
use glam::{DVec2, DVec3, Vec2};
use lens::FocusOffset;
use scene::{Material, Node, Part, Scene, SurfaceField, SurfacePoint, Triangle};
use std::sync::Arc;

fn material(name: &str) -> Material {
    Material { name: name.to_string(), ..Material::unlit_white() }
}

fn node(name: &str) -> Node {
    Node { name: name.into(), index: 0, world: glam::DMat4::IDENTITY }
}

/// One triangle a part: (left, wall), (left, roof), (right, wall), (right, roof); the last without UVs.
fn scene() -> Arc<Scene> {
    let part = |i: u32| Part {
        node: i / 2,
        material: i % 2,
        triangles: i..i + 1,
        has_uv: [i < 3, false],
        mirrored: false,
    };
    Arc::new(Scene {
        positions: [DVec3::ZERO, DVec3::X, DVec3::Y].repeat(4),
        uv: [[Vec2::ZERO, Vec2::X, Vec2::Y].repeat(4), Vec::new()],
        triangles: (0..4).map(|i| Triangle { vertices: [3 * i, 3 * i + 1, 3 * i + 2], part: i }).collect(),
        parts: (0..4).map(part).collect(),
        nodes: vec![node("left"), node("right")],
        materials: vec![material("wall"), material("roof")],
        ..Scene::default()
    })
}

fn value(t: f64) -> RecipeEntry {
    RecipeEntry::Value(FocusOffset::new(t, 0.5))
}

fn offsets(recipe: &FocusRecipe) -> Result<Vec<f64>, FocusError> {
    let focus = recipe.evaluate(&scene())?;
    let at = |triangle| focus.at(SurfacePoint { triangle, barycentric: DVec2::new(0.375, 0.125) }).t;
    Ok((0..4).map(at).chain([focus.at_infinity().t]).collect())
}

#[test]
fn nodes_win_over_materials_and_later_over_earlier() {
    let mut recipe = FocusRecipe { default: value(2.0), ..FocusRecipe::default() };
    assert_eq!(offsets(&recipe).unwrap(), [2.0, 2.0, 2.0, 2.0, 2.0]);
    recipe.background = Some(value(3.0));
    recipe.materials = vec![("wall".into(), value(4.0)), ("wall".into(), value(5.0))];
    assert_eq!(offsets(&recipe).unwrap(), [5.0, 2.0, 5.0, 2.0, 3.0]);
    recipe.nodes = vec![("right".into(), value(6.0))];
    assert_eq!(offsets(&recipe).unwrap(), [5.0, 2.0, 6.0, 6.0, 3.0]);
    assert_eq!(offsets(&FocusRecipe::default()).unwrap(), [1.0; 5]);
}

#[test]
fn a_map_lies_in_the_first_uv_set() {
    let image = FocusImage {
        width: 2,
        height: 2,
        texels: vec![[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]],
        gloss: None,
    };
    let map = RecipeEntry::Map(Arc::new(image));
    let recipe = FocusRecipe { materials: vec![("wall".into(), map.clone())], ..FocusRecipe::default() };
    // uv (0.375, 0.125): a quarter past the centre of column 0, a quarter before that of row 0, where it
    // repeats: row 1 a quarter. 1 + 0.25 + 0.25·2.
    assert_eq!(offsets(&recipe).unwrap(), [1.75, 1.0, 1.75, 1.0, 1.0]);

    let on_bare = FocusRecipe { nodes: vec![("right".into(), map.clone())], ..FocusRecipe::default() };
    let error = offsets(&on_bare).unwrap_err().to_string();
    assert!(error.contains("nodes \"right\"") && error.contains("\"roof\"") && error.contains("TEXCOORD_0"));
    let behind = FocusRecipe { background: Some(map), ..FocusRecipe::default() };
    assert_eq!(offsets(&behind).unwrap_err(), FocusError::BackgroundMap);
}

#[test]
fn unknown_names_are_reported_with_similar_ones() {
    let recipe =
        |name: &str| FocusRecipe { materials: vec![(name.into(), value(2.0))], ..FocusRecipe::default() };
    let message = |name: &str| offsets(&recipe(name)).unwrap_err().to_string();
    assert_eq!(message("Wal"), "no material is called \"Wal\" (did you mean \"wall\"?)");
    assert_eq!(message("xylophone"), "no material is called \"xylophone\" (there are \"roof\", \"wall\")");
    let node = FocusRecipe { nodes: vec![("wall".into(), value(2.0))], ..FocusRecipe::default() };
    assert!(offsets(&node).unwrap_err().to_string().starts_with("no node is called \"wall\""));
}

#[test]
fn invalid_numbers_are_reported_with_their_entry() {
    let bad = RecipeEntry::Value(FocusOffset::new(f64::NAN, 0.0));
    let recipe = FocusRecipe { nodes: vec![("left".into(), bad.clone())], ..FocusRecipe::default() };
    assert!(offsets(&recipe).unwrap_err().to_string().starts_with("nodes \"left\""));
    let recipe = FocusRecipe { background: Some(bad), ..FocusRecipe::default() };
    assert!(offsets(&recipe).unwrap_err().to_string().starts_with("background"));
}

#[test]
fn a_baked_recipe_gives_the_recipes_values() {
    let scene = scene();
    // A 20-texel triangle for each part, side by side.
    let place =
        |i: u32| [[0.0, 0.0], [20.0, 0.0], [0.0, 20.0]].map(|[x, y]| Vec2::new(x + 30.0 * i as f32, y) + 4.0);
    let atlas =
        Arc::new(Atlas::new([128, 32], (0..4).map(place).collect(), (0..4).collect(), &[0, 1, 2, 3], 20.0));
    let mut recipe =
        FocusRecipe { default: value(0.1), background: Some(value(0.3)), ..FocusRecipe::default() };
    recipe.nodes = vec![("left".into(), RecipeEntry::Value(FocusOffset::STANDARD))];
    // t = 1 + u, away from where it repeats.
    let ramp = (0..64).map(|i| [1.0 + (i as f32 + 0.5) / 64.0, 0.25]).collect();
    let ramp = FocusImage { width: 64, height: 1, texels: ramp, gloss: None };
    recipe.materials = vec![("wall".into(), RecipeEntry::Map(Arc::new(ramp)))];

    let focus = recipe.evaluate(&scene).unwrap();
    let texels = atlas.texel_map(&scene);
    let baked = Arc::new(focus.bake(&texels));
    assert_eq!(baked.background, FocusOffset::new(0.3, 0.5));
    let painted = Focus::from_atlas_map(scene.clone(), atlas.clone(), baked.clone());
    for triangle in 0..4 {
        for i in 0..200 {
            let b =
                DVec2::new(0.02 + 0.9 * (i as f64 * 0.618).fract(), 0.02 + 0.9 * (i as f64 * 0.755).fract());
            let point = SurfacePoint {
                triangle,
                barycentric: if b.element_sum() > 1.0 { DVec2::ONE - b } else { b },
            };
            let (exact, found) = (focus.at(point), painted.at(point));
            // Exact where the texels agree (to f32), else within the texel that borders are extended by.
            let tolerance = if triangle == 2 { 1.5 / 20.0 } else { 1e-7 };
            assert!((exact.t - found.t).abs() < tolerance && (exact.anchor - found.anchor).abs() < 1e-7);
            assert!(triangle > 1 || found == FocusOffset::STANDARD);
        }
    }
    // Painted values reach the bilinear lookup at the very border through the gutters.
    let gutters: Vec<_> =
        texels.dilations.iter().map(|d| [d.texel, d.source].map(|i| [i % 128, i / 128])).collect();
    let canvas = Canvas::new(&scene, &atlas, &texels.texels, &gutters);
    let mut map = FocusMap::clone(&baked);
    focus::fill(&mut map, &canvas, FillTarget::Part(3), FocusOffset::SHARP, Channels::All).unwrap();
    let painted = Focus::from_atlas_map(scene, atlas, Arc::new(map));
    for barycentric in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::new(0.5, 0.5)] {
        assert_eq!(painted.at(SurfacePoint { triangle: 3, barycentric }), FocusOffset::SHARP);
        assert_eq!(painted.at(SurfacePoint { triangle: 1, barycentric }), FocusOffset::STANDARD);
    }
}

#[test]
fn every_triangle_may_have_a_value_of_its_own() {
    let scene = scene();
    let of_triangles = |gloss: f64| {
        let values =
            (0..4).map(|k| FocusOffset::new(1.0 + f64::from(k), 0.25).with_gloss(gloss * f64::from(k)));
        let source = FocusSource::Triangles(values.collect());
        Focus { parts: vec![source; 4], ..Focus::constant(scene.clone(), FocusOffset::SHARP) }
    };
    let focus = of_triangles(0.0);
    for triangle in 0..4 {
        let value = FocusOffset::new(1.0 + f64::from(triangle), 0.25);
        for barycentric in [DVec2::ZERO, DVec2::new(0.375, 0.125)] {
            assert_eq!(focus.at(SurfacePoint { triangle, barycentric }), value);
        }
        assert_eq!(focus.bounds(triangle), Some([value; 2]));
    }
    assert_eq!(focus.at_infinity(), FocusOffset::SHARP);
    assert!(!focus.affects_carried_light() && of_triangles(0.1).affects_carried_light());
}
