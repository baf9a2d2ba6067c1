//! Painting in both views: the map, the colours and the picture follow; undo and redo; Esc.

use crate::acting::{Person, at, color_at, difference};
use crate::small_scene::{opened, opened_with_bar};
use egui::{Key, Modifiers, Pos2};
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use lens::FocusOffset;

/// Selects strong far blur with keys.
fn chooses_blur(person: &mut Person) {
    for _ in 0..12 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    let target = person.document().brush.target;
    assert!(target.t > 1.0 && target.anchor == 1.0, "far blur, anchored at the point: {target:?}");
}

fn line(rect: egui::Rect, from: [f32; 2], to: [f32; 2]) -> Vec<Pos2> {
    let step = |k: usize| k as f32 / 12.0;
    (0..=12)
        .map(|k| at(rect, from[0] + (to[0] - from[0]) * step(k), from[1] + (to[1] - from[1]) * step(k)))
        .collect()
}

#[test]
fn a_stroke_in_the_paint_view_shows_while_it_goes_on_and_can_be_undone() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    let (map, picture) = (person.document().map.clone(), person.picture());
    let before = person.window.render().unwrap();

    let path = line(person.paint_rect(), [0.6, 0.3], [0.7, 0.7]);
    person.drags(&path);
    assert!(person.shell().session().is_painting());
    assert_ne!(person.document().map, map, "the map follows the stroke");
    person.wait_until("the picture follows the stroke", |shell| {
        let now = shell.session().preview().and_then(|preview| preview.picture.fetch());
        now.is_some_and(|now| difference(&now, &picture) > 0.05)
    });
    assert!(person.shell().session().is_painting(), "all that before the button is let go");
    person.lets_go(path[12]);
    person.waits();
    let (painted, painted_picture) = (person.document().map.clone(), person.picture());

    person.window.remove_cursor();
    person.window.run_steps(2);
    let after = person.window.render().unwrap();
    let (old, new) = (color_at(&before, path[6]), color_at(&after, path[6]));
    assert!(new[2] - new[0] > old[2] - old[0] + 40.0, "far blur is blue: {old:?} became {new:?}");
    let aside = at(person.paint_rect(), 0.95, 0.1);
    assert_eq!(color_at(&before, aside), color_at(&after, aside), "and only under the brush");
    // Resizing and back redraws everything; the result equals incremental recolouring.
    person.window.set_size(egui::vec2(1281.0, 720.0));
    person.window.run_steps(2);
    person.window.set_size(egui::vec2(1280.0, 720.0));
    person.window.run_steps(2);
    let anew = person.window.render().unwrap();
    let differing = after.pixels().zip(anew.pixels()).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "dab by dab is the same as all at once");

    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(person.document().map, map);
    assert_eq!(difference(&person.picture(), &picture), 0.0, "undo brings the very picture back");
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    person.waits();
    assert_eq!(person.document().map, painted);
    assert_eq!(difference(&person.picture(), &painted_picture), 0.0);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_stroke_in_the_picture_paints_what_is_seen_there() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    let picture = person.picture();
    let path = line(person.picture_rect(), [0.7, 0.3], [0.7, 0.6]);
    person.paints(&path);
    assert!(difference(&person.picture(), &picture) > 0.05);

    // The point under the pen got the brush's focus; the card, which was not touched, kept the lens's.
    let session = person.shell().session();
    let focus_at = |x: f64, y: f64| {
        let hit = session.pick(&session.picture_ray(glam::DVec2::new(x, y)).unwrap()).unwrap();
        session.focus_at(&hit).unwrap()
    };
    let target = person.document().brush.target;
    assert!((focus_at(0.7, 0.45).t - target.t).abs() < 1e-4);
    assert_eq!(focus_at(0.25, 0.5), FocusOffset::STANDARD);
}

#[test]
fn escape_takes_a_stroke_back_without_a_trace() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    let map = person.document().map.clone();
    let path = line(person.paint_rect(), [0.55, 0.4], [0.75, 0.4]);
    person.drags(&path);
    assert_ne!(person.document().map, map);
    person.presses(Modifiers::NONE, Key::Escape);
    assert_eq!(person.document().map, map);
    // The remainder of the drag paints nothing.
    person.window.hover_at(path[3]);
    person.window.run_steps(2);
    person.lets_go(path[3]);
    person.waits();
    assert_eq!(person.document().map, map);
    assert_eq!(person.document().undo_name(), None);
    assert!(!person.document().is_unsaved());
}

