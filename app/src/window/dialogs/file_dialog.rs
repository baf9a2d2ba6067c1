//! Chooses a file: with the system's dialog if available, otherwise with a text field for the path.
//!
//! The system's dialog runs on its own thread, because it may block indefinitely. If it ends immediately
//! without an answer, as it does where no dialog service is installed, the path is typed instead.

use egui::{Context, Id, Key};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// A dialog that ends sooner than a person could cancel it has failed.
const MIN_HUMAN_RESPONSE: Duration = Duration::from_millis(400);
/// Maximum number of folder entries listed below the typed path.
const MAX_LISTED: usize = 200;

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene or a project to open.
    Open,
    /// The folder of a capture to open.
    OpenCapture,
    /// The project.
    SaveAs,
    /// The picture.
    ExportPicture,
    /// The picture as it is on screen.
    ExportShown,
    /// The web page.
    ExportWebPage,
    /// The web page to paint on.
    ExportEnginePage,
    /// The focus map.
    ExportFocusMap,
    /// The unwrapped scene.
    ExportScene,
    /// The strokes of the history.
    ExportStrokes,
    /// A focus map to read.
    ImportFocusMap,
    /// An image for an aperture mask.
    ApertureMask,
    /// An equirectangular image.
    Environment,
    /// A preset to import.
    ImportPreset,
    /// A preset to export.
    ExportPreset,
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a scene or a project",
            Self::OpenCapture => "Open the folder of a capture",
            Self::SaveAs => "Save the project as",
            Self::ExportPicture => "Export the picture",
            Self::ExportShown => "Export the picture as shown",
            Self::ExportWebPage => "Export a web page to refocus",
            Self::ExportEnginePage => "Export a web page to paint on",
            Self::ExportFocusMap => "Export the focus map",
            Self::ExportScene => "Export the unwrapped scene",
            Self::ExportStrokes => "Export the strokes",
            Self::ImportFocusMap => "Import a focus map or a recipe",
            Self::ApertureMask => "Choose an aperture mask",
            Self::Environment => "Choose an environment",
            Self::ImportPreset => "Import a preset",
            Self::ExportPreset => "Export the preset",
        }
    }

    fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Open => &[
                "glb", "gltf", "fbrush", "ply", "spz", "sog", "splat", "ksplat", "jpg", "jpeg", "png",
                "webp", "exr",
            ],
            Self::OpenCapture => &[],
            Self::SaveAs => &["fbrush"],
            Self::ExportPicture | Self::ExportShown => &["exr", "png"],
            Self::ExportFocusMap => &["exr", "png", "ply"],
            Self::ImportFocusMap => &["exr", "png", "json", "ply"],
            Self::ExportWebPage | Self::ExportEnginePage => &["html"],
            Self::ExportScene => &["glb"],
            Self::ExportStrokes | Self::ImportPreset | Self::ExportPreset => &["json"],
            Self::Environment => &["hdr", "exr"],
            Self::ApertureMask => &["png", "jpg", "jpeg", "exr"],
        }
    }

    /// The formats to choose from, if there are several: extension, name, and purpose.
    fn formats(self) -> &'static [(&'static str, &'static str, &'static str)] {
        match self {
            Self::ExportPicture | Self::ExportShown => &[
                ("png", "PNG", "The picture as the screen shows it, for everyone."),
                ("exr", "OpenEXR", "Linear light, unclipped, for grading and compositing."),
            ],
            Self::ExportFocusMap => &[
                ("exr", "OpenEXR", "Exact values, as floats."),
                ("png", "PNG, 16 bits", "For programs that read pictures only."),
                ("ply", "PLY table", "A row for each Gaussian splat, in the order of its file."),
            ],
            _ => &[],
        }
    }

    /// Whether a folder is chosen.
    fn is_folder(self) -> bool {
        self == Self::OpenCapture
    }

    /// Whether the chosen file will be written.
    pub fn is_output(self) -> bool {
        matches!(
            self,
            Self::SaveAs
                | Self::ExportPicture
                | Self::ExportShown
                | Self::ExportWebPage
                | Self::ExportEnginePage
                | Self::ExportFocusMap
                | Self::ExportScene
                | Self::ExportStrokes
                | Self::ExportPreset
        )
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Open | Self::OpenCapture => "Open",
            Self::SaveAs => "Save",
            _ if self.is_output() => "Export",
            Self::ImportFocusMap | Self::ImportPreset => "Import",
            _ => "Choose",
        }
    }
}

/// State of an open dialog.
enum State {
    /// The system's dialog is open.
    System { answer: mpsc::Receiver<Option<PathBuf>>, since: Instant },
    /// The path is being typed.
    Typed { text: String, focus_request: FocusRequest },
}

