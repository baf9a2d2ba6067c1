//! Maps keys to commands with the command table and the chosen key map.
//!
//! The key map is stored in egui's context, so that every tooltip and menu can show the key of its command.

use egui::{Context, Id, Key, KeyboardShortcut, Modifiers};
use session::{COMMANDS, CommandId, KeyMap, Shortcut};

/// Sets the active key map.
pub fn set_key_map(context: &Context, map: KeyMap) {
    context.data_mut(|data| data.insert_temp(Id::unique("key map"), map));
}

/// The active key map.
pub fn key_map(context: &Context) -> KeyMap {
    context.data(|data| data.get_temp(Id::unique("key map"))).unwrap_or_default()
}

/// The key of a command as text; empty if it has none.
pub fn shortcut_text(context: &Context, id: CommandId) -> String {
    key_map(context).shortcut(id).map(|key| key.to_string()).unwrap_or_default()
}

/// The tooltip of a command, with its key.
pub fn command_tooltip(context: &Context, id: CommandId) -> String {
    let key = key_map(context).shortcut(id).map(|key| format!(" ({key})")).unwrap_or_default();
    format!("{}{key}", id.info().tooltip)
}

/// Converts a shortcut of the command table to egui's type.
fn keyboard_shortcut(shortcut: Shortcut) -> Option<KeyboardShortcut> {
    let mut modifiers = Modifiers::NONE;
    modifiers.command = shortcut.command;
    modifiers.shift = shortcut.shift;
    modifiers.alt = shortcut.alt;
    Some(KeyboardShortcut::new(modifiers, Key::from_name(shortcut.key)?))
}

/// The commands whose keys were pressed. While a text field has the focus, keys without Ctrl go to it.
pub fn pressed_commands(context: &Context) -> Vec<CommandId> {
    let (typing, map) = (context.text_edit_focused(), key_map(context));
    let mut commands = Vec::new();
    // Those with more modifiers first: Ctrl+Shift+Z is not Ctrl+Z.
    let mut rows: Vec<_> =
        COMMANDS.iter().filter_map(|info| Some((info.id, map.shortcut(info.id)?))).collect();
    rows.sort_by_key(|(_, key)| std::cmp::Reverse(key.command as u8 + key.shift as u8 + key.alt as u8));
    context.input_mut(|input| {
        for (id, shortcut) in rows {
            let Some(key) = keyboard_shortcut(shortcut) else { continue };
            if typing && (!shortcut.command || is_text_editing_key(key.logical_key)) {
                continue;
            }
            if input.consume_shortcut(&key) {
                commands.push(id);
            }
        }
    });
    commands
}

/// Whether a text field has its own use for Ctrl and this key.
fn is_text_editing_key(key: Key) -> bool {
    matches!(key, Key::A | Key::C | Key::V | Key::X | Key::Z | Key::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_every_map_exists() {
        for map in KeyMap::ALL {
            for info in COMMANDS {
                if let Some(shortcut) = map.shortcut(info.id) {
                    assert!(keyboard_shortcut(shortcut).is_some(), "{}: no key {}", info.name, shortcut.key);
                }
            }
        }
    }
}