#[test]
fn navigating_paints_nothing() {
    let (mut person, _folder) = opened();
    let map = person.document().map.clone();
    let eye = person.shell().paint_view().camera().eye();
    let path = line(person.paint_rect(), [0.4, 0.5], [0.7, 0.6]);
    person.window.event(egui::Event::ModifiersChanged(Modifiers::ALT));
    person.window.hover_at(path[0]);
    person.window.step();
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::ALT,
    };
    person.window.event(button(path[0], true));
    person.window.step();
    for position in &path[1..] {
        person.window.hover_at(*position);
        person.window.step();
    }
    person.window.event(button(path[12], false));
    person.window.step();
    person.window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    person.waits();
    assert!(person.shell().paint_view().camera().eye().distance(eye) > 0.5, "Alt+drag turned the view");
    assert_eq!(person.document().map, map);
    person.presses(Modifiers::NONE, Key::Num0);
    assert!(
        person.shell().paint_view().camera().eye().distance(eye) < 1e-9,
        "0 looks through the lens again"
    );
}

#[test]
fn clicking_tools_fill_focus_and_pick() {
    let (mut person, _folder) = opened();
    person.presses(Modifiers::NONE, Key::G);
    let card = at(person.picture_rect(), 0.25, 0.5);
    person.clicks(card);
    assert_eq!(person.document().undo_name(), Some("Fill object"));

    person.presses(Modifiers::NONE, Key::H);
    person.clicks(card);
    assert!((person.document().camera.focus_distance - 2.0).abs() < 1e-6);

    chooses_blur(&mut person);
    person.presses(Modifiers::NONE, Key::I);
    person.clicks(card);
    assert_eq!(person.document().brush.target, FocusOffset::SHARP, "picked what the fill painted");
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn gloss_obeys_the_paint_where_that_is_ticked() {
    let (mut person, _folder) = opened();
    person.scrolls_to("Gloss");
    person.window.get_by_role_and_label(egui::Role::CheckBox, "Gloss").click();
    person.window.run_ok();
    assert_eq!(person.document().brush.target, FocusOffset::SHARP.with_gloss(1.0));
    person.presses(Modifiers::NONE, Key::G);
    let card = at(person.picture_rect(), 0.25, 0.5);
    person.clicks(card);
    assert_eq!(person.document().undo_name(), Some("Fill object"));
    assert!(person.document().map.has_gloss());
    person.presses(Modifiers::COMMAND, Key::Z);
    assert!(!person.document().map.has_gloss());

    // The palette offers it, too.
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    person.window.event(egui::Event::Text("gloss".into()));
    person.window.run_steps(2);
    person.presses(Modifiers::NONE, Key::Enter);
    assert_eq!(person.document().brush.target, FocusOffset::SHARP);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn shift_and_a_click_draw_a_straight_line_from_the_last_stroke() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    let rect = person.picture_rect();
    person.clicks(at(rect, 0.6, 0.8));
    let middle = |person: &Person| {
        let session = person.shell().session();
        let hit = session.pick(&session.picture_ray(glam::DVec2::new(0.75, 0.5)).unwrap()).unwrap();
        session.focus_at(&hit).unwrap()
    };
    assert_eq!(middle(&person), FocusOffset::STANDARD);
    let end = at(rect, 0.9, 0.2);
    person.window.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
    person.window.hover_at(end);
    person.window.step();
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::SHIFT);
        person.window.event(egui::Event::PointerButton { pos: end, button, pressed, modifiers });
        person.window.step();
    }
    person.window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    person.waits();
    let target = person.document().brush.target;
    assert!((middle(&person).t - target.t).abs() < 1e-4, "half way between the two clicks");
    assert_eq!(person.document().undo_names().count(), 2, "the line is a stroke of its own");
}

#[test]
fn the_mirror_paints_both_sides_and_blur_can_be_typed_in_other_measures() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    person.scrolls_to("Mirror X");
    person.window.get_by_label("Mirror X").click();
    person.window.run_steps(2);
    let brush = person.document().brush.clone();
    assert!(brush.mirror[0] && brush.mirror_center[0].abs() < 1e-5, "about the middle: {brush:?}");
    let rect = person.picture_rect();
    person.clicks(at(rect, 0.9, 0.85));
    let session = person.shell().session();
    let focus_at = |x: f64| {
        let hit = session.pick(&session.picture_ray(glam::DVec2::new(x, 0.85)).unwrap()).unwrap();
        session.focus_at(&hit).unwrap()
    };
    assert!(
        (focus_at(0.9).t - brush.target.t).abs() < 1e-4 && (focus_at(0.1).t - brush.target.t).abs() < 1e-4
    );
    assert_eq!(focus_at(0.5), FocusOffset::STANDARD);

    // The depth at which the unpainted lens would blur as much.
    person.scrolls_to("looks like at");
    person.window.get_by_label("looks like at").focus();
    person.window.run_steps(2);
    person.window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    person.window.event(egui::Event::Text("2".into()));
    person.window.run_steps(1);
    person.presses(Modifiers::NONE, Key::Enter);
    let document = person.document();
    let optics = document.camera.optics();
    let painted = optics.kappa(0.123, document.brush.target);
    let like = optics.kappa(1.0 / 2.0, FocusOffset::STANDARD);
    assert!((painted - like).abs() < 1e-9 * like.abs(), "{painted} {like}");
}

