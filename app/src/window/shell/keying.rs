//! Keys of the timeline, as commands set them and clicks.

use super::Shell;
use focus::{FocusTarget, Key, Keys, LayerEdit};
use session::{Command, SurfaceHit};

impl Shell {
    /// Keeps focus distance and f-number for this time.
    pub(super) fn key_lens(&mut self) {
        let Some(document) = self.session.document() else { return };
        let (seconds, ease) = (document.seconds, self.settings.tools.rack.ease);
        let mut motion = document.lens_motion.clone();
        let value = FocusTarget::Distance(document.camera.focus_distance);
        let mut has_room = motion.focus.insert(Key { seconds, value, ease });
        let number = document.camera.f_number();
        if number > 0.0 && number.is_finite() {
            has_room &= motion.f_number.insert(Key { seconds, value: number, ease });
        }
        match has_room {
            true => self.apply(Command::SetLensMotion("Key lens", motion)),
            false => self.toasts.error(too_many_keys_message()),
        }
    }

    /// Keeps the opacity of the layer that is painted on for this time.
    pub(super) fn key_layer(&mut self) {
        let Some(document) = self.session.document() else { return };
        let (seconds, ease) = (document.seconds, self.settings.tools.rack.ease);
        let layer = document.layers.active();
        let mut motion = layer.motion.clone();
        let value = layer.opacity;
        match motion.opacity.insert(Key { seconds, value, ease }) {
            true => {
                self.apply(Command::EditLayers(LayerEdit::Motion(document.layers.active_index(), motion)))
            }
            false => self.toasts.error(too_many_keys_message()),
        }
    }

    /// Takes the keys of the lens at this time away.
    pub(super) fn remove_keys(&mut self) {
        let Some(document) = self.session.document() else { return };
        let mut motion = document.lens_motion.clone();
        motion.focus.remove(document.seconds);
        motion.f_number.remove(document.seconds);
        self.apply(Command::SetLensMotion("Remove lens keys", motion));
    }

    /// A click of the rack focus: the first point, or the second, at which the timeline stands afterwards.
    pub(super) fn rack_point(&mut self, hit: SurfaceHit) {
        let Some(document) = self.session.document() else { return };
        let Some(from) = self.rack_from.take() else {
            self.rack_from = Some(hit);
            self.toasts.notice("Rack focus: now click what becomes sharp.");
            return;
        };
        let (start, rack) = (document.seconds, &self.settings.tools.rack);
        let (end, ease) = (start + rack.seconds, rack.ease);
        self.apply(Command::RackFocus { points: [from, hit], seconds: [start, end], ease });
        self.apply(Command::GoToTime(end));
    }
}

fn too_many_keys_message() -> String {
    format!("There are {} keys already: take some away first.", Keys::<f64>::MAX_KEYS)
}
