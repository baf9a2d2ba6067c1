//! A session at work: opens a file, paints a stroke, waits, looks.

use document::StrokePoint;
use glam::DVec2;
use lens::{FocusOffset, Picture};
use session::{Command, Event, PreviewKind, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

/// Polls until all work is done; what happened.
pub fn settle(session: &mut Session) -> Vec<Event> {
    let start = Instant::now();
    let mut events = session.poll();
    while !session.is_settled() {
        assert!(
            start.elapsed() < Duration::from_secs(300),
            "the session never settles: {:?}",
            session.jobs()
        );
        std::thread::sleep(Duration::from_millis(5));
        events.extend(session.poll());
    }
    events.extend(session.poll());
    let failed = events.iter().find(|event| matches!(event, Event::Failed(_)));
    assert!(failed.is_none(), "{failed:?}");
    events
}

/// Opens a file, and waits for its picture.
pub fn opened(path: &Path) -> Session {
    opened_with(path, SessionOptions::default())
}

/// The same, with options; pictures are small.
pub fn opened_with(path: &Path, options: SessionOptions) -> Session {
    let options = SessionOptions { preview_size: 240, ..options };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(path.into())).unwrap();
    let events = settle(&mut session);
    assert!(events.contains(&Event::Opened));
    session
}

/// The picture as it is.
pub fn picture(session: &Session) -> Picture {
    let preview = session.preview().expect("a preview");
    assert_ne!(preview.kind, PreviewKind::Pinhole);
    (*preview.picture.fetch().unwrap()).clone()
}

/// A point of the picture on the wall, away from card and dot.
pub const ON_WALL: DVec2 = DVec2::new(0.75, 0.75);

/// A stroke over the wall, not yet ended.
pub fn stroke(session: &mut Session) {
    let brush = focus::Brush {
        radius: 0.3,
        target: FocusOffset::new(1.3, 1.0),
        ..session.document().unwrap().brush.clone()
    };
    session.apply(Command::SetBrush(brush)).unwrap();
    let ray = |session: &Session, x: f64| session.picture_ray(DVec2::new(x, ON_WALL.y)).unwrap();
    let begin = StrokePoint::from_ray(ray(session, 0.6));
    session.apply(Command::BeginStroke(begin)).unwrap();
    for k in 1..=4 {
        let point = StrokePoint::from_ray(ray(session, 0.6 + 0.05 * k as f64));
        session.apply(Command::ExtendStroke(point)).unwrap();
    }
}

/// The picture as a view that is painted in.
pub fn shot_view(session: &Session) -> focus::ViewFrame {
    focus::ViewFrame::from_camera(&session.document().unwrap().camera)
}
