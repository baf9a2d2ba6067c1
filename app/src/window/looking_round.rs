//! The point that runs round the aperture's rim: the picture sways as if one moved one's head behind the lens.

use egui::Context;
use glam::DVec2;
use session::{Command, Session, SessionError};
use std::f64::consts::TAU;

/// Once round, seconds.
const PERIOD_SECONDS: f64 = 4.0;

/// Whether a point runs, and where it is.
#[derive(Default)]
pub struct LookingRound {
    run: Option<Run>,
}

/// A point that runs.
struct Run {
    /// When it was at angle 0, in the window's time.
    since: f64,
    /// Where it was last.
    point: Option<DVec2>,
}

impl LookingRound {
    /// Lets it run, or not.
    pub fn toggle(&mut self, session: &mut Session, context: &Context) -> Result<(), SessionError> {
        if self.run.is_some() {
            return self.stop(session);
        }
        self.run = Some(Run { since: context.input(|input| input.time), point: None });
        Ok(())
    }

    /// The picture shows all of the aperture again.
    pub fn stop(&mut self, session: &mut Session) -> Result<(), SessionError> {
        self.run = None;
        session.apply(Command::LookThrough(None))
    }

    /// Moves it on, as fast as the picture can follow; ends where another point was chosen meanwhile.
    pub fn go_on(&mut self, session: &mut Session, context: &Context) -> Result<(), SessionError> {
        let (Some(run), Some(document)) = (&mut self.run, session.document()) else { return Ok(()) };
        if run.point.is_some() && run.point != session.looked_through() {
            self.run = None;
            return Ok(());
        }
        context.request_repaint();
        let seconds = context.input(|input| input.time) - run.since;
        let point = document.camera.aperture.rim(TAU * seconds / PERIOD_SECONDS);
        run.point = Some(point);
        session.apply(Command::LookThrough(Some(point)))
    }
}
