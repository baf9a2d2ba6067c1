//! A document is saved, opened again, exported, recovered.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, opened_with, picture, settle, stroke};
use document::{CameraEdit, FillRegion};
use focus::BrushMode;
use glam::DVec2;
use session::{Command, Event, Session, SessionOptions};
use std::time::{Duration, Instant};

#[test]
fn what_is_saved_is_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let project = folder.path().join("quads.fbrush");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    assert!(session.apply(Command::Save).is_err(), "there is no file yet");
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    session.apply(Command::EditCamera(CameraEdit::FocusDistance(2.5))).unwrap();
    session.apply(Command::SetView(serde_json::json!({"yaw": 0.25}))).unwrap();
    let card = session.pick(&session.picture_ray(DVec2::new(0.4, 0.5)).unwrap()).unwrap();
    session.apply(Command::SelectRegion(FillRegion::Node(card), focus::CombineMode::Replace)).unwrap();
    let selection = session.document().unwrap().selection.clone();
    assert!(selection.is_some());
    session.apply(Command::SaveAs(project.clone())).unwrap();
    let events = settle(&mut session);
    assert!(events.contains(&Event::FileWritten(project.clone())));
    let document = session.document().unwrap();
    assert!(!document.is_unsaved());
    assert_eq!(document.name(), "quads.fbrush");
    let (map, painted) = (document.map.clone(), picture(&session));

    let mut again = opened(&project);
    let document = again.document().unwrap();
    assert!(document.map == map);
    assert!(document.selection == selection, "what may be painted is kept");
    assert_eq!(document.camera.focus_distance, 2.5);
    assert_eq!(document.brush.mode, BrushMode::Set);
    assert_eq!(document.view["yaw"], 0.25);
    assert!(!document.is_unsaved());
    assert!(picture(&again) == painted);

    // Its focus map, written and read back, is the same document.
    let exported = folder.path().join("focus.exr");
    again.apply(Command::ExportFocusMap(exported.clone())).unwrap();
    settle(&mut again);
    again.apply(Command::ResetMap).unwrap();
    again.apply(Command::ImportFocusMap(exported)).unwrap();
    settle(&mut again);
    assert!(again.document().unwrap().map == map);
    let page = folder.path().join("page.html");
    let estimate = again.web_page_estimate().unwrap();
    assert!(estimate.slices >= 3 && estimate.bytes > 0, "{estimate:?}");
    again.apply(Command::ExportWebPage(page.clone())).unwrap();
    assert!(again.jobs().pop().is_some_and(|job| job.label.contains("page.html") && job.can_cancel));
    assert!(settle(&mut again).contains(&Event::FileWritten(page.clone())));
    let html = std::fs::read_to_string(page).unwrap();
    assert!(html.contains("<title>quads</title>") && html.contains("\"isPainted\":true"), "as it is painted");
    let page = folder.path().join("paint.html");
    again.apply(Command::ExportEnginePage(page.clone())).unwrap();
    assert!(settle(&mut again).contains(&Event::FileWritten(page.clone())));
    assert!(std::fs::read_to_string(page).unwrap().contains("showEnginePage({\"title\":\"quads\""));
    let shot = folder.path().join("shot.png");
    again.apply(Command::ExportPicture(shot.clone(), Default::default())).unwrap();
    settle(&mut again);
    assert!(shot.is_file());
}

#[test]
fn the_unwrapped_scene_is_written_in_the_background_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let unwrapped = folder.path().join("unwrapped.glb");
    session.apply(Command::ExportScene(unwrapped.clone())).unwrap();
    let job = session.jobs().pop().expect("it is done in the background");
    assert!(job.label.contains("unwrapped.glb") && job.can_cancel, "{job:?}");
    let events = settle(&mut session);
    assert!(events.contains(&Event::FileWritten(unwrapped.clone())));
    let again = document::load_scene(&unwrapped, &progress::Unwatched).unwrap();
    let document = session.document().unwrap();
    assert_eq!(again.triangles.len(), document.scene().triangles.len());
    let size = glam::Vec2::new(document.stage.atlas.width as f32, document.stage.atlas.height as f32);
    let place = again.corner_uv(0, 1)[0] * size;
    assert!(place.distance(document.stage.atlas.corners[0][0]) < 1e-3, "TEXCOORD_1 is the atlas");

    let wrong = folder.path().join("unwrapped.obj");
    session.apply(Command::ExportScene(wrong.clone())).unwrap();
    while !session.is_settled() {
        std::thread::sleep(Duration::from_millis(5));
        let failed = session.poll().into_iter().any(|event| matches!(event, Event::Failed(_)));
        assert!(!failed || !wrong.exists());
    }

    // Cancelled before it began: there is no file.
    let progress = jobs::JobProgress::default();
    progress.cancel();
    let never = folder.path().join("never.glb");
    let stage = &session.document().unwrap().stage;
    let stopped = atlas::write_glb(&stage.scene, &stage.atlas, &never, &progress);
    assert!(matches!(stopped, Err(atlas::AtlasError::Cancelled)) && !never.exists());
}

