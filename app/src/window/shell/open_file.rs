//! Opening, saving and exporting documents, the dialogs involved, dropped files, and the window title.

use super::Shell;
use crate::window::dialogs::file_dialog::Purpose;
use crate::window::dialogs::unsaved_changes_dialog::{Answer, PendingAction};
use crate::window::layout::Pane;
use crate::window::widgets::controls;
use crate::window::{Tool, demo};
use document::{DepthPolarityRequest, Document, is_capture};
use egui::{Context, ViewportCommand};
use project::CaptureChoices;
use session::{Command, FullSizeFieldState, PictureExport};
use std::path::{Path, PathBuf};

impl Shell {
    pub(super) fn open(&mut self, path: PathBuf) {
        self.showing_demo = false;
        self.opening = Some(path.clone());
        self.apply(Command::Open(path));
    }

    pub(super) fn open_demo(&mut self) {
        match demo::demo_project() {
            Some(project) => {
                self.opening = None;
                self.showing_demo = true;
                self.apply(Command::OpenTemplate(project));
            }
            None => self.toasts.error("assets/demo: the demo is not installed (open a scene with Ctrl+O)"),
        }
    }

    /// Performs `next` now, or after the dialog about unsaved changes.
    pub(super) fn confirm_then(&mut self, next: PendingAction, context: &Context) {
        if self.session.document().is_some_and(|document| document.is_unsaved()) {
            self.unsaved_dialog.open(next);
        } else {
            self.proceed(next, context);
        }
    }