/// What the path field does with the keyboard focus in the next frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FocusRequest {
    /// Takes it and selects the suggestion (for an output, the name without the extension).
    Replace,
    /// Takes it and puts the cursor at the end.
    Append,
    /// Leaves it unchanged.
    Nothing,
}

/// The file dialog. One at a time; a new one replaces the old.
pub struct FileDialog {
    system: bool,
    pending: Option<(Purpose, PathBuf, State)>,
    /// A note shown below the path.
    note: Option<String>,
}

impl FileDialog {
    /// A closed dialog. `system`: whether to use the system's dialogs.
    pub fn new(system: bool) -> Self {
        Self { system, pending: None, note: None }
    }

    /// Opens the dialog; `suggestion` is the initial file name with its folder.
    pub fn open(&mut self, purpose: Purpose, suggestion: PathBuf, context: &Context) {
        let answer = self.system.then(|| open_system_dialog(purpose, &suggestion, context)).flatten();
        let state = match answer {
            Some(answer) => State::System { answer, since: Instant::now() },
            None => typed_state(purpose, &suggestion),
        };
        self.pending = Some((purpose, suggestion, state));
        self.note = None;
    }

    /// Sets the note of the open dialog.
    pub fn note(&mut self, note: Option<String>) {
        self.note = note;
    }

    /// Whether the dialog is open.
    pub fn is_open(&self) -> bool {
        self.pending.is_some()
    }

    /// Draws the dialog and returns the chosen path once there is one.
    pub fn show(&mut self, context: &Context) -> Option<(Purpose, PathBuf)> {
        let (purpose, suggestion, state) = self.pending.as_mut()?;
        let purpose = *purpose;
        let step = match state {
            State::System { answer, since } => match answer.try_recv() {
                Ok(Some(path)) => Step::Answer(path),
                Ok(None) if since.elapsed() < MIN_HUMAN_RESPONSE => Step::Type,
                Ok(None) => Step::Cancel,
                Err(mpsc::TryRecvError::Disconnected) => Step::Type,
                Err(mpsc::TryRecvError::Empty) => waiting_dialog(context, purpose),
            },
            State::Typed { text, focus_request } => {
                typed_dialog(context, (purpose, self.note.as_deref()), text, focus_request)
            }
        };
        match step {
            Step::Wait => None,
            Step::Type => {
                *state = typed_state(purpose, suggestion);
                context.request_repaint();
                None
            }
            Step::Cancel => {
                self.pending = None;
                None
            }
            Step::Answer(path) => {
                self.pending = None;
                Some((purpose, with_extension(purpose, path)))
            }
        }
    }
}

enum Step {
    Wait,
    Type,
    Cancel,
    Answer(PathBuf),
}

/// Opens the system's dialog; `None` if no thread could be started for it.
fn open_system_dialog(
    purpose: Purpose,
    suggestion: &Path,
    context: &Context,
) -> Option<mpsc::Receiver<Option<PathBuf>>> {
    let mut dialog = rfd::AsyncFileDialog::new().set_title(purpose.title());
    if purpose.formats().is_empty() && !purpose.is_folder() {
        dialog = dialog.add_filter(purpose.extensions().join(", "), purpose.extensions());
    }
    for (extension, name, _) in purpose.formats() {
        dialog = dialog.add_filter(*name, &[extension]);
    }
    if let Some(folder) = suggestion.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }
    if let Some(name) = suggestion.file_name().filter(|_| purpose.is_output()) {
        dialog = dialog.set_file_name(name.to_string_lossy());
    }
    let (sender, receiver) = mpsc::channel();
    let context = context.clone();
    // Some systems require the dialog to be created on this thread; it may be awaited on any.
    let waiting: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match () {
        () if purpose.is_output() => Box::pin(dialog.save_file()),
        () if purpose.is_folder() => Box::pin(dialog.pick_folder()),
        () => Box::pin(dialog.pick_file()),
    };
    let wait = move || {
        let path = pollster::block_on(waiting).map(|file| file.path().to_path_buf());
        // The receiver is gone if a path was typed in the meantime.
        let _ = sender.send(path);
        context.request_repaint();
    };
    std::thread::Builder::new().name("file dialog".into()).spawn(wait).ok()?;
    Some(receiver)
}

/// The small window shown beside the system's dialog, in case that never appears.
fn waiting_dialog(context: &Context, purpose: Purpose) -> Step {
    let mut step = Step::Wait;
    let window =
        egui::Window::new(purpose.title()).id(Id::unique("file dialog")).collapsible(false).resizable(false);
    window.anchor(egui::Align2::CENTER_BOTTOM, [0.0, -50.0]).show(context, |ui| {
        ui.horizontal(|ui| {
            ui.label("The system's file dialog is open.");
            if ui.button("Type a path instead").on_hover_text("Use this if no dialog appears.").clicked() {
                step = Step::Type;
            }
            if ui.button("Cancel").on_hover_text("Close the dialog.").clicked() {
                step = Step::Cancel;
            }
        });
    });
    step
}

