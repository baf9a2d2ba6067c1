//! Key maps: keys and mouse buttons of other programs. Each is the command table's keys with some exceptions.

use crate::commands::table::{CommandId, Shortcut};
use serde::{Deserialize, Serialize};

/// The program whose keys and mouse buttons the window uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum KeyMap {
    /// Blender's.
    #[default]
    Blender,
    /// Substance 3D Painter's.
    Substance,
    /// Krita's.
    Krita,
}

impl KeyMap {
    /// All key maps, in menu order.
    pub const ALL: [Self; 3] = [Self::Blender, Self::Substance, Self::Krita];

    /// The name, for menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blender => "Blender",
            Self::Substance => "Substance",
            Self::Krita => "Krita",
        }
    }

    /// The command that selects it.
    pub fn command(self) -> CommandId {
        match self {
            Self::Blender => CommandId::KeysBlender,
            Self::Substance => CommandId::KeysSubstance,
            Self::Krita => CommandId::KeysKrita,
        }
    }

    /// The key of a command; `None` if it has none.
    pub fn shortcut(self, id: CommandId) -> Option<Shortcut> {
        let entry = self.overrides().iter().find(|(command, _)| *command == id);
        entry.map_or(id.info().shortcut, |(_, shortcut)| *shortcut)
    }

    /// Differences from the command table.
    fn overrides(self) -> &'static [(CommandId, Option<Shortcut>)] {
        match self {
            Self::Blender => BLENDER,
            Self::Substance => SUBSTANCE,
            Self::Krita => KRITA,
        }
    }
}

const BLENDER: &[(CommandId, Option<Shortcut>)] = &[
    (CommandId::BrushSize, Shortcut::key("F")),
    (CommandId::BrushStrength, Shortcut::shift("F")),
    (CommandId::BrushHardness, Shortcut::command("F")),
    (CommandId::FrameCursor, Shortcut::alt("F")),
    (CommandId::SelectAll, Shortcut::alt("A")),
];

const SUBSTANCE: &[(CommandId, Option<Shortcut>)] = &[
    (CommandId::Brush, Shortcut::key("1")),
    (CommandId::Erase, Shortcut::key("2")),
    (CommandId::FillPart, Shortcut::key("4")),
    (CommandId::Smooth, Shortcut::key("5")),
    (CommandId::Clone, Shortcut::key("6")),
    (CommandId::PictureActualSize, Shortcut::command("1")),
    (CommandId::Redo, Shortcut::command("Y")),
    (CommandId::Pick, Shortcut::key("P")),
    (CommandId::ShowSurface, Shortcut::key("M")),
    (CommandId::BrushSize, Shortcut::command("F")),
];

const KRITA: &[(CommandId, Option<Shortcut>)] = &[
    (CommandId::FillPart, Shortcut::key("F")),
    (CommandId::FrameCursor, Shortcut::alt("F")),
    (CommandId::Gradient, Shortcut::key("G")),
    (CommandId::Pick, Shortcut::key("P")),
    (CommandId::BrushStronger, Shortcut::key("O")),
    (CommandId::BrushWeaker, Shortcut::key("I")),
    (CommandId::SelectObject, Shortcut::shift("O")),
    (CommandId::PictureFit, Shortcut::key("2")),
    (CommandId::InvertSelection, Shortcut::command_shift("I")),
    (CommandId::AddLayer, Shortcut::key("Insert")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::table::COMMANDS;
    use std::collections::HashMap;

    #[test]
    fn no_key_does_two_things_in_any_map() {
        for map in KeyMap::ALL {
            let mut keys = HashMap::new();
            for info in COMMANDS {
                let Some(key) = map.shortcut(info.id) else { continue };
                let taken = keys.insert(key, info.name);
                assert!(taken.is_none(), "{map:?}: {key} is {} and {}", info.name, taken.unwrap_or_default());
            }
            // Conventional everywhere.
            let expected = [
                (CommandId::Save, "Ctrl+S"),
                (CommandId::Undo, "Ctrl+Z"),
                (CommandId::Palette, "Ctrl+Shift+P"),
            ];
            for (id, key) in expected {
                assert_eq!(map.shortcut(id).map(|key| key.to_string()).as_deref(), Some(key));
            }
        }
    }

    #[test]
    fn a_map_s_own_keys_are_own() {
        for map in KeyMap::ALL {
            for (id, shortcut) in map.overrides() {
                assert_ne!(*shortcut, id.info().shortcut, "{map:?}: {id:?} is the table's own");
            }
        }
        let size = |map: KeyMap| map.shortcut(CommandId::BrushSize);
        assert_ne!(size(KeyMap::Blender), size(KeyMap::Krita));
    }
}