    pub(super) fn proceed(&mut self, next: PendingAction, context: &Context) {
        match next {
            PendingAction::Quit => {
                self.may_close = true;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            PendingAction::Open(path) => self.open(path),
            PendingAction::OpenDemo => self.open_demo(),
            PendingAction::ChooseFile | PendingAction::ChooseCapture => {
                let purpose =
                    if next == PendingAction::ChooseCapture { Purpose::OpenCapture } else { Purpose::Open };
                let folder = self.settings.recent.first().and_then(|path| Some(path.parent()?.to_path_buf()));
                let folder = folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default();
                self.file_dialog.open(purpose, folder.join(""), context);
            }
        }
    }

    pub(super) fn save(&mut self, context: &Context) {
        let Some(document) = self.session.document() else { return };
        if document.path.is_some() {
            self.store_viewpoint();
            self.apply(Command::Save);
        } else {
            self.open_file_dialog(Purpose::SaveAs, context);
        }
    }

    /// Stores the viewpoint in the document, which does not count as a change.
    pub(super) fn store_viewpoint(&mut self) {
        self.apply(Command::SetView(self.paint.viewpoint()));
    }

    /// Opens the file dialog in the document's folder, with a name derived from the document's.
    pub(super) fn open_file_dialog(&mut self, purpose: Purpose, context: &Context) {
        let Some(document) = self.session.document() else { return };
        let (base, stem) = (main_file(document), file_stem(document));
        // Files derived from the demo do not belong in the program's folder.
        let base = if self.showing_demo && document.path.is_none() {
            user_folder().join(stem.as_str())
        } else {
            base.to_owned()
        };
        let name = match purpose {
            Purpose::SaveAs => format!("{stem}.fbrush"),
            Purpose::ExportPicture => self.export_file_name.clone(),
            Purpose::ExportShown => format!("{stem}.png"),
            Purpose::ExportWebPage => format!("{stem}.html"),
            Purpose::ExportEnginePage => format!("{stem}-paint.html"),
            Purpose::ExportFocusMap => format!("{stem}-focus.exr"),
            Purpose::ExportScene => format!("{stem}-unwrapped.glb"),
            Purpose::ExportStrokes => format!("{stem}-strokes.json"),
            Purpose::Open
            | Purpose::OpenCapture
            | Purpose::ImportFocusMap
            | Purpose::ApertureMask
            | Purpose::Environment
            | Purpose::ImportPreset
            | Purpose::ExportPreset => String::new(),
        };
        self.file_dialog.open(purpose, base.with_file_name("").join(name), context);
        self.file_dialog.note(self.export_size_note(purpose));
    }

    /// Opens the file dialog in the user's folder, for files that belong to no document.
    pub(super) fn open_dialog_in_user_folder(&mut self, purpose: Purpose, name: &Path, context: &Context) {
        self.file_dialog.open(purpose, user_folder().join(name), context);
    }

    /// A note for the export of a picture: its size, and what has to be computed first.
    fn export_size_note(&self, purpose: Purpose) -> Option<String> {
        let size = |camera: &lens::Camera| format!("{} × {} px", camera.width, camera.height);
        let shown = self.session.preview().map(|preview| size(&preview.camera))?;
        let full = self.session.document().map(|document| size(&document.camera))?;
        match purpose {
            Purpose::ExportShown => Some(format!("{shown}, as displayed.")),
            Purpose::ExportPicture => Some(self.export_note(&self.picture_export)),
            Purpose::ExportWebPage => self.session.web_page_estimate().map(|estimate| {
                format!(
                    "About {}: {} pictures of {full} at three apertures, each at its focus distance. They are drawn in \
                     the background; the status line shows how long that takes.",
                    controls::bytes_text(estimate.bytes as usize),
                    estimate.slices
                )
            }),
            Purpose::ExportEnginePage => self.session.document().map(|document| {
                format!(
                    "{}, usually 10 to 30 MB: the light field and the program that draws it. It is baked in the \
                     background. Tone mapping stays here.",
                    size(&render::usual_engine_camera(&document.camera))
                )
            }),
            _ => None,
        }
    }

    /// Opens the dialog for what is exported of the picture.
    pub(super) fn open_export_dialog(&mut self) {
        let Some(document) = self.session.document() else { return };
        self.export_dialog.open(&document.camera, file_stem(document));
    }

    /// What has to be computed for an exported picture.
    fn export_note(&self, export: &PictureExport) -> String {
        match self.session.export_field_state(export) {
            FullSizeFieldState::Ready => {
                "Exact: rendered in the background from the existing light field.".into()
            }
            FullSizeFieldState::InProgress => {
                "Exact: rendered in the background, as soon as the light field of the live picture is baked. The status \
                 line shows how long that takes."
                    .into()
            }
            FullSizeFieldState::Missing => {
                let shown = self.session.preview().map_or([0; 2], |shown| [shown.camera.width, shown.camera.height]);
                let [width, height] = shown;
                format!(
                    "Exact. Its light field is baked first, in the background: the status line shows how long. For \
                     {width} × {height} px immediately: File, Export as shown."
                )
            }
        }
    }

    pub(super) fn file_chosen(&mut self, purpose: Purpose, path: PathBuf) {
        match purpose {
            Purpose::Open | Purpose::OpenCapture => self.open(path),
            Purpose::SaveAs => {
                self.store_viewpoint();
                self.apply(Command::SaveAs(path));
            }
            Purpose::ExportPicture => {
                let export = std::mem::take(&mut self.picture_export);
                self.apply(Command::ExportPicture(path, export));
            }
            Purpose::ExportShown => self.apply(Command::ExportShown(path)),
            Purpose::ExportWebPage => self.apply(Command::ExportWebPage(path)),
            Purpose::ExportEnginePage => self.apply(Command::ExportEnginePage(path)),
            Purpose::ExportFocusMap => self.apply(Command::ExportFocusMap(path)),
            Purpose::ExportScene => self.apply(Command::ExportScene(path)),
            Purpose::ExportStrokes => self.apply(Command::ExportStrokes(path)),
            Purpose::ImportFocusMap => self.apply(Command::ImportFocusMap(path)),
            Purpose::ApertureMask => self.use_aperture_mask(path),
            Purpose::Environment => self.apply(Command::LoadEnvironment(path)),
            Purpose::ImportPreset => self.import_preset(&path),
            Purpose::ExportPreset => self.export_preset(&path),
        }
    }

    pub(super) fn document_opened(&mut self, context: &Context) {
        self.tool = Tool::Brush;
        self.picture.opened();
        self.drawer.opened();
        self.rack_from = None;
        let opening = self.opening.take();
        if let Some(document) = self.session.document() {
            self.paint.opened(document, context);
            if document.path.is_none() && !document.scene().views.is_empty() {
                self.layout.open(Pane::Photographs);
            }
            if let Some(path) = opening.filter(|_| !self.showing_demo) {
                self.settings.remember(&path);
            }
            let warnings = document.warnings.len();
            if warnings > 0 {
                let first = &document.warnings[0];
                let more = if warnings > 1 {
                    format!(" (and {} more, see Scene)", warnings - 1)
                } else {
                    String::new()
                };
                self.toasts.notice(format!("{first}{more}"));
            }
        }
    }

    pub(super) fn file_written(&mut self, path: PathBuf, context: &Context) {
        self.toasts.notice(format!("Wrote {}", path.display()));
        let Some(document) = self.session.document() else { return };
        if document.path.as_ref() == Some(&path) {
            self.settings.remember(&path);
            if let Some(next) = self.after_save.take() {
                self.proceed(next, context);
            }
        }
    }

    pub(super) fn update_title(&mut self, context: &Context) {
        let title = match self.session.document() {
            Some(document) => {
                let star = if document.is_unsaved() { " *" } else { "" };
                format!("{}{star} – Focus Brush", document.name())
            }
            None => "Focus Brush".into(),
        };
        if title != self.title {
            context.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Opens the dialog about unsaved changes before the window closes.
    pub(super) fn confirm_close(&mut self, context: &Context) {
        let closing = context.input(|input| input.viewport().close_requested());
        let unsaved = self.session.document().is_some_and(|document| document.is_unsaved());
        if closing && unsaved && !self.may_close {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            self.unsaved_dialog.open(PendingAction::Quit);
        }
    }

    pub(super) fn show_dialogs(&mut self, context: &Context) {
        let name = self.session.document().map(|document| document.name()).unwrap_or_default();
        match self.unsaved_dialog.show(context, &name) {
            Some(Answer::Save(next)) => {
                self.after_save = Some(next);
                self.save(context);
            }
            Some(Answer::Discard(next)) => self.proceed(next, context),
            Some(Answer::Stay) | None => {}
        }
        if let Some((DepthPolarityRequest { capture, .. }, near)) = self.depth_polarity.show(context) {
            let choices = CaptureChoices { near: Some(near.into()), ..CaptureChoices::default() };
            self.apply(Command::OpenCapture(capture, choices));
        }
        let mut dialog = std::mem::take(&mut self.export_dialog);
        let note = |size| self.export_note(&PictureExport { size: Some(size), layers: Vec::new() });
        let chosen = dialog.show(context, note);
        self.export_dialog = dialog;
        if let Some((export, name)) = chosen {
            (self.picture_export, self.export_file_name) = (export, name);
            self.open_file_dialog(Purpose::ExportPicture, context);
        }
        let was_open = self.file_dialog.is_open();
        match self.file_dialog.show(context) {
            Some((purpose, path)) => self.file_chosen(purpose, path),
            None if was_open && !self.file_dialog.is_open() => self.after_save = None,
            None => {}
        }
    }

    pub(super) fn open_dropped_file(&mut self, context: &Context) {
        let dropped =
            context.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_path_buf()));
        match dropped {
            Some(path) if path.extension().is_some_and(|extension| extension == "json") => {
                self.import_preset(&path);
            }
            Some(path)
                if is_environment(&path) && self.session.document().is_some() && !is_capture(&path) =>
            {
                self.apply(Command::LoadEnvironment(path));
            }
            Some(path) => self.confirm_then(PendingAction::Open(path), context),
            None => {}
        }
    }
}

/// The project file, or before the first save the scene's.
fn main_file(document: &Document) -> &Path {
    document.path.as_ref().unwrap_or(&document.scene().path)
}

/// The name of that file without its extension.
fn file_stem(document: &Document) -> String {
    main_file(document).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Whether a file may be an environment map.
fn is_environment(path: &Path) -> bool {
    let has_extension =
        |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
    has_extension("hdr") || has_extension("exr")
}

/// Default folder of the user's files: documents, else home, else the current folder.
fn user_folder() -> PathBuf {
    let folders = directories::UserDirs::new();
    let user_folder = folders.map(|folders| {
        let documents = folders.document_dir().filter(|folder| folder.is_dir());
        documents.unwrap_or(folders.home_dir()).to_path_buf()
    });
    user_folder.or_else(|| std::env::current_dir().ok()).unwrap_or_default()
}
