//! A recording played in the window as if it were painted now, and how long every point of a stroke takes to be seen.
//!
//! The points of a stroke fall due at the rate of a pen, whether or not the window has time for them. What is measured:
//! the time from when the window is told of a point, as of any event, until the pixels of a picture that shows it stand
//! finished, ready for the screen; the same from when the point fell due, waiting for the window included; and the time
//! from one frame on the screen to the next.

use project::{LinearPicture, RecordedStep, compare};
use serde_json::{Value, json};
use session::{Command, Session, SessionError, StrokePoint};
use std::time::{Duration, Instant};

/// Time between two points: a tablet's 125 reports a second.
const POINT_EVERY: Duration = Duration::from_millis(8);

/// A recording that is being played.
pub struct Player {
    steps: Vec<RecordedStep>,
    next: usize,
    stroke: Option<Played>,
    /// What was painted and is not in any finished picture yet.
    unseen: Vec<Painted>,
    /// Of every point, from when the window was told until its picture stood finished.
    pictures: Vec<Duration>,
    /// The same, from when the point fell due.
    since_due: Vec<Duration>,
    /// From one frame of the window to the next, while strokes were painted.
    frames: Vec<Duration>,
    last_frame: Option<Instant>,
}

/// A point that was painted.
struct Painted {
    /// How many changes the map holds with it.
    serial: u64,
    due: Instant,
    told: Instant,
}

/// The stroke that is being played.
struct Played {
    step: usize,
    next_point: usize,
    began: Instant,
}

impl Player {
    /// Plays steps from the first on.
    pub fn new(steps: Vec<RecordedStep>) -> Self {
        Self {
            steps,
            next: 0,
            stroke: None,
            unseen: Vec::new(),
            pictures: Vec::new(),
            since_due: Vec::new(),
            frames: Vec::new(),
            last_frame: None,
        }
    }

    /// Does what is due. False when all is done and seen.
    pub fn play(&mut self, session: &mut Session) -> Result<bool, SessionError> {
        if session.document().is_none() {
            return Ok(true);
        }
        self.look(session);
        let now = Instant::now();
        if self.stroke.is_some() {
            self.frames.extend(self.last_frame.map(|last| now - last));
            self.last_frame = Some(now);
            self.paint_due(session, now)?;
            return Ok(true);
        }
        self.last_frame = None;
        // Every step begins with a picture that is up to date.
        if !session.is_settled() {
            return Ok(true);
        }
        let Some(step) = self.steps.get(self.next) else { return Ok(false) };
        self.next += 1;
        match step {
            RecordedStep::Stroke(stroke) if !stroke.points.is_empty() => {
                let Some(document) = session.document() else { return Ok(true) };
                let layers = document.layers.layers();
                let layer = layers.iter().position(|layer| layer.name == stroke.layer);
                let Some(layer) = layer else {
                    let what = format!("step {}: no layer is called \"{}\"", self.next, stroke.layer);
                    return Err(SessionError::BadInput(what));
                };
                session.apply(Command::ActivateLayer(layer))?;
                session.apply(Command::SetBrush(stroke.brush.clone()))?;
                self.stroke = Some(Played { step: self.next - 1, next_point: 0, began: now });
            }
            step => session.apply(Command::Do(step.clone()))?,
        }
        Ok(true)
    }

    /// Paints the points of the stroke that have fallen due.
    fn paint_due(&mut self, session: &mut Session, now: Instant) -> Result<(), SessionError> {
        let Some(played) = &mut self.stroke else { return Ok(()) };
        let RecordedStep::Stroke(stroke) = &self.steps[played.step] else { return Ok(()) };
        while let Some(point) = stroke.points.get(played.next_point) {
            let due = played.began + POINT_EVERY * played.next_point as u32;
            if due > now {
                return Ok(());
            }
            let point = StrokePoint::recorded(&stroke.view, point);
            let before = session.map_serial();
            session.apply(match played.next_point {
                0 => Command::BeginStroke(point),
                _ => Command::ExtendStroke(point),
            })?;
            played.next_point += 1;
            // A point between two dabs changes nothing.
            if session.map_serial() != before {
                self.unseen.push(Painted { serial: session.map_serial(), due, told: now });
            }
        }
        self.stroke = None;
        session.apply(Command::CommitStroke)
    }

    /// Notes which points have come to be seen.
    fn look(&mut self, session: &Session) {
        for &(serial, finished) in session.finished_pictures() {
            let seen = self.unseen.partition_point(|painted| painted.serial <= serial);
            for painted in self.unseen.drain(..seen) {
                self.pictures.push(finished.saturating_duration_since(painted.told));
                self.since_due.push(finished.saturating_duration_since(painted.due));
            }
        }
    }

    /// What was measured, and how far the picture is from the exact one (which is rendered now, and takes its time).
    pub fn trace(&self, session: &Session) -> Result<Value, SessionError> {
        let (Some(document), Some(preview)) = (session.document(), session.preview()) else {
            return Err(SessionError::NothingOpen);
        };
        let stage = &document.stage;
        let map = std::sync::Arc::new(document.map.clone());
        let focus = focus::Focus::painted(stage.scene.clone(), stage.atlas.clone(), map);
        let options = session::RenderOptions::default();
        let nobody = progress::Unwatched;
        let exact = session::render(&stage.tracer, &preview.camera, &focus, &options, &nobody)?.picture;
        let [shown, exact] =
            [&*preview.picture, &exact].map(|picture| LinearPicture::of(picture, document.exposure));
        let error = compare(&shown, &exact)?;
        Ok(json!({
            "steps": self.steps.len(),
            "picture": { "width": preview.camera.width, "height": preview.camera.height },
            "event_to_picture_ms": statistics(&self.pictures),
            "due_to_picture_ms": statistics(&self.since_due),
            "frame_ms": statistics(&self.frames),
            "error_against_exact": { "psnr": error.psnr, "signed_mean_error": error.signed_mean_error },
        }))
    }
}

/// Median, 99th percentile and greatest, ms.
fn statistics(durations: &[Duration]) -> Value {
    let mut ms: Vec<f64> = durations.iter().map(|duration| duration.as_secs_f64() * 1e3).collect();
    ms.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let last = ms.len().checked_sub(1)?;
        Some(ms[(share * last as f64).ceil() as usize])
    };
    json!({ "count": ms.len(), "median": at(0.5), "p99": at(0.99), "max": at(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_sorted_times() {
        let times: Vec<_> = (0..101).rev().map(Duration::from_millis).collect();
        let found = statistics(&times);
        assert_eq!(found, json!({ "count": 101, "median": 50.0, "p99": 99.0, "max": 100.0 }));
        assert_eq!(statistics(&[])["median"], Value::Null);
    }
}
