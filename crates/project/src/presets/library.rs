//! All available presets: those that come with the program, and the user's own in a folder.

use super::bundled::bundled_presets;
use super::preset::{Preset, PresetKind};
use crate::ProjectError;
use std::path::{Path, PathBuf};

/// Subfolder for deleted presets.
const DELETED_FOLDER: &str = "deleted";

/// A preset of the library.
#[derive(Clone, Debug, PartialEq)]
pub struct LibraryEntry {
    /// Its kind.
    pub kind: PresetKind,
    /// The user's file; `None` for one that comes with the program.
    pub file: Option<PathBuf>,
    /// The preset, or why its file cannot be read.
    pub preset: Result<Preset, String>,
}

impl LibraryEntry {
    /// Its name, or that of a file that cannot be read.
    pub fn name(&self) -> String {
        match &self.preset {
            Ok(preset) => preset.name.clone(),
            Err(_) => stem(self.file.as_deref().unwrap_or(Path::new(""))),
        }
    }
}

/// The presets of a user: a folder with a subfolder for each kind, and in it one file per preset.
#[derive(Clone, Debug)]
pub struct PresetLibrary {
    folder: Option<PathBuf>,
    entries: Vec<LibraryEntry>,
}

impl PresetLibrary {
    /// The default folder for this user's presets; `None` if the system has no place for settings.
    pub fn default_folder() -> Option<PathBuf> {
        let folders = directories::ProjectDirs::from("", "", "focus-brush")?;
        Some(folders.config_dir().join("presets"))
    }

    /// Opens the library. A folder that does not exist counts as empty.
    pub fn open(folder: Option<PathBuf>) -> Self {
        let mut shelf = Self { folder, entries: Vec::new() };
        shelf.reload();
        shelf
    }

    /// Reads the user's presets from their folder again.
    pub fn reload(&mut self) {
        let files_of_kind = |kind| self.files(kind).into_iter().map(move |file| (kind, file));
        let user_files: Vec<_> = PresetKind::ALL.into_iter().flat_map(files_of_kind).collect();
        let shipped = bundled_presets().map(|preset| LibraryEntry {
            kind: preset.kind(),
            file: None,
            preset: Ok(preset),
        });
        let user_entries = user_files.into_iter().map(|(kind, file)| {
            let preset = match Preset::read(&file) {
                Ok(preset) if preset.kind() == kind => Ok(preset),
                Ok(preset) => {
                    let (is, file) = (preset.kind().name(), file.display());
                    Err(format!("{file}: is a preset of {is} (move it to the folder \"{is}\")"))
                }
                Err(error) => Err(error.to_string()),
            };
            LibraryEntry { kind, file: Some(file), preset }
        });
        self.entries = shipped.chain(user_entries).collect();
    }

    /// The files of one kind, sorted by name.
    fn files(&self, kind: PresetKind) -> Vec<PathBuf> {
        let Some(folder) = &self.folder else { return Vec::new() };
        let Ok(listing) = std::fs::read_dir(folder.join(kind.name())) else { return Vec::new() };
        let is_preset = |file: &PathBuf| file.extension().is_some_and(|extension| extension == "json");
        let mut files: Vec<_> =
            listing.filter_map(|entry| Some(entry.ok()?.path())).filter(is_preset).collect();
        files.sort();
        files
    }

    /// All presets of one kind: first those that come with the program.
    pub fn entries_of_kind(&self, kind: PresetKind) -> impl Iterator<Item = &LibraryEntry> {
        self.entries.iter().filter(move |entry| entry.kind == kind)
    }

    /// The preset of this kind and name; of several, the user's own. `None` if there is none.
    pub fn find(&self, kind: PresetKind, name: &str) -> Option<&Preset> {
        let presets = self.entries_of_kind(kind).filter_map(|entry| entry.preset.as_ref().ok());
        presets.filter(|preset| preset.name == name).last()
    }

    /// Saves a preset, replacing the user's own one of that name. Returns its file.
    ///
    /// # Errors
    /// There is no folder for presets, or the file cannot be written.
    pub fn save(&mut self, preset: &Preset) -> Result<PathBuf, ProjectError> {
        let folder = self.create_folder(preset.kind())?;
        let same = |entry: &&LibraryEntry| entry.preset.as_ref().is_ok_and(|own| own.name == preset.name);
        let existing =
            self.entries_of_kind(preset.kind()).filter(same).filter_map(|entry| entry.file.clone()).next();
        let file = existing.unwrap_or_else(|| unused_file(&folder, &preset.name));
        preset.write(&file)?;
        self.reload();
        Ok(file)
    }

    /// Copies a preset file from elsewhere into the library. Returns the preset.
    ///
    /// # Errors
    /// It cannot be read or saved.
    pub fn import(&mut self, file: &Path) -> Result<Preset, ProjectError> {
        let preset = Preset::read(file)?;
        self.save(&preset)?;
        Ok(preset)
    }

    /// Renames the user's own preset of `file`; the new name must not be taken.
    ///
    /// # Errors
    /// The name is invalid or taken, or the file cannot be read or written.
    pub fn rename(&mut self, file: &Path, name: &str) -> Result<(), ProjectError> {
        let wrong = |problem: String| ProjectError::content(file, problem, "give another name");
        let preset = Preset::read(file)?;
        let renamed = Preset::new(name, preset.content).map_err(|problem| wrong(problem.into()))?;
        let is_taken = self.entries_of_kind(renamed.kind()).any(|entry| {
            entry.file.as_deref() != Some(file) && entry.preset.as_ref().is_ok_and(|p| p.name == renamed.name)
        });
        if is_taken {
            return Err(wrong(format!("there is another \"{}\"", renamed.name)));
        }
        renamed.write(file)?;
        self.reload();
        Ok(())
    }

    /// Removes the user's own preset of `file` from the library; the file moves to the folder `deleted`. Returns its
    /// new path.
    ///
    /// # Errors
    /// The file cannot be moved.
    pub fn delete(&mut self, file: &Path) -> Result<PathBuf, ProjectError> {
        let write = |source| ProjectError::Write { file: file.to_owned(), source };
        let folder = file.parent().unwrap_or(Path::new("")).join(DELETED_FOLDER);
        std::fs::create_dir_all(&folder).map_err(write)?;
        let deleted = unused_file(&folder, &stem(file));
        std::fs::rename(file, &deleted).map_err(write)?;
        self.reload();
        Ok(deleted)
    }

    /// The folder of one kind, created if missing.
    fn create_folder(&self, kind: PresetKind) -> Result<PathBuf, ProjectError> {
        let Some(folder) = &self.folder else {
            let nowhere = std::io::Error::other("the system has no folder for a user's settings");
            return Err(ProjectError::Write { file: PathBuf::from("presets"), source: nowhere });
        };
        let folder = folder.join(kind.name());
        std::fs::create_dir_all(&folder)
            .map_err(|source| ProjectError::Write { file: folder.clone(), source })?;
        Ok(folder)
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// An unused file name in the folder, derived from a preset's name: letters, digits and dashes, which every system
/// accepts.
fn unused_file(folder: &Path, name: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() { c } else { '-' };
    let stem: String = name.to_lowercase().chars().map(plain).take(60).collect();
    let stem = stem.trim_matches('-');
    let stem = if stem.is_empty() { "preset" } else { stem };
    let named = |name: String| folder.join(format!("{name}.json"));
    let numbered = (2..).map(|number| named(format!("{stem}-{number}")));
    let mut candidates = std::iter::once(named(stem.to_string())).chain(numbered);
    candidates.find(|file| !file.exists()).unwrap_or_else(|| named(stem.to_string()))
}
