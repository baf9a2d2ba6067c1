//! Layers: painting, blending, hiding, curves, undo, saving.

use crate::acting::{Person, at, difference};
use crate::small_scene::opened;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use focus::{Adjustment, BlendMode};
use focus_brush::window::Tool;
use lens::FocusOffset;

impl Person {
    fn focus_at(&self, x: f64, y: f64) -> FocusOffset {
        let session = self.shell().session();
        let hit = session.pick(&session.picture_ray(glam::DVec2::new(x, y)).unwrap()).unwrap();
        session.focus_at(&hit).unwrap()
    }

    fn adds_a_layer_of_blur(&mut self) {
        self.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::N);
        for _ in 0..8 {
            self.presses(Modifiers::NONE, Key::Period);
        }
        let rect = self.picture_rect();
        let path: Vec<_> = (0..=10).map(|k| at(rect, 0.6 + 0.03 * k as f32, 0.5)).collect();
        self.paints(&path);
    }
}

#[test]
fn a_layer_is_painted_hidden_shown_weakened_and_taken_back() {
    let (mut person, _folder) = opened();
    let (blank, picture) = (person.document().map.clone(), person.picture());
    person.adds_a_layer_of_blur();
    assert_eq!(person.document().layers.layers().len(), 2);
    let target = person.document().brush.target;
    assert!((person.focus_at(0.75, 0.5).t - target.t).abs() < 1e-4);
    assert_eq!(person.document().layers.layers()[0].map, blank, "beneath, nothing was painted");
    let painted = (person.document().map.clone(), person.picture());

    person.scrolls_to("Show Layer 1");
    person.window.get_by_label("Show Layer 1").click();
    person.waits();
    assert_eq!(person.document().map, blank);
    assert_eq!(difference(&person.picture(), &picture), 0.0);
    // Hidden layers cannot be painted on.
    let middle = at(person.picture_rect(), 0.75, 0.5);
    person.clicks(middle);
    assert!(person.complaints().iter().any(|text| text.contains("hidden")), "{:?}", person.complaints());
    assert_eq!(person.document().map, blank);
    person.scrolls_to("Show Layer 1");
    person.window.get_by_label("Show Layer 1").click();
    person.waits();
    assert_eq!(person.document().map, painted.0);
    assert_eq!(difference(&person.picture(), &painted.1), 0.0);

    person.scrolls_to("Opacity");
    let slider = person.window.get_all_by_label("Opacity").find(|node| node.rect().width() > 90.0);
    let track = slider.expect("a slider").rect();
    person.clicks(at(track, 0.5, 0.5));
    let opacity = person.document().layers.active().opacity;
    assert!(opacity > 0.3 && opacity < 0.7, "{opacity}");
    let half = person.focus_at(0.75, 0.5);
    assert!(
        (half.t - (1.0 + opacity * (target.t - 1.0))).abs() < 1e-4 && (half.anchor - opacity).abs() < 1e-4
    );

    let steps = person.document().undo_names().count();
    for _ in 0..steps {
        person.presses(Modifiers::COMMAND, Key::Z);
    }
    person.waits();
    assert_eq!(person.document().layers.layers().len(), 1);
    assert_eq!(person.document().map, blank);
    assert_eq!(difference(&person.picture(), &picture), 0.0, "all taken back, to the bit");
    for _ in 0..steps {
        person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    }
    person.waits();
    assert_eq!(person.document().layers.active().opacity, opacity);
    assert_eq!(person.focus_at(0.75, 0.5), half);
}