fn typed_state(purpose: Purpose, suggestion: &Path) -> State {
    let mut text = suggestion.display().to_string();
    if !purpose.is_output() {
        let folder = if suggestion.is_dir() { Some(suggestion) } else { suggestion.parent() };
        text = folder.map_or_else(String::new, |folder| folder.display().to_string());
        if !text.is_empty() && !text.ends_with(std::path::MAIN_SEPARATOR) {
            text.push(std::path::MAIN_SEPARATOR);
        }
    }
    State::Typed { text, focus_request: FocusRequest::Replace }
}

/// The path field, the entries of its folder, and the buttons.
fn typed_dialog(
    context: &Context,
    (purpose, note): (Purpose, Option<&str>),
    text: &mut String,
    focus_request: &mut FocusRequest,
) -> Step {
    let mut step = Step::Wait;
    let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
    let modal = egui::Modal::new(Id::unique("file dialog")).frame(frame).show(context, |ui| {
        ui.set_width(560.0);
        ui.heading(purpose.title());
        ui.add_space(4.0);
        let mut chosen: Option<PathBuf> = None;
        let edit = egui::TextEdit::singleline(text)
            .hint_text(if purpose.is_folder() { "path of the folder" } else { "path of the file" })
            .desired_width(f32::INFINITY);
        let output = edit.show(ui);
        let response = output.response.response;
        crate::window::widgets::controls::set_accessible_name(&response, "Path");
        let selection = match std::mem::replace(focus_request, FocusRequest::Nothing) {
            FocusRequest::Replace => Some(replaceable_range(purpose, text)),
            FocusRequest::Append => Some([text.chars().count(); 2]),
            FocusRequest::Nothing => None,
        };
        if let Some([start, end]) = selection.map(|range| range.map(egui::text::CCursor::new)) {
            response.request_focus();
            let mut state = output.state;
            state.cursor.set_char_range(Some(egui::text::CCursorRange::two(start, end)));
            state.store(ui.ctx(), response.id);
        }
        format_row(ui, purpose, text);
        if let Some(note) = note {
            ui.weak(note);
        }
        ui.add_space(4.0);
        egui::ScrollArea::vertical().auto_shrink([false; 2]).max_height(240.0).show(ui, |ui| {
            let entries = matching_entries(purpose, text);
            if entries.is_empty() {
                ui.weak(if purpose.is_folder() {
                    "No folders in here."
                } else {
                    "No files of this kind here yet."
                });
            }
            for entry in entries {
                let name =
                    entry.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
                let folder = entry.is_dir();
                let label = if folder { format!("{name}{}", std::path::MAIN_SEPARATOR) } else { name };
                let button = crate::window::widgets::controls::list_row(ui, false, &label);
                if button.clicked() {
                    *text = entry.display().to_string();
                    if folder {
                        text.push(std::path::MAIN_SEPARATOR);
                        *focus_request = FocusRequest::Append;
                    }
                }
                if button.double_clicked() && !folder {
                    chosen = Some(entry);
                }
            }
        });
        ui.add_space(6.0);
        let path = PathBuf::from(text.trim());
        let target = with_extension(purpose, path.clone());
        let problem = path_problem(purpose, &path);
        ui.horizontal(|ui| {
            let accept = ui.add_enabled(problem.is_none(), egui::Button::new(purpose.verb()));
            let entered = ui.input(|input| input.key_pressed(Key::Enter));
            if entered && problem.is_some() {
                *focus_request = FocusRequest::Append;
            }
            if accept.clicked() || (entered && problem.is_none()) {
                chosen = Some(path.clone());
            }
            if ui.button("Cancel").clicked() {
                step = Step::Cancel;
            }
            match problem {
                Some(problem) if !text.trim().is_empty() => {
                    ui.weak(problem);
                }
                None if purpose.is_output() && target.exists() => {
                    ui.colored_label(ui.visuals().warn_fg_color, "This file exists and will be replaced.");
                }
                _ => {}
            }
        });
        if let Some(path) = chosen {
            step = Step::Answer(path);
        }
    });
    if modal.should_close() {
        step = Step::Cancel;
    }
    step
}

/// Buttons for the formats; choosing one changes the extension.
fn format_row(ui: &mut egui::Ui, purpose: Purpose, text: &mut String) {
    if purpose.formats().is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("Format");
        let path = with_extension(purpose, PathBuf::from(text.trim()));
        for (extension, name, tip) in purpose.formats() {
            let is_chosen = path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
            if ui.add(egui::Button::selectable(is_chosen, *name)).on_hover_text(*tip).clicked() {
                *text = path.with_extension(extension).display().to_string();
            }
        }
    });
}

