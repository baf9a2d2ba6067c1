//! Variants of a scene's materials: chosen, painted in, undone, saved and opened again.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, picture, settle, stroke};
use document::{FillRegion, Input, VariantChoice};
use session::{Command, Event, Session};
use std::path::PathBuf;
use std::time::{Duration, Instant};

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write(&tiny_glb::varied(&tiny_glb::QUADS));
        place
    }

    fn write(&self, scene: &[u8]) {
        std::fs::write(self.scene(), scene).unwrap();
    }

    fn scene(&self) -> PathBuf {
        self.folder.path().join("varied.glb")
    }

    fn project(&self) -> PathBuf {
        self.folder.path().join("varied.fbrush")
    }
}

fn variant(session: &Session) -> Option<&str> {
    session.document().unwrap().scene().variant.as_deref()
}

/// The colour of the picture where the card is.
fn on_card(session: &Session) -> [f32; 3] {
    let picture = picture(session);
    let (x, y) = ((0.43 * picture.width as f32) as u32, picture.height / 2);
    picture.radiance[(y * picture.width + x) as usize]
}

fn choose(session: &mut Session, name: Option<&str>) -> Vec<Event> {
    session.apply(Command::SetVariant(name.map(String::from))).unwrap();
    settle(session)
}

#[test]
fn a_variant_is_seen_and_what_was_painted_stays() {
    let place = Place::new();
    let mut session = opened(&place.scene());
    let near =
        |color: [f32; 3], expected: [f32; 3]| color.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02);
    assert!(near(on_card(&session), [0.8, 0.1, 0.1]), "{:?}", on_card(&session));
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    settle(&mut session);
    let (atlas, map) = {
        let document = session.document().unwrap();
        (document.stage.atlas.clone(), document.map.clone())
    };
    let events = choose(&mut session, Some("Blue"));
    assert!(events.contains(&Event::SurfaceChanged) && variant(&session) == Some("Blue"));
    assert!(near(on_card(&session), [0.1, 0.1, 0.8]), "{:?}", on_card(&session));
    let document = session.document().unwrap();
    assert!(
        std::sync::Arc::ptr_eq(&document.stage.atlas, &atlas) && document.map == map && document.is_unsaved()
    );

    // What is filled is what has the material now.
    let hit = session.pick(&session.picture_ray(at_work::ON_WALL).unwrap()).unwrap();
    let focus = lens::FocusOffset::new(1.5, 1.0);
    session.apply(Command::Fill(FillRegion::Material(hit), focus)).unwrap();
    assert_eq!(session.document().unwrap().focus_at(&hit), focus);
    assert!(session.document().unwrap().map != map);
}

#[test]
fn a_variant_is_a_step_of_undo() {
    let place = Place::new();
    let mut session = opened(&place.scene());
    choose(&mut session, Some("Blue"));
    choose(&mut session, Some("Green"));
    choose(&mut session, Some("Green"));
    let names: Vec<_> = session.document().unwrap().undo_names().map(String::from).collect();
    assert_eq!(names, ["Variant", "Variant"], "the same one again is no step");
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!((variant(&session), session.document().unwrap().redo_name()), (Some("Blue"), Some("Variant")));
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Redo).unwrap();
    settle(&mut session);
    assert_eq!(variant(&session), Some("Blue"), "of two steps in a row the last counts");
    session.apply(Command::GoToHistoryStep(0)).unwrap();
    settle(&mut session);
    assert_eq!(variant(&session), None);
    session.apply(Command::GoToHistoryStep(2)).unwrap();
    settle(&mut session);
    assert_eq!(variant(&session), Some("Green"));
    // One that was asked for before another is not taken up, even if it is done.
    session.apply(Command::SetVariant(Some("Blue".into()))).unwrap();
    std::thread::sleep(Duration::from_millis(300));
    session.apply(Command::SetVariant(Some("Green".into()))).unwrap();
    settle(&mut session);
    assert_eq!((variant(&session), session.document().unwrap().undo_names().count()), (Some("Green"), 2));
}

#[test]
fn a_world_that_is_chosen_meanwhile_is_not_lost() {
    let place = Place::new();
    let mut session = opened(&place.scene());
    let white = scene::World::uniform(glam::Vec3::ONE);
    session.apply(Command::SetVariant(Some("Blue".into()))).unwrap();
    session.apply(Command::SetWorld(Some(white.clone()))).unwrap();
    settle(&mut session);
    let scene = session.document().unwrap().scene();
    assert_eq!((scene.variant.as_deref(), scene.world.as_ref()), (Some("Blue"), Some(&white)));
    assert_eq!(session.document().unwrap().undo_names().count(), 1);
}

#[test]
fn a_project_keeps_its_variant() {
    let place = Place::new();
    let mut session = opened(&place.scene());
    choose(&mut session, Some("Blue"));
    session.apply(Command::SaveAs(place.project())).unwrap();
    settle(&mut session);
    drop(session);
    let again = opened(&place.project());
    assert_eq!(variant(&again), Some("Blue"));
    drop(again);
    let open =
        |choice| Input::open_variant(&place.project(), &choice, &Default::default(), &progress::Unwatched);
    let chosen = |choice| open(choice).unwrap().scene.variant.clone();
    assert_eq!(chosen(VariantChoice::AsSaved).as_deref(), Some("Blue"));
    assert_eq!(chosen(VariantChoice::Named("Green".into())).as_deref(), Some("Green"));
    assert_eq!(chosen(VariantChoice::Own), None);
    let Err(document::DocumentError::BadInput(error)) = open(VariantChoice::Named("Pink".into())) else {
        panic!("no error")
    };
    assert!(error.contains("varied.glb: no variant is called \"Pink\" (there are \"Blue\""), "{error}");

    // The scene has lost it: the project opens, and says so.
    place.write(&tiny_glb::glb(&tiny_glb::QUADS));
    let input = open(VariantChoice::AsSaved).unwrap();
    assert!(input.scene.variant.is_none());
    let told = input
        .warnings
        .iter()
        .any(|warning| warning.contains("\"Blue\"") && warning.contains("before saving"));
    assert!(told, "{:?}", input.warnings);
}

#[test]
fn a_scene_that_has_changed_meanwhile_is_refused() {
    let place = Place::new();
    let mut session = opened(&place.scene());
    let mut moved = tiny_glb::QUADS;
    moved[1].depth = 2.5;
    for (scene, what) in [
        (tiny_glb::glb(&tiny_glb::QUADS), "no variant is called"),
        (tiny_glb::varied(&moved), "has changed since"),
    ] {
        place.write(&scene);
        session.apply(Command::SetVariant(Some("Blue".into()))).unwrap();
        let start = Instant::now();
        let failure = loop {
            let failed = session.poll().into_iter().find_map(|event| match event {
                Event::Failed(error) => Some(error),
                _ => None,
            });
            if let Some(error) = failed {
                break error;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "it never fails");
            std::thread::sleep(Duration::from_millis(5));
        };
        assert!(failure.contains("varied.glb: ") && failure.contains(what), "{failure}");
        assert_eq!(variant(&session), None);
    }
    // The file is put back.
    place.write(&tiny_glb::varied(&tiny_glb::QUADS));
    settle(&mut session);
    choose(&mut session, Some("Green"));
    assert_eq!((variant(&session), session.document().unwrap().undo_names().count()), (Some("Green"), 1));
}
