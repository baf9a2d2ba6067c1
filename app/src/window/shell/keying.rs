//! Sets and removes keys of the timeline.

use super::Shell;
use document::SurfaceHit;
use focus::{FocusTarget, Key, KeyedCharacter, Keys, LayerEdit};
use session::Command;

impl Shell {
    /// Sets keys for focus distance and f-number at the current time, and for the lens's character if it has one, or keys of one.
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
        let character = document.camera.character;
        if !character.is_neutral() || !motion.character.is_empty() {
            has_room &= motion.character.insert(Key { seconds, value: KeyedCharacter(character), ease });
        }
        match has_room {
            true => self.apply(Command::SetLensMotion("Key lens", motion)),
            false => self.toasts.error(too_many_keys_message()),
        }
    }

    /// Sets a key for the opacity of the active layer at the current time.
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

    /// Removes the keys of the lens at the current time.
    pub(super) fn remove_keys(&mut self) {
        let Some(document) = self.session.document() else { return };
        let mut motion = document.lens_motion.clone();
        motion.focus.remove(document.seconds);
        motion.f_number.remove(document.seconds);
        motion.character.remove(document.seconds);
        self.apply(Command::SetLensMotion("Remove lens keys", motion));
    }

    /// Handles a click of the rack focus tool: the first point, or the second, after which the time moves to
    /// its key.
    pub(super) fn rack_point(&mut self, hit: SurfaceHit) {
        let Some(document) = self.session.document() else { return };
        let Some(from) = self.rack_from.take() else {
            self.rack_from = Some(hit);
            self.toasts.notice("Rack focus: now click what should become sharp.");
            return;
        };
        let (start, rack) = (document.seconds, &self.settings.tools.rack);
        let (end, ease) = (start + rack.seconds, rack.ease);
        self.apply(Command::RackFocus { points: [from, hit], seconds: [start, end], ease });
        self.apply(Command::GoToTime(end));
    }
}

fn too_many_keys_message() -> String {
    format!("There are already {} keys: remove some first.", Keys::<f64>::MAX_KEYS)
}
