//! History, drawer, theme, and playback of a recording.

use crate::acting::{Person, at, color_at};
use crate::small_scene::{self, opened};
use document::FillRegion;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use focus_brush::window::{Shell, WindowOptions};
use lens::FocusOffset;
use project::{RecordedFill, RecordedStep, RecordedStroke};
use session::{Command, CommandId};

impl Person {
    /// Clicks a step of the history.
    fn goes_to(&mut self, step: &str) {
        self.scrolls_to(step);
        self.window.get_by_label(step).click_accesskit();
        self.window.run_steps(2);
        self.waits();
    }
}

#[test]
fn the_history_shows_what_changed_and_a_click_goes_there() {
    let (mut person, _folder) = opened();
    let blank = person.document().map.clone();
    for _ in 0..6 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    let rect = person.picture_rect();
    person.clicks(at(rect, 0.75, 0.5));
    let one = person.document().map.clone();
    person.window.state_mut().apply(Command::Fill(FillRegion::All, FocusOffset::SHARP));
    person.presses(Modifiers::NONE, Key::Plus);
    person.waits();
    let history: Vec<_> = person.document().history().map(|step| step.name.to_string()).collect();
    assert_eq!(history, ["Brush stroke", "Fill everything", "f-number"]);
    let share = |person: &Person, step: usize| {
        let picture = person.document().history().nth(step).unwrap().thumbnail.cloned();
        picture.map(|picture| picture.cells().iter().filter(|cell| cell.changed > 0.0).count())
    };
    let (stroke, fill) = (share(&person, 0).unwrap(), share(&person, 1).unwrap());
    assert!(stroke > 0 && fill > 4 * stroke, "a stroke changes little, a fill much: {stroke} {fill}");
    assert_eq!(share(&person, 2), None, "the lens is no paint");

    person.scrolls_to("History");
    person.window.get_all_by_label("History").last().unwrap().click();
    person.window.run_steps(20);
    person.goes_to("1  Brush stroke");
    person.waits();
    assert!(person.document().map == one, "{:?}", person.document().undo_names().collect::<Vec<_>>());
    assert_eq!(person.document().history().filter(|step| step.is_done).count(), 1);
    person.goes_to("0  As opened");
    assert_eq!(person.document().undo_name(), None);
    assert!(person.document().map == blank);
    person.goes_to("3  f-number");
    assert_eq!(person.document().history().filter(|step| step.is_done).count(), 3);
    assert_eq!(person.document().redo_name(), None);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_atlas_is_painted_on_in_2d() {
    let (mut person, folder) = opened();
    for _ in 0..12 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    let (map, target) = (person.document().map.clone(), person.document().brush.target);
    person.presses(Modifiers::NONE, Key::F7);
    person.window.run_steps(30);
    // The screen position of a texel of the card.
    let document = person.document();
    let card = document.stage.canvas.texels().find(|texel| texel.position.z > -3.0).unwrap();
    let chart = &document.stage.atlas.charts[card.chart as usize];
    let middle = [0, 1].map(|axis| (chart.bounds[axis].start + chart.bounds[axis].end) as f32 / 2.0);
    let [width, height] = document.map.size().map(|side| side as f32);
    let place = at(person.shell().drawer().atlas_rect(), middle[0] / width, middle[1] / height);
    person.window.remove_cursor();
    person.window.run_steps(2);
    let before = person.window.render().unwrap();
    person.paints(&[place, place + egui::vec2(2.0, 1.0), place + egui::vec2(4.0, 2.0)]);
    assert_ne!(person.document().map, map);
    let painted = person.document().map.at(middle[0] as u32, middle[1] as u32);
    assert!((painted.t - target.t).abs() < 1e-4, "{painted:?}");
    person.window.remove_cursor();
    person.window.run_steps(2);
    let after = person.window.render().unwrap();
    let (old, new) = (color_at(&before, place), color_at(&after, place));
    assert!(old != new && new[2] > new[0], "far blur is blue in the atlas too: {old:?} {new:?}");
    // It is recorded, and its replay gives the same result; but not on another atlas.
    let strokes = folder.path().join("strokes.json");
    person.window.state_mut().apply(session::Command::ExportStrokes(strokes.clone()));
    let painted = person.document().map.clone();
    let mut steps = project::read_strokes(&strokes).unwrap();
    let begun = || {
        let scene = folder.path().join("wall.glb");
        document::Document::create(
            &scene,
            &Default::default(),
            &Default::default(),
            &Default::default(),
            &progress::Unwatched,
        )
        .unwrap()
    };
    let mut again = begun();
    assert_eq!(document::replay(&mut again, &steps).unwrap(), 1);
    assert!(again.map == painted);
    let RecordedStep::Stroke(stroke) = &mut steps[0] else { panic!("a stroke: {steps:?}") };
    stroke.view = project::StrokeView::Atlas { atlas: "another".into() };
    let refused = document::replay(&mut begun(), &steps).unwrap_err().to_string();
    assert!(refused.contains("another atlas"), "{refused}");
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(person.document().map, map);
    person.presses(Modifiers::NONE, Key::F7);
    assert!(person.window.query_by_label("Atlas view").is_none(), "folded away");
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_aperture_as_a_point_sees_it() {
    let (mut person, _folder) = opened();
    let rect = person.picture_rect();
    person.presses(Modifiers::NONE, Key::Q);
    person.clicks(at(rect, 0.25, 0.5));
    person.window.run_steps(20);
    let image = person.shell().drawer().aperture_image().expect("the card's").clone();
    assert_eq!(image.visible_share(), 1.0, "nothing stands before the card");
    let kept = image.baked.expect("a sample of the light field");
    assert_eq!((kept.side, kept.visible_share()), (1, 1.0), "and the light field keeps it open");
    assert!((image.depth - 2.0).abs() < 1e-6 && image.circle_px < 0.0, "nearer than the focus");
    // A disc: its corners are opaque.
    assert!(image.cells[0].transmission == 0.0 && image.cells[16 * 32 + 16].transmission == 1.0);
    // The wall beside the card's outline, visible from part of the aperture: searched along a row.
    let session = person.shell().session();
    let images: Vec<_> = (0..400)
        .filter_map(|k| {
            let ray = session.picture_ray(glam::DVec2::new(0.2 + 0.001 * k as f64, 0.5))?;
            let hit = session.pick(&ray).filter(|hit| hit.position.z < -4.0)?;
            session.aperture_image(&hit)
        })
        .collect();
    let shares: Vec<f64> = images.iter().map(|image| image.visible_share()).collect();
    // The light field's aperture cells equal the rays' over the whole square.
    let by_rays = |image: &session::ApertureImage| {
        image.cells.iter().filter(|cell| cell.is_visible).count() as f64 / image.cells.len() as f64
    };
    let differences =
        images.iter().filter_map(|image| Some((image.baked.as_ref()?.visible_share(), by_rays(image))));
    let differences: Vec<(f64, f64)> = differences.collect();
    assert!(differences.len() > 50 && differences.iter().any(|(kept, _)| *kept < 0.8 && *kept > 0.2));
    let mean = |off: &dyn Fn(&(f64, f64)) -> f64| {
        differences.iter().map(off).sum::<f64>() / differences.len() as f64
    };
    let error = mean(&|(kept, rays)| (kept - rays).abs());
    assert!(error < 0.05, "{error}");
    assert!(mean(&|(kept, rays)| (1.0 - kept - rays).abs()) > 0.3, "what is hidden is not what is seen");
    assert!(shares.iter().any(|share| *share > 0.2 && *share < 0.8), "half hidden beside the outline");
    assert_eq!(shares[shares.len() - 1], 1.0, "and free further on");
    assert!(person.window.query_all_by_label_contains("100 %").next().is_some());

    person.presses(Modifiers::NONE, Key::F9);
    person.window.run_steps(5);
    assert!(person.window.query_by_label_contains("of the picture is sharper than 1 px").is_some());
    let histogram = person.shell().session().blur_histogram([48, 32]).unwrap();
    assert!(histogram.quantile(0.0).unwrap() < -1.0, "the card is near");
    assert!(histogram.sharper_than(1.0) > 0.5, "the wall is in focus");
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_window_can_be_light_and_twice_as_large_and_tones_are_mapped() {
    let (mut person, _folder) = opened();
    // Within a button, because panels have the clear colour of the window.
    let corner = person.window.get_by_label("Fit").rect().left_top() + egui::vec2(4.0, 4.0);
    person.window.run_steps(2);
    let dark = color_at(&person.window.render().unwrap(), corner);
    let white = at(person.picture_rect(), 0.9, 0.9);
    let clipped = color_at(&person.window.render().unwrap(), white);
    person.presses(Modifiers::NONE, Key::T);
    person.waits();
    let neutral = color_at(&person.window.render().unwrap(), white);
    assert_ne!(clipped, neutral, "another tone");
    person.does(CommandId::LightOrDark);
    let light = color_at(&person.window.render().unwrap(), corner);
    assert!(light[0] > dark[0] + 100.0, "{light:?} {dark:?}");
    for _ in 0..8 {
        person.presses(Modifiers::COMMAND, Key::Plus);
    }
    person.window.run_steps(10);
    assert_eq!(person.window.ctx.zoom_factor(), 2.0);
    // Everything still fits into the window: views, slider of the tool bar, list of keys.
    let whole = person.window.ctx.content_rect();
    person.does(CommandId::Shortcuts);
    person.window.run_steps(10);
    let shown = |label: &str| {
        let node = person.window.get_all_by_label(label).next();
        node.unwrap_or_else(|| panic!("there is no {label}")).rect()
    };
    for label in ["Blur", "Keyboard and mouse", "Left drag"] {
        assert!(whole.expand(1.0).contains_rect(shown(label)), "{label} at {:?} in {whole:?}", shown(label));
    }
    for rect in [person.paint_rect(), person.picture_rect()] {
        assert!(whole.contains_rect(rect) && rect.width() > 40.0, "{rect:?} in {whole:?}");
    }
    for _ in 0..8 {
        person.presses(Modifiers::COMMAND, Key::Minus);
    }
    assert_eq!(person.window.ctx.zoom_factor(), 0.75);
}

#[test]
fn a_recording_is_played_in_the_window_and_timed() {
    let folder = tempfile::tempdir().unwrap();
    let (file, trace) = (folder.path().join("wall.glb"), folder.path().join("trace.json"));
    small_scene::write(&file);
    let view = focus::ViewFrame {
        camera_to_world: glam::DMat4::IDENTITY,
        yfov: 0.7,
        aspect: 1.5,
        shift: glam::DVec2::ZERO,
    };
    let brush = focus::Brush { radius: 0.2, target: FocusOffset::new(1.02, 1.0), ..Default::default() };
    let points = (0..40).map(|k| [0.5 + 0.01 * k as f64, 0.8, 1.0]).collect();
    let stroke = RecordedStroke { layer: "Paint".into(), brush, view: view.into(), points };
    let targets = vec![focus::FillTarget::Node(1)];
    let fill = RecordedFill { layer: "Paint".into(), targets, focus: FocusOffset::SHARP };
    let steps = vec![RecordedStep::Fill(fill), RecordedStep::Stroke(stroke)];
    let options = WindowOptions {
        file: Some(file),
        demo: false,
        remember: false,
        preview_size: Some(120),
        system_dialogs: false,
        replay: Some(steps),
        trace: Some(trace.clone()),
        ..WindowOptions::default()
    };
    let builder = Harness::builder().with_size([900.0, 600.0]).wgpu();
    let window = builder.build_eframe(move |creation| Shell::new(creation, options).unwrap());
    let mut person = Person { window };
    person.wait_until("the trace is written", |_| trace.is_file());
    let names: Vec<_> = person.document().undo_names().map(str::to_string).collect();
    assert_eq!(names, ["Fill object", "Brush stroke"]);
    let text = std::fs::read_to_string(&trace).unwrap();
    let told: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |what: &str, key: &str| told[what][key].as_f64().unwrap();
    for what in ["event_to_picture_ms", "due_to_picture_ms"] {
        assert!(number(what, "count") > 5.0, "{told}");
        assert!(number(what, "median") > 0.0 && number(what, "median") <= number(what, "p99"), "{told}");
    }
    assert!(number("event_to_picture_ms", "median") <= number("due_to_picture_ms", "median"), "{told}");
    assert!(told["error_against_exact"]["psnr"].as_f64() > Some(35.0), "{told}");
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_drag_over_the_aperture_looks_through_it() {
    let (mut person, _folder) = opened();
    let before = person.picture().radiance.clone();
    person.presses(Modifiers::NONE, Key::F8);
    person.window.run_steps(3);
    let field = person.window.get_by_label("from behind the camera").rect();
    let middle = field.center() - egui::vec2(0.0, 50.0);
    let beside = middle + egui::vec2(20.0, 0.0);
    person.drags(&[middle, beside]);
    person.waits();
    let point = person.shell().session().sub_aperture_point().expect("the drag chose a point");
    assert!(point.x > 0.1 && point.y.abs() < 0.9, "{point}");
    assert!(person.picture().radiance != before, "the card is out of focus: it moved");
    assert!(person.window.query_by_label_contains("through one point of the aperture").is_some());
    person.lets_go(beside);
    person.waits();
    assert_eq!(person.shell().session().sub_aperture_point(), None);
    assert_eq!(person.picture().radiance, before);

    // It orbits until Esc.
    person.presses(Modifiers::NONE, Key::J);
    let mut points = Vec::new();
    for _ in 0..20 {
        person.window.step();
        points.extend(person.shell().session().sub_aperture_point());
    }
    assert!(points.iter().any(|point| point.distance(points[0]) > 0.05), "it runs: {points:?}");
    assert!(points.iter().all(|point| (point.length() - 15.0 / 16.0).abs() < 0.02), "on the rim");
    person.presses(Modifiers::NONE, Key::Escape);
    person.waits();
    assert_eq!(person.shell().session().sub_aperture_point(), None);
    assert_eq!(person.picture().radiance, before);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
