//! Time in the window: keys are set, and lens and layers are shown as they say.
//!
//! To go to a time is to give the camera and the layers the values that their keys have then, as animation programs do. That is no
//! step of undo: what the keys say is kept in the keys. The scene itself is shown at rest; frames show it in motion
//! ([`render::render_frames`]).

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::state::Session;
use document::{KeyedLens, SurfaceHit};
use focus::{Ease, FocusTarget, Key, LensMotion};
use scene::SurfacePoint;

impl Session {
    pub(super) fn go_to_time(&mut self, seconds: f64) -> Result<(), SessionError> {
        if !seconds.is_finite() {
            return Err(SessionError::BadInput(format!("{seconds} s is not a valid time")));
        }
        self.document_mut()?.seconds = seconds;
        self.show_lens_keys()?;
        self.show_layer_keys()
    }

    /// Gives the lens what its keys say now.
    pub(super) fn show_lens_keys(&mut self) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let (seconds, scene) = (document.seconds, document.stage.scene.clone());
        let position = |point: SurfacePoint| point.checked_position(&scene);
        let camera = document.lens_motion.camera_at(seconds, &document.camera, &position);
        let is_moved = camera != document.camera && camera.validate().is_ok();
        if is_moved {
            document.camera = camera;
            self.events.push(Event::CameraChanged);
            self.show_camera();
            self.update_adjustment_layers()?;
        }
        Ok(())
    }

    /// Gives the layers what their keys say now.
    fn show_layer_keys(&mut self) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let seconds = document.seconds;
        let mut is_faded = false;
        for index in 0..document.layers.layers().len() {
            let Some(layer) = document.layers.layer_mut(index) else { continue };
            let Some(opacity) = layer.motion.opacity.span_at(seconds).map(|around| around.interpolate())
            else {
                continue;
            };
            is_faded |= layer.opacity != opacity;
            layer.opacity = opacity;
        }
        if is_faded {
            self.events.push(Event::LayersChanged);
            self.show_layers(None)?;
        }
        Ok(())
    }

    pub(super) fn set_lens_motion(&mut self, name: &str, motion: LensMotion) -> Result<(), SessionError> {
        if !motion.is_valid() {
            let what = "keys of the lens: times must ascend; distances and f-numbers must be above 0";
            return Err(SessionError::BadInput(what.into()));
        }
        let document = self.document_mut()?;
        if document.lens_motion == motion {
            return Ok(());
        }
        let (seconds, camera) = (document.seconds, document.camera.clone());
        let before = std::mem::replace(&mut document.lens_motion, motion.clone());
        let before = KeyedLens { motion: before, camera };
        self.show_lens_keys()?;
        let document = self.document_mut()?;
        let after = KeyedLens { motion, camera: document.camera.clone() };
        document.undo.push_lens_motion(name, seconds, before, after);
        document.revision += 1;
        Ok(())
    }

    pub(super) fn rack(
        &mut self,
        points: [SurfaceHit; 2],
        seconds: [f64; 2],
        ease: Ease,
    ) -> Result<(), SessionError> {
        if seconds[0] >= seconds[1] || !seconds.iter().all(|seconds| seconds.is_finite()) {
            return Err(SessionError::BadInput(
                "a rack focus must last longer than 0 s (choose another duration)".into(),
            ));
        }
        let mut motion = self.document_mut()?.lens_motion.clone();
        for (hit, seconds) in points.into_iter().zip(seconds) {
            if !motion.focus.insert(Key { seconds, value: FocusTarget::Point(hit.point), ease }) {
                return Err(SessionError::BadInput("the lens has too many keys (remove some)".into()));
            }
        }
        self.set_lens_motion("Rack focus", motion)
    }
}