#[test]
fn the_reset_brush_uncovers_what_lies_beneath_and_layers_are_saved() {
    let (mut person, folder) = opened();
    person.adds_a_layer_of_blur();
    person.presses(Modifiers::NONE, Key::E);
    let rect = person.picture_rect();
    person.clicks(at(rect, 0.75, 0.5));
    assert_eq!(person.focus_at(0.75, 0.5), FocusOffset::STANDARD);
    let layer = person.document().layers.active().clone();
    assert!(layer.map.has_mask());

    // An adjustment layer on top: a curve that blurs distant surfaces, multiplied onto the layers beneath.
    let wall = person.focus_at(0.95, 0.9);
    assert_eq!(wall, FocusOffset::STANDARD);
    person.scrolls_to("+ Depth curve");
    person.window.get_by_label("+ Depth curve").click();
    person.waits();
    assert_eq!(person.focus_at(0.95, 0.9).anchor, 1.0, "sharp at every depth to begin with");
    person.scrolls_to("Blur over depth");
    let drawing = person.window.get_by_label("Blur over depth").rect();
    let curve = |person: &Person| match person.document().layers.active().adjustment.clone() {
        Some(Adjustment::Curve(curve)) => curve.curve,
        other => panic!("a curve: {other:?}"),
    };
    let right = curve(&person).points().len();
    person.clicks(at(drawing, 0.91, 0.25));
    let curve = curve(&person);
    assert_eq!(curve.points().len(), right + 1, "a click draws another point");
    assert!(curve.points()[right][1] > 1.0, "far blur is on top");
    assert_eq!(person.document().undo_name(), Some("Depth curve"));
    person.scrolls_to("Blending");
    person.window.get_by_label("Blending").click();
    person.window.run_steps(3);
    person.window.get_by_label("Multiply blur").click();
    person.waits();
    assert_eq!(person.document().layers.active().blend, BlendMode::MultiplyDefocus);

    let project = folder.path().join("wall.fbrush");
    person.presses(Modifiers::COMMAND, Key::S);
    person.window.get_by_label("Save").click();
    person.waits();
    assert!(project.is_file(), "{:?}", person.complaints());
    let (layers, map, picture) =
        (person.document().layers.clone(), person.document().map.clone(), person.picture());
    drop(person);
    let mut person = Person::opens(&project);
    assert_eq!(person.document().layers, layers);
    assert_eq!(person.document().map, map);
    assert_eq!(difference(&person.picture(), &picture), 0.0);

    // The order matters, and two keys change it.
    person.presses(Modifiers::COMMAND, Key::OpenBracket);
    assert_eq!(person.document().layers.active_index(), 1);
    assert_eq!(person.document().layers.layers()[2].name, "Layer 1");
    person.presses(Modifiers::NONE, Key::PageUp);
    assert_eq!(person.document().layers.active().name, "Layer 1");
    person.presses(Modifiers::SHIFT, Key::Delete);
    person.waits();
    assert_eq!(person.document().layers.layers().len(), 2);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_focal_plane_runs_through_three_places_that_are_clicked() {
    let (mut person, _folder) = opened();
    let before = person.picture().radiance.clone();
    person.scrolls_to("+ Focal plane");
    person.window.get_by_label("+ Focal plane").click();
    person.waits();
    assert_eq!(person.shell().tool(), Tool::FocalPlane, "the next clicks place it");
    let plane = |person: &Person| match person.document().layers.active().adjustment.clone() {
        Some(Adjustment::Plane(plane)) => plane,
        other => panic!("a plane: {other:?}"),
    };
    // It starts as the plane of the ordinary lens.
    let camera = person.document().camera.clone();
    assert!((plane(&person).depth_on_axis(&camera) - camera.focus_distance).abs() < 1e-9);
    let rect = person.picture_rect();
    let places = [(0.25, 0.5), (0.9, 0.2), (0.9, 0.8)];
    for (x, y) in places {
        person.clicks(at(rect, x, y));
        person.waits();
    }
    assert_eq!(person.document().undo_name(), Some("Focal plane"));
    assert_eq!(person.document().undo_names().count(), 4, "every click is a step");
    for (x, y) in places {
        let focus = person.focus_at(x.into(), y.into());
        assert!((focus.t - 1.0).abs() < 1e-4 && focus.anchor == 1.0, "sharp where it was clicked: {focus:?}");
    }
    let beside = person.focus_at(0.6, 0.5);
    assert!((beside.t - 1.0).abs() > 1e-3, "the wall between lies behind it: {beside:?}");
    assert!(person.picture().radiance != before);
    // A point is dragged, and undone.
    let placed = plane(&person);
    let from = at(rect, 0.9, 0.8);
    person.drags(&[from, at(rect, 0.8, 0.75), at(rect, 0.7, 0.7)]);
    person.lets_go(at(rect, 0.7, 0.7));
    person.waits();
    let moved = plane(&person);
    assert_eq!(moved.points[..2], placed.points[..2]);
    assert!(moved.points[2].distance(placed.points[2]) > 0.1);
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(plane(&person), placed);

    // Tilted by dragging: the upper part comes nearer.
    person.scrolls_to("Tilt");
    let tilt = plane(&person).tilt_and_swing(&person.document().camera)[0];
    assert!(tilt.abs() < 1.5);
    person.scrolls_to("Place by three points");
    assert!(person.window.query_by_label("Curvature").is_some());
    // Clicking on another kind of layer is reported.
    person.presses(Modifiers::NONE, Key::PageDown);
    person.clicks(at(rect, 0.3, 0.3));
    assert!(
        person.complaints().iter().any(|text| text.contains("is not a focal plane")),
        "{:?}",
        person.complaints()
    );
}
