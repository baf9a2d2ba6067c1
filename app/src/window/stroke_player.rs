//! Plays a recording in the window in real time and measures the latency of every stroke point.
//!
//! The points of a stroke fall due at the rate of a pen, whether or not the window keeps up. Measured are: the
//! time from the event of a point until the pixels of a picture that shows it are ready for the screen, with
//! its breakdown; the time from when the point fell due, which includes waiting for the window; and the time
//! between frames.

use document::StrokePoint;
use numerics::upper_quantile_of_sorted;
use project::{LinearPicture, RecordedStep, compare};
use serde_json::{Value, json};
use session::{Command, PictureTimes, Session, SessionError};
use std::time::{Duration, Instant};

/// Time between two points: a tablet's 125 reports per second.
const POINT_INTERVAL: Duration = Duration::from_millis(8);

/// Number of the slowest points in the report.
const REPORTED_SLOWEST: usize = 12;

/// A recording that is being played.
pub struct Player {
    steps: Vec<RecordedStep>,
    next: usize,
    stroke: Option<PlayingStroke>,
    /// Points painted but not yet in a finished picture.
    pending: Vec<PaintedPoint>,
    /// Latencies of the points in finished pictures.
    finished: Vec<PointLatency>,
    /// Times between frames while strokes were painted.
    frames: Vec<Duration>,
    last_frame: Option<Instant>,
}

/// A painted point.
struct PaintedPoint {
    /// Serial number of the map with this point.
    serial: u64,
    due_at: Instant,
    event_at: Instant,
    /// When the map contained it and the preview was notified.
    painted_at: Instant,
}

/// The steps between the event of a point and its picture: painting the map, including earlier points of the
/// same frame; waiting for the preview to finish earlier work; updating the sums; resolving the picture and the
/// screen's pixels.
const STEP_NAMES: [&str; 4] = ["painting", "waiting", "summing", "showing"];

/// The latency of a point that appeared in a picture.
struct PointLatency {
    /// Index among the points that changed the map.
    point: usize,
    /// From when it fell due until its event.
    lateness: Duration,
    /// Duration of each of [`STEP_NAMES`].
    steps: [Duration; 4],
}

impl PointLatency {
    fn new(point: usize, painted: &PaintedPoint, times: &PictureTimes) -> Self {
        let begun = times.begun.max(painted.painted_at);
        let instants = [painted.event_at, painted.painted_at, begun, times.summed, times.finished];
        Self {
            point,
            lateness: painted.event_at.saturating_duration_since(painted.due_at),
            steps: std::array::from_fn(|k| instants[k + 1].saturating_duration_since(instants[k])),
        }
    }

    /// From the event until the picture was finished.
    fn event_to_picture(&self) -> Duration {
        self.steps.iter().sum()
    }
}

/// The stroke being played.
struct PlayingStroke {
    step: usize,
    next_point: usize,
    began: Instant,
}

impl Player {
    /// A player at the start of the steps.
    pub fn new(steps: Vec<RecordedStep>) -> Self {
        Self {
            steps,
            next: 0,
            stroke: None,
            pending: Vec::new(),
            finished: Vec::new(),
            frames: Vec::new(),
            last_frame: None,
        }
    }

