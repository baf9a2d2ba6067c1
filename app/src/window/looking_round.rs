//! The point that runs round the aperture's rim: the picture sways as if one moved one's head behind the lens.

use egui::Context;
use glam::DVec2;
use session::{Command, Session, SessionError};
use std::f64::consts::TAU;

/// Once round, seconds.
const PERIOD_SECONDS: f64 = 4.0;

/// Whether a point runs, and where it is.
#[derive(Default)]
pub struct ApertureOrbit {
    orbit: Option<Orbit>,
}

/// A point that runs.
struct Orbit {
    /// When it was at angle 0, in the window's time.
    start: f64,
    /// Where it was last.
    point: Option<DVec2>,
}

impl ApertureOrbit {
    /// Lets it run, or not.
    pub fn toggle(&mut self, session: &mut Session, context: &Context) -> Result<(), SessionError> {
        if self.orbit.is_some() {
            return self.stop(session);
        }
        self.orbit = Some(Orbit { start: context.input(|input| input.time), point: None });
        Ok(())
    }

    /// The picture shows all of the aperture again.
    pub fn stop(&mut self, session: &mut Session) -> Result<(), SessionError> {
        self.orbit = None;
        session.apply(Command::SetSubAperture(None))
    }

    /// Moves it on, as fast as the picture can follow; ends where another point was chosen meanwhile.
    pub fn advance(&mut self, session: &mut Session, context: &Context) -> Result<(), SessionError> {
        let (Some(orbit), Some(document)) = (&mut self.orbit, session.document()) else { return Ok(()) };
        if orbit.point.is_some() && orbit.point != session.sub_aperture_point() {
            self.orbit = None;
            return Ok(());
        }
        context.request_repaint();
        let seconds = context.input(|input| input.time) - orbit.start;
        let point = document.camera.aperture.rim(TAU * seconds / PERIOD_SECONDS);
        orbit.point = Some(point);
        session.apply(Command::SetSubAperture(Some(point)))
    }
}
