//! Scenes in the units of a photographer's world are shown darker.

#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use serde_json::json;
use session::{Command, Event, PreviewKind, Quality, Session, SessionOptions};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

#[test]
fn a_scene_too_bright_for_the_screen_tells_so_once_and_with_its_first_blurred_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("bright.glb");
    let (mut doc, bin) = tiny_glb::parts(&tiny_glb::metal(&tiny_glb::QUADS));
    doc["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    for material in doc["materials"].as_array_mut().unwrap() {
        material["emissiveFactor"] = json!([1.0, 1.0, 1.0]);
        material["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 100.0 } });
    }
    std::fs::write(&scene, tiny_glb::container(&doc, &bin)).unwrap();

    let exact_after = Some(Duration::from_millis(20));
    let options = SessionOptions { preview_size: 60, exact_delay: exact_after, ..SessionOptions::default() };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(scene)).unwrap();
    let (start, mut told) = (Instant::now(), Vec::new());
    loop {
        assert!(start.elapsed() < PATIENCE, "an exact picture never comes");
        std::thread::sleep(Duration::from_millis(2));
        for event in session.poll() {
            match event {
                Event::GlareDetected(stops) => told.push(stops),
                Event::Failed(why) => panic!("{why}"),
                _ => {}
            }
        }
        let Some(preview) = session.preview() else { continue };
        if preview.kind != PreviewKind::Pinhole {
            assert_eq!(told.len(), 1, "{:?}: {told:?}", preview.quality);
        }
        if preview.quality == Quality::Exact {
            break;
        }
    }
    assert!((-8.0..=-7.0).contains(&told[0]), "of 100, and what is mirrored of it: {told:?}");
}