#[test]
fn a_click_within_one_frame_is_a_dab() {
    let (mut person, _folder) = opened();
    chooses_blur(&mut person);
    let map = person.document().map.clone();
    let pos = at(person.paint_rect(), 0.7, 0.5);
    person.window.hover_at(pos);
    person.window.step();
    let button = egui::PointerButton::Primary;
    for pressed in [true, false] {
        person.window.event(egui::Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    }
    person.window.run_steps(3);
    person.waits();
    assert_ne!(person.document().map, map);
    assert_eq!(person.document().undo_names().collect::<Vec<_>>(), ["Brush stroke"]);
}

#[test]
fn what_a_fill_would_take_is_outlined_before_the_click() {
    let (mut person, _folder) = opened();
    let rect = person.picture_rect();
    let map = person.document().map.clone();
    let point = |person: &mut Person, x: f32, y: f32| {
        person.window.hover_at(at(rect, x, y));
        person.window.run_steps(4);
        person.shell().picture_view().highlighted_share()
    };
    assert_eq!(point(&mut person, 0.25, 0.5), None, "a brush takes nothing whole");
    person.presses(Modifiers::NONE, Key::G);
    person.window.remove_cursor();
    person.window.run_steps(2);
    let before = person.window.render().unwrap();
    let card = point(&mut person, 0.25, 0.5).expect("the card");
    let after = person.window.render().unwrap();
    // Before and after the click: the brush paints sharp.
    let says = |person: &Person, what: &str| {
        person.window.query_all_by(|node| node.value().is_some_and(|text| text.contains(what))).count() > 0
    };
    assert!(says(&person, "px becomes sharp"));
    let wall = point(&mut person, 0.8, 0.2).expect("the wall");
    assert!((0.05..0.35).contains(&card) && wall > 0.5, "{card} {wall}");
    assert!((card + wall - 1.0).abs() < 0.1, "together they are all there is: {card} {wall}");
    assert_eq!(point(&mut person, 0.25, 0.5), Some(card));
    let changed = before.pixels().zip(after.pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 300, "it shows: {changed} pixels");
    assert!(person.document().map == map && person.document().undo_name().is_none());
    // With symmetry, the mirrored fill is outlined as well.
    let brush = focus::Brush {
        // Half way between card and wall: front is back.
        mirror: [false, false, true],
        mirror_center: [0.0, 0.0, -3.5],
        ..person.document().brush.clone()
    };
    person.window.state_mut().apply(session::Command::SetBrush(brush));
    let both = point(&mut person, 0.27, 0.5).expect("the card and what is at its image");
    assert!(both > 0.9, "{both}");
}

#[test]
fn something_thin_is_filled_by_a_click_beside_it() {
    let (mut person, _folder, bar) = opened_with_bar();
    let camera = person.document().camera.clone();
    let x_of = |person: &Person, point| person.shell().picture_view().screen_from_world(&camera, point);
    let on_bar = x_of(&person, bar).expect("it is in view");
    person.presses(Modifiers::NONE, Key::G);
    let share = |person: &mut Person, at: Pos2| {
        person.window.hover_at(at);
        person.window.run_steps(4);
        person.shell().picture_view().highlighted_share().expect("something whole")
    };
    assert!(share(&mut person, on_bar) < 0.05, "the bar itself");
    assert!(share(&mut person, on_bar + egui::vec2(9.0, 0.0)) > 0.5, "the wall");
    let beside = on_bar + egui::vec2(3.5, 0.0);
    assert!(share(&mut person, beside) < 0.05, "the bar, close by");
    person.drags(&[beside]);
    person.lets_go(beside);
    person.waits();
    let session = person.shell().session();
    let focus_at = |point: DVec3| {
        let eye = camera.position();
        let ray = trace::Ray {
            origin: eye,
            direction: (point - eye).normalize(),
            t_min: 0.0,
            t_max: f64::INFINITY,
            skip: None,
        };
        session.focus_at(&session.pick(&ray).unwrap()).unwrap()
    };
    assert_eq!(focus_at(bar), person.document().brush.target);
    assert_eq!(focus_at(bar + DVec3::new(0.1, 0.0, 0.0)), FocusOffset::STANDARD);

    // Beside the card's edge the wall is chosen.
    let (mut person, _folder) = opened();
    let edge = x_of(&person, DVec3::new(-0.2, 0.0, -2.0)).expect("it is in view");
    person.presses(Modifiers::NONE, Key::G);
    assert!(share(&mut person, edge + egui::vec2(3.0, 0.0)) > 0.5, "the wall");
}
