//! Recorded strokes, written and read.

use focus::{
    Brush, Channels, CombineMode, FillTarget, Gradient, GradientLine, GradientShape, LayerEdit, Symmetry,
    ViewFrame,
};
use glam::{DMat4, DVec2, DVec3};
use lens::FocusOffset;
use project::{
    RecordedFill, RecordedGradient, RecordedSelection, RecordedStep, RecordedStroke, SelectionShape,
    StrokeView, read_strokes, write_strokes,
};

fn view() -> ViewFrame {
    ViewFrame {
        camera_to_world: DMat4::from_rotation_translation(
            glam::DQuat::from_rotation_y(0.1 + 0.2),
            DVec3::new(1.0 / 3.0, 2.0, -0.7),
        ),
        yfov: 0.7,
        aspect: 16.0 / 9.0,
        shift: DVec2::new(0.25, -0.125),
    }
}

fn stroke() -> RecordedStroke {
    let points = (0..50).map(|k| [k as f64 / 49.0, (k as f64 * 0.37).sin().abs(), 1.0 / (1.0 + k as f64)]);
    let brush = Brush { mirror: [true, false, false], ..Brush::default() };
    RecordedStroke { layer: "far \"lamp\"".into(), brush, view: view().into(), points: points.collect() }
}

#[test]
fn strokes_round_trip_to_the_bit_and_errors_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strokes.json");
    let layer = String::from("far \"lamp\"");
    let select = |shape, combine| RecordedStep::Select(RecordedSelection { shape, combine });
    let gradient = Gradient {
        shape: GradientShape::Radial,
        line: GradientLine::View(view(), [DVec2::new(0.1, 0.2), DVec2::new(1.0 / 3.0, 0.7)]),
        from: FocusOffset::SHARP,
        to: Some(FocusOffset::new(1.03, 0.25)),
        symmetry: Symmetry { radial: 3, ..Symmetry::default() },
    };
    let across = GradientLine::World([DVec3::ZERO, DVec3::new(0.1, 0.2, 0.3)]);
    let fading = Gradient { line: across, to: None, ..gradient };
    let points = vec![DVec2::ZERO, DVec2::X, DVec2::new(0.3, 0.9)];
    let steps = [
        RecordedStep::Stroke(stroke()),
        RecordedStep::Stroke(RecordedStroke { points: Vec::new(), ..stroke() }),
        RecordedStep::Stroke(RecordedStroke { view: StrokeView::Atlas { atlas: "a1b2".into() }, ..stroke() }),
        RecordedStep::Fill(RecordedFill {
            layer: layer.clone(),
            targets: vec![FillTarget::Node(3), FillTarget::Background, FillTarget::Everything],
            focus: FocusOffset::new(0.97, 0.5),
        }),
        RecordedStep::Gradient(RecordedGradient { layer: layer.clone(), gradient }),
        RecordedStep::Gradient(RecordedGradient { layer, gradient: fading }),
        select(SelectionShape::Outline { view: view(), points, through: true }, CombineMode::Replace),
        select(SelectionShape::Targets(vec![FillTarget::Material(1)]), CombineMode::Add),
        select(SelectionShape::Inverse, CombineMode::Replace),
        select(
            SelectionShape::Depth { origin: DVec3::ONE, axis: DVec3::Z, range: [0.5, 2.0] },
            CombineMode::Intersect,
        ),
        select(SelectionShape::Normal { normal: DVec3::Y, degrees: 30.0 }, CombineMode::Subtract),
        RecordedStep::Layers(LayerEdit::AddPaint),
        RecordedStep::Layers(LayerEdit::Opacity(1, 0.3)),
        RecordedStep::Layers(LayerEdit::Shift { from: 1, to: 0 }),
        RecordedStep::Reset,
    ];
    write_strokes(&file, &steps).unwrap();
    assert_eq!(read_strokes(&file).unwrap(), steps);

    let text = std::fs::read_to_string(&file).unwrap();
    let cases = [
        ("focus-brush strokes", "shopping list", "shopping list"),
        ("\"version\":3", "\"version\":9", "update the program"),
        ("\"yfov\":0.7", "\"yfov\":-0.7", "step 1: its view"),
        ("\"hardness\":0.5", "\"hardness\":7", "step 1: brush: hardness"),
        ("\"points\":[[", "\"points\":[[\"a\",", "is not a valid strokes file"),
    ];
    for (from, to, expected) in cases {
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let error = read_strokes(&file).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("strokes.json"), "{error}");
    }
}

#[test]
fn gloss_raises_the_version() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strokes.json");
    let written = |step: RecordedStep| {
        write_strokes(&file, std::slice::from_ref(&step)).unwrap();
        assert_eq!(read_strokes(&file).unwrap(), [step]);
        std::fs::read_to_string(&file).unwrap()
    };
    let gradient = |from: FocusOffset, to: FocusOffset| {
        let line = GradientLine::World([DVec3::ZERO, DVec3::X]);
        let (shape, symmetry) = (GradientShape::Linear, Symmetry::default());
        let gradient = Gradient { shape, line, from, to: Some(to), symmetry };
        RecordedStep::Gradient(RecordedGradient { layer: "Paint".into(), gradient })
    };
    let glossy = FocusOffset::new(1.2, 0.5).with_gloss(0.75);
    let brush = |brush: Brush| RecordedStep::Stroke(RecordedStroke { brush, ..stroke() });
    let fill = |focus| {
        let targets = vec![FillTarget::Everything];
        RecordedStep::Fill(RecordedFill { layer: "Paint".into(), targets, focus })
    };
    for step in [
        brush(Brush { target: glossy, ..Brush::default() }),
        brush(Brush { channels: Channels::Gloss, ..Brush::default() }),
        fill(glossy),
        gradient(glossy, FocusOffset::SHARP),
        gradient(FocusOffset::SHARP, glossy),
    ] {
        let text = written(step);
        assert!(text.contains("\"version\":5"), "{text}");
    }
    let plain = [
        brush(Brush::default()),
        fill(FocusOffset::SHARP),
        gradient(FocusOffset::SHARP, FocusOffset::STANDARD),
    ];
    for step in plain {
        let text = written(step);
        assert!(text.contains("\"version\":3") && !text.contains("gloss"), "{text}");
    }
}

#[test]
fn files_of_the_first_version_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strokes.json");
    let stroke = serde_json::to_string(&stroke()).unwrap();
    let text = format!(r#"{{"format":"focus-brush strokes","version":1,"strokes":[{stroke}]}}"#);
    std::fs::write(&file, text).unwrap();
    assert_eq!(read_strokes(&file).unwrap(), [RecordedStep::Stroke(self::stroke())]);
}

#[test]
fn a_view_has_the_direction_of_its_pose() {
    let view = ViewFrame {
        camera_to_world: DMat4::IDENTITY,
        yfov: std::f64::consts::FRAC_PI_2,
        aspect: 2.0,
        shift: glam::DVec2::ZERO,
    };
    let toward = |x, y| view.ray(DVec2::new(x, y)).1;
    assert!(toward(0.5, 0.5).distance(DVec3::NEG_Z) < 1e-12);
    assert!(toward(0.0, 0.0).distance(DVec3::new(-2.0, 1.0, -1.0)) < 1e-12);
    assert!(toward(1.0, 1.0).distance(DVec3::new(2.0, -1.0, -1.0)) < 1e-12);
}