#[test]
fn a_scene_that_is_written_has_the_lens_of_the_shot_camera() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let input = document::Input::open(&scene, &Default::default(), &progress::Unwatched).unwrap();
    let atlas = input.atlas(&Default::default(), &progress::Unwatched).unwrap();
    let own =
        lens::Camera { shift: glam::DVec2::new(0.25, -0.5), aperture_radius: 0.03, ..input.camera.clone() };
    let elsewhere = lens::Camera { yfov: 0.9, ..own.clone() };
    for (shot, count) in [(own, 1), (elsewhere, 2)] {
        let file = folder.path().join("written.glb");
        render::write_unwrapped(&file, &input.scene, &atlas, Some(&shot), &progress::Unwatched).unwrap();
        let again = document::Input::open(&file, &Default::default(), &progress::Unwatched).unwrap();
        assert_eq!(again.scene.cameras.len(), count);
        let camera = &again.scene.cameras[count - 1];
        assert_eq!(camera.lens.apply_to(input.camera.clone()).shift, shot.shift);
        assert_eq!(camera.lens.aperture_radius, Some(0.03));
        assert!((camera.yfov - shot.yfov).abs() < 1e-6);
        let first = &again.scene.cameras[0];
        assert_eq!(first.lens.specified_fields().is_empty(), count == 2, "only one camera has the lens");
    }
}

#[test]
fn a_template_begins_a_document_without_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let template = folder.path().join("template.fbrush");
    tiny_glb::write(&scene);
    let recipe = folder.path().join("recipe.json");
    std::fs::write(&recipe, r#"{"nodes": {"card": {"t": 1.1, "anchor": 1}}}"#).unwrap();
    let unwrap = Default::default();
    let begun = {
        let beginning = document::NewDocumentOptions { focus: Some(&recipe), ..Default::default() };
        document::Document::create(&scene, &beginning, &unwrap, &Default::default(), &progress::Unwatched)
            .unwrap()
    };
    begun.to_project().save(&template).unwrap();
    let bytes = std::fs::read(&template).unwrap();

    let mut session = Session::new(SessionOptions { preview_size: 120, ..Default::default() }).unwrap();
    session.apply(Command::OpenTemplate(template.clone())).unwrap();
    settle(&mut session);
    let document = session.document().unwrap();
    assert_eq!((document.path.as_ref(), document.is_unsaved()), (None, false));
    let card = session.pick(&session.picture_ray(DVec2::new(0.4, 0.5)).unwrap()).unwrap();
    assert!((session.focus_at(&card).unwrap().t - 1.1).abs() < 1e-6);
    assert!(session.apply(Command::Save).is_err(), "a template is not saved over");
    let own = folder.path().join("own.fbrush");
    session.apply(Command::SaveAs(own.clone())).unwrap();
    settle(&mut session);
    assert_eq!(session.document().unwrap().path.as_ref(), Some(&own));
    assert_eq!(std::fs::read(&template).unwrap(), bytes);
}

#[test]
fn unsaved_work_is_restored() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let project = folder.path().join("quads.fbrush");
    tiny_glb::write(&scene);
    let options = SessionOptions { recovery_delay: Duration::from_millis(100), ..SessionOptions::default() };
    let mut session = opened_with(&scene, options);
    session.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut session);
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    let recovery = project::recovery_path_for(&project);
    assert!(!recovery.exists());
    let start = Instant::now();
    while !recovery.exists() {
        settle(&mut session);
        assert!(start.elapsed() < Duration::from_secs(60), "unsaved work is kept");
    }
    settle(&mut session);
    let map = session.document().unwrap().map.clone();
    // A crash: nothing is put in order.
    std::mem::forget(session);

    let mut again = opened(&project);
    let document = again.document().unwrap();
    assert!(document.map == map);
    assert!(document.is_unsaved());
    assert!(document.warnings.iter().any(|warning| warning.contains("restored")));
    again.apply(Command::Save).unwrap();
    settle(&mut again);
    assert!(!recovery.exists(), "saving makes it superfluous");
    assert!(!opened(&project).document().unwrap().is_unsaved());
}

#[test]
fn a_failed_open_leaves_the_document_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF\x02\0\0\0").unwrap();
    session.apply(Command::Open(broken)).unwrap();
    let mut events = Vec::new();
    while !session.is_settled() {
        events.extend(session.poll());
        std::thread::sleep(Duration::from_millis(5));
    }
    events.extend(session.poll());
    let failed = events.iter().find_map(|event| match event {
        Event::Failed(why) => Some(why),
        _ => None,
    });
    assert!(failed.is_some_and(|why| why.contains("broken.glb")), "{events:?}");
    assert_eq!(session.document().unwrap().name(), "quads.glb");
}