/// The range of characters in the suggestion that typing replaces.
fn replaceable_range(purpose: Purpose, text: &str) -> [usize; 2] {
    let count = text.chars().count();
    if !purpose.is_output() {
        return [0, count];
    }
    let path = Path::new(text);
    let length =
        |part: Option<&std::ffi::OsStr>| part.map_or(0, |part| part.to_string_lossy().chars().count());
    let start = count - length(path.file_name()).min(count);
    [start, start + length(path.file_stem())]
}

/// Why the path cannot be used, if so.
fn path_problem(purpose: Purpose, path: &Path) -> Option<&'static str> {
    if path.as_os_str().is_empty() {
        return Some("Type a path.");
    }
    if purpose.is_folder() {
        return (!path.is_dir()).then_some("There is no such folder.");
    }
    if path.is_dir() {
        return Some("This is a folder.");
    }
    if !purpose.is_output() {
        return (!path.exists()).then_some("There is no such file.");
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    (folder.is_some_and(|folder| !folder.is_dir())).then_some("There is no such folder.")
}

/// The path with the default extension of the purpose appended, unless it already has a suitable one.
fn with_extension(purpose: Purpose, path: PathBuf) -> PathBuf {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_lowercase);
    if !purpose.is_output()
        || extension.is_some_and(|extension| purpose.extensions().contains(&extension.as_str()))
    {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(".");
    name.push(purpose.extensions()[0]);
    name.into()
}

/// Folders and suitable files whose names start with the typed text.
fn matching_entries(purpose: Purpose, text: &str) -> Vec<PathBuf> {
    let typed = Path::new(text);
    let (folder, start) = if text.is_empty() || text.ends_with(['/', std::path::MAIN_SEPARATOR]) {
        (typed, String::new())
    } else {
        let start = typed.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
        (typed.parent().unwrap_or(Path::new("")), start)
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(listing) = std::fs::read_dir(folder) else { return Vec::new() };
    let fits = |path: &PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).unwrap_or_default();
        let is_supported = path.is_dir() || purpose.extensions().contains(&extension.as_str());
        let shown = !name.starts_with('.') || start.starts_with('.');
        is_supported && shown && (name.starts_with(&start) || purpose.is_output())
    };
    let mut matches: Vec<_> = listing.filter_map(|entry| Some(entry.ok()?.path())).filter(fits).collect();
    matches
        .sort_by_key(|path| (!path.is_dir(), path.file_name().map(|n| n.to_string_lossy().to_lowercase())));
    matches.truncate(MAX_LISTED);
    matches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_follows_what_is_typed() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.glb", "b.GLTF", "b.txt", ".hidden.glb"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("deep")).unwrap();
        let at = |text: &str| {
            let text = format!("{}/{text}", folder.path().display());
            let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
            matching_entries(Purpose::Open, &text).iter().map(name).collect::<Vec<_>>()
        };
        assert_eq!(at(""), ["deep", "a.glb", "b.GLTF"], "folders first, nothing that cannot be opened");
        assert_eq!(at("B"), ["b.GLTF"]);
        assert_eq!(at("nothing/"), Vec::<String>::new());
    }

    #[test]
    fn a_written_file_gets_its_extension() {
        assert_eq!(with_extension(Purpose::SaveAs, "x".into()), Path::new("x.fbrush"));
        assert_eq!(with_extension(Purpose::SaveAs, "x.v2".into()), Path::new("x.v2.fbrush"));
        assert_eq!(with_extension(Purpose::ExportPicture, "x.PNG".into()), Path::new("x.PNG"));
        assert_eq!(with_extension(Purpose::Open, "x".into()), Path::new("x"));
    }

    #[test]
    fn typing_replaces_the_name_that_is_suggested() {
        assert_eq!(replaceable_range(Purpose::SaveAs, "/a/häuser.fbrush"), [3, 9]);
        assert_eq!(replaceable_range(Purpose::Open, "/a/b/"), [0, 5]);
    }

    #[test]
    fn a_path_is_checked_before_it_is_used() {
        let folder = tempfile::tempdir().unwrap();
        assert!(path_problem(Purpose::Open, folder.path()).is_some());
        assert!(path_problem(Purpose::Open, &folder.path().join("none.glb")).is_some());
        assert!(path_problem(Purpose::SaveAs, &folder.path().join("none/x.fbrush")).is_some());
        assert_eq!(path_problem(Purpose::SaveAs, &folder.path().join("x.fbrush")), None);
    }
}
