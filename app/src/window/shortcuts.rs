//! Keys to commands, by the command table.

use egui::{Context, Key, KeyboardShortcut, Modifiers};
use session::{COMMANDS, CommandId, Shortcut};

/// egui's form of a shortcut of the table.
fn keyboard_shortcut(shortcut: Shortcut) -> Option<KeyboardShortcut> {
    let mut modifiers = Modifiers::NONE;
    modifiers.command = shortcut.command;
    modifiers.shift = shortcut.shift;
    modifiers.alt = shortcut.alt;
    Some(KeyboardShortcut::new(modifiers, Key::from_name(shortcut.key)?))
}

/// The command whose key was pressed, if any. Keys without Ctrl belong to a text field while one is typed into.
pub fn pressed(context: &Context) -> Vec<CommandId> {
    let typing = context.text_edit_focused();
    let mut found = Vec::new();
    // Those with more modifiers first: Ctrl+Shift+Z is not Ctrl+Z.
    let mut rows: Vec<_> = COMMANDS.iter().filter_map(|info| Some((info.id, info.shortcut?))).collect();
    rows.sort_by_key(|(_, key)| std::cmp::Reverse(key.command as u8 + key.shift as u8 + key.alt as u8));
    context.input_mut(|input| {
        for (id, shortcut) in rows {
            let Some(key) = keyboard_shortcut(shortcut) else { continue };
            if typing && (!shortcut.command || belongs_to_text(key.logical_key)) {
                continue;
            }
            if input.consume_shortcut(&key) {
                found.push(id);
            }
        }
    });
    found
}

/// Whether a text field has its own use for Ctrl and this key.
fn belongs_to_text(key: Key) -> bool {
    matches!(key, Key::A | Key::C | Key::V | Key::X | Key::Z | Key::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_exists() {
        for info in COMMANDS {
            if let Some(shortcut) = info.shortcut {
                assert!(keyboard_shortcut(shortcut).is_some(), "{}: {} is no key", info.name, shortcut.key);
            }
        }
    }
}
