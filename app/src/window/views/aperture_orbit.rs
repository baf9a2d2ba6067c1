//! An aperture point that orbits along the aperture's rim: the picture sways as if the eye moved behind the
//! lens.

use egui::Context;
use glam::DVec2;
use session::{Command, Session, SessionError};
use std::f64::consts::TAU;

/// Period of an orbit, s.
const PERIOD_SECONDS: f64 = 4.0;

/// The orbit, if it is running.
#[derive(Default)]
pub struct ApertureOrbit {
    orbit: Option<Orbit>,
}

/// State of a running orbit.
struct Orbit {
    /// The window's time at angle 0, s.
    start: f64,
    /// The last aperture point.
    point: Option<DVec2>,
}

impl ApertureOrbit {
    /// Starts or stops the orbit.
    ///
    /// # Errors
    /// The aperture point cannot be set.
    pub fn toggle(&mut self, session: &mut Session, context: &Context) -> Result<(), SessionError> {
        if self.orbit.is_some() {
            return self.stop(session);
        }
        self.orbit = Some(Orbit { start: context.input(|input| input.time), point: None });
        Ok(())
    }

    /// Stops the orbit and shows the picture through the whole aperture again.
    ///
    /// # Errors
    /// The aperture point cannot be reset.
    pub fn stop(&mut self, session: &mut Session) -> Result<(), SessionError> {
        self.orbit = None;
        session.apply(Command::SetSubAperture(None))
    }

    /// Advances the orbit at the rate of the window; ends it if another aperture point was chosen in the
    /// meantime.
    ///
    /// # Errors
    /// The aperture point cannot be set.
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
