//! The graphics card goes away while the preview is summed and shown on it: the processor goes on, and nothing is lost.
//!
//! Skipped, loudly, where no adapter is found; `mesa-vulkan-drivers` has one in software, which `./test` installs.

mod tiny_glb;

use document::StrokePoint;
use glam::DVec2;
use graphics_card::{BackendChoice, Gpu};
use lens::{FocusOffset, Picture};
use session::{Command, Event, LivePicture, Session, SessionOptions};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Polls until all work is done; what the user is told.
fn settle(session: &mut Session) -> Vec<String> {
    let start = Instant::now();
    let mut events = session.poll();
    while !session.is_settled() {
        assert!(start.elapsed() < Duration::from_secs(120), "it never settles: {:?}", session.jobs());
        std::thread::sleep(Duration::from_millis(2));
        events.extend(session.poll());
    }
    events.extend(session.poll());
    let told = events.into_iter().filter_map(|event| match event {
        Event::Notice(text) => Some(text),
        Event::Failed(text) => panic!("{text}"),
        _ => None,
    });
    told.collect()
}

fn opened(path: &Path, gpu: Option<Gpu>) -> Session {
    let mut session =
        Session::new(SessionOptions { preview_size: 64, gpu, ..SessionOptions::default() }).unwrap();
    session.apply(Command::Open(path.into())).unwrap();
    settle(&mut session);
    let document = session.document().unwrap();
    let target = FocusOffset::new(1.3, 1.0);
    let brush = focus::Brush { radius: 0.3, target, ..document.brush.clone() };
    session.apply(Command::SetBrush(brush)).unwrap();
    session
}

/// Points of a stroke, one after another.
fn point(session: &Session, k: usize) -> StrokePoint {
    StrokePoint::from_ray(session.picture_ray(DVec2::new(0.55 + 0.04 * k as f64, 0.7)).unwrap())
}

const POINTS: usize = 8;

/// Paints the stroke, `at` a point of it doing something.
fn paint(session: &mut Session, at: usize, something: impl FnOnce(&mut Session)) -> Vec<String> {
    session.apply(Command::BeginStroke(point(session, 0))).unwrap();
    let mut something = Some(something);
    for k in 1..POINTS {
        if k == at {
            something.take().expect("once")(session);
        }
        session.apply(Command::ExtendStroke(point(session, k))).unwrap();
    }
    session.apply(Command::CommitStroke).unwrap();
    settle(session)
}

fn picture(session: &Session) -> Arc<Picture> {
    session.preview().expect("a picture").picture.fetch().expect("its card is there")
}

#[test]
fn twenty_lost_cards_lose_no_stroke() {
    if let Err(why) = Gpu::open(BackendChoice::Gpu, None) {
        eprintln!("SKIPPED: {why}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.glb");
    tiny_glb::write(&path);
    let mut expected = opened(&path, None);
    let blank = picture(&expected);
    paint(&mut expected, 1, |_| ());
    assert!(picture(&expected) != blank);
    for round in 0..20 {
        let gpu = Gpu::open(BackendChoice::Gpu, None).unwrap();
        let mut session = opened(&path, gpu.clone());
        let is_there =
            |session: &Session| matches!(session.preview().unwrap().picture, LivePicture::OnCard(_));
        assert!(is_there(&session) && session.screen().on_card().is_some(), "round {round}");
        assert_eq!(picture(&session), blank, "round {round}");
        let card = gpu.expect("asked for");
        let told = paint(&mut session, 1 + round % (POINTS - 1), |session| {
            // Now and then when the last picture stands, else while the next one is made.
            if round % 3 == 0 {
                settle(session);
            }
            card.destroy();
        });
        let is_of_loss = |text: &&String| text.contains(&format!("{} was lost", card.name()));
        assert_eq!(told.iter().filter(is_of_loss).count(), 1, "round {round}: {told:?}");
        assert!(!is_there(&session) && session.screen().on_card().is_none(), "round {round}");
        assert_eq!(session.document().unwrap().map, expected.document().unwrap().map, "round {round}");
        assert_eq!(picture(&session), picture(&expected), "round {round}");
        session.apply(Command::Undo).unwrap();
        settle(&mut session);
        assert_eq!(picture(&session), blank, "round {round}");
    }
}

#[test]
fn a_picture_that_stood_on_a_lost_card_is_drawn_again() {
    let gpu = match Gpu::open(BackendChoice::Gpu, None) {
        Ok(gpu) => gpu.expect("asked for"),
        Err(why) => return eprintln!("SKIPPED: {why}"),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.glb");
    tiny_glb::write(&path);
    let mut session = opened(&path, Some(gpu.clone()));
    let before = picture(&session);
    gpu.destroy();
    let told = settle(&mut session);
    assert!(matches!(session.preview().unwrap().picture, LivePicture::InMemory(_)));
    assert_eq!(picture(&session), before);
    assert_eq!(told.iter().filter(|text| text.contains("was lost")).count(), 1, "{told:?}");
}
