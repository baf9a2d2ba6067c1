//! Bookmarks: cameras that are saved with a project under names of their own, beside the shot camera.

use crate::focus_hold::HeldCamera;
use crate::open_document::Document;
use project::NamedCamera;

/// A change of the bookmarks; each is named by its number in [`Document::bookmarks`]. Numbers that do not exist change nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BookmarkEdit {
    /// Bookmarks the shot camera under a new name.
    Add,
    /// Gives a bookmark another name.
    Rename(usize, String),
    /// Makes a bookmark that of the shot camera.
    Update(usize),
    /// Removes a bookmark.
    Remove(usize),
}

impl Document {
    /// The bookmarks, in the order in which they were added.
    pub fn bookmarks(&self) -> impl Iterator<Item = &NamedCamera> {
        self.bookmark_indices().map(|index| &self.template.cameras[index])
    }

    /// The camera of a bookmark; `None` if there is no such number.
    pub fn bookmark(&self, number: usize) -> Option<HeldCamera> {
        let NamedCamera { camera, focus_hold, .. } = self.bookmarks().nth(number)?.clone();
        Some(match focus_hold {
            Some(focus_hold) => HeldCamera { camera, focus_hold },
            None => HeldCamera::on_axis(camera),
        })
    }

    /// Changes the bookmarks: unsaved work, but not an undo step.
    pub fn edit_bookmarks(&mut self, edit: BookmarkEdit) {
        let index = |number: usize| self.bookmark_indices().nth(number);
        match edit {
            BookmarkEdit::Add => {
                let name = self.unused_name("View 1", None);
                self.template.cameras.push(self.shot_as(name));
            }
            BookmarkEdit::Rename(number, name) => {
                let Some(index) = index(number).filter(|_| !name.trim().is_empty()) else { return };
                self.template.cameras[index].name = self.unused_name(name.trim(), Some(index));
            }
            BookmarkEdit::Update(number) => {
                let Some(index) = index(number) else { return };
                let name = self.template.cameras[index].name.clone();
                self.template.cameras[index] = self.shot_as(name);
            }
            BookmarkEdit::Remove(number) => {
                let Some(index) = index(number) else { return };
                self.template.cameras.remove(index);
                self.template.active_camera -= usize::from(index < self.template.active_camera);
            }
        }
        self.note_unrecorded_change();
    }

    /// The places of the bookmarks among the project's cameras.
    fn bookmark_indices(&self) -> impl Iterator<Item = usize> + use<> {
        let shot = self.template.active_camera;
        (0..self.template.cameras.len()).filter(move |index| *index != shot)
    }

    fn shot_as(&self, name: String) -> NamedCamera {
        let HeldCamera { camera, focus_hold } = self.held_camera();
        NamedCamera { name, camera, focus_hold: Some(focus_hold) }
    }

    /// A name that no other camera of the project has: the wanted one, or that with another number at its end.
    fn unused_name(&self, wanted: &str, own: Option<usize>) -> String {
        let others = || self.template.cameras.iter().enumerate().filter(|(index, _)| Some(*index) != own);
        let is_taken = |name: &str| others().any(|(_, camera)| camera.name == name);
        let stem = wanted.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let numbered = (1..).map(|number| format!("{stem} {number}"));
        let mut candidates = std::iter::once(wanted.to_string()).chain(numbered);
        candidates.find(|name| !is_taken(name)).unwrap_or_default()
    }
}