    /// Performs the steps that are due. Returns false when all are done and visible.
    ///
    /// # Errors
    /// A step does not apply to the document.
    pub fn play(&mut self, session: &mut Session) -> Result<bool, SessionError> {
        if session.document().is_none() {
            return Ok(true);
        }
        self.collect_latencies(session);
        let now = Instant::now();
        if self.stroke.is_some() {
            self.frames.extend(self.last_frame.map(|last| now - last));
            self.last_frame = Some(now);
            self.paint_due(session, now)?;
            return Ok(true);
        }
        self.last_frame = None;
        // Every step starts from an up-to-date picture.
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
                self.stroke = Some(PlayingStroke { step: self.next - 1, next_point: 0, began: now });
            }
            step => session.apply(Command::ApplyRecordedStep(step.clone()))?,
        }
        Ok(true)
    }

    /// Paints the points of the stroke that are due.
    fn paint_due(&mut self, session: &mut Session, now: Instant) -> Result<(), SessionError> {
        let Some(played) = &mut self.stroke else { return Ok(()) };
        let RecordedStep::Stroke(stroke) = &self.steps[played.step] else { return Ok(()) };
        while let Some(point) = stroke.points.get(played.next_point) {
            let due_at = played.began + POINT_INTERVAL * played.next_point as u32;
            if due_at > now {
                return Ok(());
            }
            let point = StrokePoint::from_recorded(&stroke.view, point);
            let before = session.map_serial();
            session.apply(match played.next_point {
                0 => Command::BeginStroke(point),
                _ => Command::ExtendStroke(point),
            })?;
            played.next_point += 1;
            // A point between two dabs does not change the map.
            if session.map_serial() != before {
                let painted_at = Instant::now();
                self.pending.push(PaintedPoint {
                    serial: session.map_serial(),
                    due_at,
                    event_at: now,
                    painted_at,
                });
            }
        }
        self.stroke = None;
        session.apply(Command::CommitStroke)
    }

    /// Collects the latencies of the points in newly finished pictures.
    fn collect_latencies(&mut self, session: &Session) {
        for times in session.finished_pictures() {
            let finished_count = self.pending.partition_point(|painted| painted.serial <= times.map_serial);
            for painted in self.pending.drain(..finished_count) {
                self.finished.push(PointLatency::new(self.finished.len(), &painted, times));
            }
        }
    }

    /// The measurements, and the error against the exact picture, which is rendered by this call.
    ///
    /// # Errors
    /// The exact picture cannot be rendered.
    pub fn latency_report(&self, session: &Session) -> Result<Value, SessionError> {
        let (Some(document), Some(preview)) = (session.document(), session.preview()) else {
            return Err(SessionError::NothingOpen);
        };
        let exact = session.exact_picture()?;
        let what = "the graphics card that held the picture was lost (try again)";
        let shown = preview.picture.fetch().ok_or(SessionError::TryAgain(what.into()))?;
        let [shown, exact] =
            [&*shown, &exact].map(|picture| LinearPicture::from_picture(picture, document.exposure));
        let error = compare(&shown, &exact)?;
        let all = |of: fn(&PointLatency) -> Duration| statistics(self.finished.iter().map(of));
        let of_step = |k: usize| statistics(self.finished.iter().map(|latency| latency.steps[k]));
        let of_steps: serde_json::Map<_, _> =
            (STEP_NAMES.iter().enumerate()).map(|(k, name)| (name.to_string(), of_step(k))).collect();
        Ok(json!({
            "steps": self.steps.len(),
            "picture": { "width": preview.camera.width, "height": preview.camera.height },
            "event_to_picture_ms": all(PointLatency::event_to_picture),
            "of_which_ms": of_steps,
            "slowest": self.slowest(),
            "due_to_picture_ms": all(|latency| latency.lateness + latency.event_to_picture()),
            "frame_ms": statistics(self.frames.iter().copied()),
            "error_against_exact": { "psnr": error.psnr, "signed_mean_error": error.signed_mean_error },
        }))
    }

    /// The slowest points with the durations of their steps, ms.
    fn slowest(&self) -> Vec<Value> {
        let mut slowest: Vec<&PointLatency> = self.finished.iter().collect();
        slowest.sort_by_key(|latency| std::cmp::Reverse(latency.event_to_picture()));
        let entry = |latency: &&PointLatency| {
            let steps: Vec<f64> = latency.steps.iter().copied().map(milliseconds).collect();
            json!({ "point": latency.point, "ms": milliseconds(latency.event_to_picture()), "steps_ms": steps })
        };
        slowest.iter().take(REPORTED_SLOWEST).map(entry).collect()
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// Count, median, 99th percentile and maximum, ms.
fn statistics(durations: impl Iterator<Item = Duration>) -> Value {
    let mut ms: Vec<f64> = durations.map(milliseconds).collect();
    ms.sort_by(f64::total_cmp);
    let at = |share: f64| upper_quantile_of_sorted(&ms, share);
    json!({ "count": ms.len(), "median": at(0.5), "p99": at(0.99), "max": at(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_sorted_times() {
        let times: Vec<_> = (0..101).rev().map(Duration::from_millis).collect();
        let summary = statistics(times.into_iter());
        assert_eq!(summary, json!({ "count": 101, "median": 50.0, "p99": 99.0, "max": 100.0 }));
        assert_eq!(statistics(std::iter::empty())["median"], Value::Null);
    }
}
