//! What the palette finds: commands, presets, bookmarks and the scene's cameras, also by what other programs call them.

use super::synonyms::synonyms;
use crate::window::Action;
use crate::window::action::PresetAction;
use crate::window::widgets::keys;
use document::{CameraEdit, Document};
use egui::Context;
use project::{PresetKind, PresetLibrary};
use session::{COMMANDS, Command};

/// Something that can be found and run.
#[derive(Clone, Debug)]
pub struct PaletteEntry {
    /// What it is called, without the kind.
    pub name: String,
    /// Kind and name, as shown.
    pub label: String,
    /// Its key; empty if it has none.
    pub key: String,
    /// What it does.
    pub tooltip: String,
    /// Other words for it.
    pub synonyms: &'static str,
    /// What running it does.
    pub action: Action,
}

impl PaletteEntry {
    fn new(kind: &str, name: &str, tooltip: &str, action: Action) -> Self {
        Self {
            name: name.into(),
            label: format!("{kind}: {name}"),
            key: String::new(),
            tooltip: tooltip.into(),
            synonyms: "",
            action,
        }
    }

    /// How well it matches a query in lower case: 0 is best; `None` if it does not.
    fn rank(&self, query: &str) -> Option<u32> {
        let (name, label) = (self.name.to_lowercase(), self.label.to_lowercase());
        let text = format!("{label} {} {}", self.tooltip.to_lowercase(), self.synonyms);
        let has_all = |text: &str| query.split_whitespace().all(|word| text.contains(word));
        match () {
            _ if name.starts_with(query) || label.starts_with(query) => Some(0),
            _ if has_all(&name) => Some(1),
            _ if has_all(&label) => Some(2),
            _ if has_all(&text) => Some(3),
            _ => None,
        }
    }
}

/// All commands, the presets, and the cameras of the document.
pub fn all_entries(
    context: &Context,
    document: Option<&Document>,
    presets: &PresetLibrary,
) -> Vec<PaletteEntry> {
    let commands = COMMANDS.iter().map(|info| PaletteEntry {
        key: keys::shortcut_text(context, info.id),
        synonyms: synonyms(info.id),
        ..PaletteEntry::new(info.menu.title(), info.name, info.tooltip, info.id.into())
    });
    let mut entries: Vec<_> = commands.collect();
    let Some(document) = document else { return entries };
    for (kind, title, tip) in [
        (PresetKind::Bokeh, "Bokeh", "Use this aperture shape."),
        (PresetKind::Lens, "Lens", "Use this lens with its sensor."),
        (PresetKind::Brush, "Brush", "Use this brush."),
    ] {
        let usable = presets.entries_of_kind(kind).filter_map(|entry| entry.preset.as_ref().ok());
        entries.extend(usable.map(|preset| {
            let action = PresetAction::Use(Box::new(preset.clone())).into();
            PaletteEntry::new(title, &preset.name, tip, action)
        }));
    }
    entries.extend(document.bookmarks().enumerate().map(|(number, bookmark)| {
        let action = Command::GoToBookmark(number).into();
        PaletteEntry::new("Bookmark", &bookmark.name, "Go to this camera.", action)
    }));
    entries.extend(document.scene_cameras().map(|(name, camera)| {
        let action = Command::EditCamera(CameraEdit::Whole(Box::new(camera))).into();
        PaletteEntry::new("Camera", name, "Look through this camera of the scene.", action)
    }));
    entries
}

/// The entries that contain every word of the query, the best matches first.
pub fn matching(entries: Vec<PaletteEntry>, query: &str) -> Vec<PaletteEntry> {
    let query = query.trim().to_lowercase();
    let mut ranked: Vec<_> =
        entries.into_iter().filter_map(|entry| Some((entry.rank(&query)?, entry))).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, entry)| entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use session::CommandId;

    fn found(query: &str) -> Vec<PaletteEntry> {
        let context = Context::default();
        matching(all_entries(&context, None, &PresetLibrary::open(None)), query)
    }

    fn is_command(entry: &PaletteEntry, id: CommandId) -> bool {
        matches!(entry.action, Action::Run(run) if run == id)
    }

    #[test]
    fn finds_by_start_by_words_and_by_what_it_does() {
        assert_eq!(found("").len(), COMMANDS.len());
        assert!(is_command(&found("und")[0], CommandId::Undo));
        assert!(found("focus map export").iter().any(|entry| is_command(entry, CommandId::ExportFocusMap)));
        assert!(found("16-bit").iter().any(|entry| is_command(entry, CommandId::ExportFocusMap)));
        assert!(found("no such thing").is_empty());
    }

    #[test]
    fn finds_by_words_of_other_programs() {
        for (query, id) in [
            ("eyedropper", CommandId::Pick),
            ("bucket", CommandId::FillPart),
            ("iris", CommandId::OpenAperture),
            ("Marquee", CommandId::SelectBox),
            ("uv", CommandId::ShowAtlas),
            ("pull focus", CommandId::RackFocus),
        ] {
            assert!(found(query).iter().any(|entry| is_command(entry, id)), "{query}");
        }
    }

    #[test]
    fn a_kind_and_a_name_find_one() {
        let star = PaletteEntry::new("Bokeh", "Star", "", CommandId::Undo.into());
        let stripes = PaletteEntry::new("Bokeh", "Stripes", "", CommandId::Undo.into());
        let names = |query: &str| -> Vec<_> {
            matching(vec![stripes.clone(), star.clone()], query).into_iter().map(|entry| entry.name).collect()
        };
        assert_eq!(names("bokeh: star"), ["Star"]);
        assert_eq!(names("STAR"), ["Star"]);
        assert_eq!(names("bokeh"), ["Stripes", "Star"]);
    }
}
