//! Recorded strokes, written and read.

use focus::Brush;
use glam::{DMat4, DVec2, DVec3};
use project::{RecordedStroke, ViewFrame, read_strokes, write_strokes};

fn stroke() -> RecordedStroke {
    let view = ViewFrame {
        camera_to_world: DMat4::from_rotation_translation(
            glam::DQuat::from_rotation_y(0.1 + 0.2),
            DVec3::new(1.0 / 3.0, 2.0, -0.7),
        ),
        yfov: 0.7,
        aspect: 16.0 / 9.0,
    };
    let points = (0..50).map(|k| [k as f64 / 49.0, (k as f64 * 0.37).sin().abs(), 1.0 / (1.0 + k as f64)]);
    let brush = Brush { mirror: [true, false, false], ..Brush::default() };
    RecordedStroke { layer: "far \"lamp\"".into(), brush, view, points: points.collect() }
}

#[test]
fn what_is_written_is_read_to_the_bit_and_what_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strokes.json");
    let strokes = [stroke(), RecordedStroke { points: Vec::new(), ..stroke() }];
    write_strokes(&file, &strokes).unwrap();
    assert_eq!(read_strokes(&file).unwrap(), strokes);

    let text = std::fs::read_to_string(&file).unwrap();
    let cases = [
        ("focus-brush strokes", "shopping list", "shopping list"),
        ("\"version\":1", "\"version\":9", "update the program"),
        ("\"yfov\":0.7", "\"yfov\":-0.7", "stroke 1: its view"),
        ("\"hardness\":0.5", "\"hardness\":7", "stroke 1: brush: hardness"),
        ("\"points\":[[", "\"points\":[[\"a\",", "understood"),
    ];
    for (from, to, expected) in cases {
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let error = read_strokes(&file).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("strokes.json"), "{error}");
    }
}

#[test]
fn a_view_looks_where_its_pose_says() {
    let view = ViewFrame { camera_to_world: DMat4::IDENTITY, yfov: std::f64::consts::FRAC_PI_2, aspect: 2.0 };
    let toward = |x, y| view.ray(DVec2::new(x, y)).1;
    assert!(toward(0.5, 0.5).distance(DVec3::NEG_Z) < 1e-12);
    assert!(toward(0.0, 0.0).distance(DVec3::new(-2.0, 1.0, -1.0)) < 1e-12);
    assert!(toward(1.0, 1.0).distance(DVec3::new(2.0, -1.0, -1.0)) < 1e-12);
}
