//! A spread layer as a step of undo, in a recording and in a project; contiguous selection.

use crate::scene::{TestScene, json, label_values};
use crate::strokes;
use document::{Document, UndoState, replay};
use focus::{CombineMode, Likeness, SpreadSettings};
use glam::DVec2;
use light::Resources;
use progress::Unwatched;
use project::SelectionShape;

/// The demo in a small atlas, with three strokes on a layer.
fn small_demo() -> TestScene {
    let strokes = &strokes()["demo"];
    let mut scene = TestScene::demo(256, strokes);
    scene.paint(strokes, &label_values());
    scene
}

fn undo(document: &mut Document) {
    let Document { undo, layers, camera, focus_hold, lens_motion, selection, depth_strokes, .. } = document;
    undo.undo(UndoState { layers, camera, focus_hold, lens_motion, selection, depth_strokes }).unwrap();
}

#[test]
fn spreading_is_undone_replayed_and_saved_to_the_same_bits() {
    let mut scene = small_demo();
    let document = &mut scene.document;
    let layer = document.layers.active_index();
    let painted = document.layers.clone();
    let settings = SpreadSettings { reach: 300.0, softness: 0.2, contrast: 0.1 };
    assert!(document.spread(layer, settings).unwrap().is_some());
    let spread = document.layers.clone();
    assert_ne!(spread, painted);
    let strokes = &spread.active().spread.as_ref().unwrap().strokes;
    assert!(*strokes == painted.active().map, "the layer keeps its strokes");

    // Painting on it is refused, with what to do.
    let steps: Vec<_> = document.undo.records().cloned().collect();
    let everything = document.fill_targets(document::FillRegion::All);
    let refusal = document.fill(everything, label_values()[0]).unwrap_err().to_string();
    assert!(refusal.contains("show its strokes"), "{refusal}");

    // Another setting is the same step of undo while the slider moves, and a step of its own afterwards.
    let count = document.undo_names().count();
    document.spread(layer, SpreadSettings { reach: 20.0, ..settings }).unwrap();
    assert_eq!(document.undo_names().count(), count);
    document.undo.finish_run();
    document.spread(layer, settings).unwrap();
    assert_eq!(document.undo_names().count(), count + 1);
    assert!(document.layers == spread, "a slider that comes back restores every bit");
    undo(document);
    undo(document);
    assert!(document.layers == painted);

    // A recording does the same on a new document.
    let mut again = TestScene::demo(256, &crate::strokes()["demo"]).document;
    assert_eq!(replay(&mut again, &steps).unwrap(), steps.len());
    assert!(again.layers == spread);

    // And a project keeps it, strokes and all.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("spread.fbrush");
    again.to_project().save(&file).unwrap();
    let unwrap = crate::scene::unwrap_to(256);
    let mut opened = Document::open_saved(&file, &unwrap, &Resources::default(), &Unwatched).unwrap();
    assert!(opened.layers == spread);
    assert!(opened.show_strokes(layer).unwrap());
    assert!(opened.layers.active().map == painted.active().map && opened.layers.active().spread.is_none());
    assert!(opened.show_strokes(layer).is_err(), "it is not spread");
}

#[test]
fn a_layer_without_paint_cannot_be_spread() {
    let mut document = TestScene::demo(256, &json(r#"{"size": [64, 36]}"#)).document;
    let error = document.spread(0, SpreadSettings::default()).unwrap_err().to_string();
    assert!(error.contains("nothing is painted") && error.contains("paint a stroke"), "{error}");
    let far = SpreadSettings { reach: f64::NAN, ..SpreadSettings::default() };
    assert!(document.spread(0, far).unwrap_err().to_string().contains("reach must be"));
    assert!(document.spread(7, SpreadSettings::default()).unwrap_err().to_string().contains("no such layer"));
}

#[test]
fn what_touches_and_is_alike_is_selected_with_growing_tolerance() {
    let mut scene = small_demo();
    let hit = scene.hit_at(DVec2::new(0.3, 0.595)).unwrap();
    let document = &mut scene.document;
    let mut count_at = |likeness, tolerance| {
        let shape = SelectionShape::Similar { position: hit.position, likeness, tolerance };
        document.select(shape, CombineMode::Replace).unwrap();
        document.selection.as_ref().map(|selection| selection.count())
    };
    let counts: Vec<_> =
        [0.0, 0.1, 0.3].map(|tolerance| count_at(Likeness::Color, tolerance).unwrap()).into();
    assert!(counts[0] > 0 && counts[0] < counts[1] && counts[1] < counts[2], "{counts:?}");
    // All of the fox that touches, and nothing else.
    let fox = count_at(Likeness::Part, 0.5).unwrap();
    let part = document.stage.scene.triangles[hit.point.triangle as usize].part;
    let texels = document.stage.canvas.texels().enumerate();
    let selection = document.selection.clone().unwrap();
    assert!(texels.filter(|(index, _)| selection.contains(*index)).all(|(_, texel)| texel.part == part));
    assert!(fox > 100, "{fox}");

    // An outline that was drawn badly goes to the edge: of the part, less the texels near its border.
    let shape = SelectionShape::Refined { width: 3 };
    document.select(shape, CombineMode::Replace).unwrap();
    let refined = document.selection.as_ref().unwrap().count();
    assert!((refined as f64 - fox as f64).abs() < 0.1 * fox as f64, "{fox}: {refined}");
}
