//! The application of the window: event handling and layout of a frame.
//!
//! ```text
//! session events ─▶ views          keys, menus, panels, views ─▶ actions ─▶ session
//! ```
//!
//! A frame first handles the session's events, then draws everything from the current document. Requests are
//! collected as [`Action`]s and performed at the end.

mod commands;
mod keying;
mod open_file;
mod presets;
mod views;

use super::action::PanelCommand;
use super::chrome::help::Help;
use super::chrome::menu_bar::{MenuState, is_possible, menu_bar};
use super::chrome::palette::Palette;
use super::chrome::status_line::{StatusNotes, status_line};
use super::chrome::toasts::{Severity, Toasts};
use super::chrome::tool_column::{self, tool_column};
use super::chrome::tool_options::tool_options;
use super::dialogs::depth_polarity_dialog::DepthPolarityDialog;
use super::dialogs::export_dialog::ExportDialog;
use super::dialogs::file_dialog::{FileDialog, Purpose};
use super::dialogs::preset_name_dialog::PresetNameDialog;
use super::dialogs::unsaved_changes_dialog::{PendingAction, UnsavedChangesDialog};
use super::frame_log::FrameLog;
use super::graphics::blit::Blitter;
use super::graphics::{device, soft_painter};
use super::layout::{Layout, Pane};
use super::options::WindowOptions;
use super::stroke_player::Player;
use super::tools::brush_gesture::BrushGesture;
use super::views::aperture_orbit::ApertureOrbit;
use super::views::drawer::Drawer;
use super::views::inspector::Inspector;
use super::views::paint_view::PaintView;
use super::views::picture_view::{DisplayedPicture, PictureView};
use super::widgets::brush_controls::largest_radius;
use super::widgets::{keys, theme};
use super::{Action, Tool, ViewSettings};
use document::{CameraEdit, SurfaceHit};
use eframe::{CreationContext, Frame, Storage};
use egui::{CentralPanel, Context, Panel, Ui, ViewportCommand};
use project::{Preset, PresetLibrary};
use session::{
    Command, CommandId, Event, PictureExport, ReferenceKind, Session, SessionError, SessionOptions,
};
use std::path::PathBuf;
use std::sync::Arc;

/// eframe's storage key of the settings.
const SETTINGS_KEY: &str = "settings";
/// eframe's storage key of the layout.
const LAYOUT_KEY: &str = "layout";

/// The application of the window.
pub struct Shell {
    session: Session,
    tool: Tool,
    settings: ViewSettings,
    layout: Layout,
    /// The panel that the pointer was over last.
    hovered_pane: Pane,
    paint: PaintView,
    picture: PictureView,
    inspector: Inspector,
    drawer: Drawer,
    toasts: Toasts,
    palette: Palette,
    help: Help,
    gesture: BrushGesture,
    aperture_orbit: ApertureOrbit,
    export_dialog: ExportDialog,
    /// What the file dialog chooses a file for.
    picture_export: PictureExport,
    /// The name suggested for that file.
    export_file_name: String,
    file_dialog: FileDialog,
    unsaved_dialog: UnsavedChangesDialog,
    depth_polarity: DepthPolarityDialog,
    presets: PresetLibrary,
    preset_name_dialog: PresetNameDialog,
    /// The preset to export, while its file is chosen.
    exported_preset: Option<Preset>,
    /// The first point of a rack focus until the second is clicked.
    rack_from: Option<SurfaceHit>,
    /// An action to perform after a successful save.
    after_save: Option<PendingAction>,
    /// Whether the window may close without the dialog about unsaved changes.
    may_close: bool,
    title: String,
    adapter: String,
    showing_demo: bool,
    /// Whether the display was darkened automatically because of the scene.
    is_dimmed: bool,
    opening: Option<PathBuf>,
    /// Whether there were jobs in the last frame.
    had_jobs: bool,
    /// Start of the current summation, in the window's time.
    drawing_since: Option<f64>,
    player: Option<Player>,
    /// Output file for the player's latencies.
    trace: Option<PathBuf>,
    frame_log: Option<FrameLog>,
}

impl Shell {
    /// Creates the application and starts opening the file of `options` or the demo.
    ///
    /// # Errors
    /// As [`Session::new`].
    pub fn new(creation: &CreationContext<'_>, options: WindowOptions) -> Result<Self, SessionError> {
        let state = creation.wgpu_render_state.as_ref();
        theme::prepare(&creation.egui_ctx);
        if let Some(state) = state {
            soft_painter::install(&creation.egui_ctx, state);
        }
        let stored =
            |key| creation.storage.filter(|_| options.remember).and_then(|storage| storage.get_string(key));
        let settings: ViewSettings =
            stored(SETTINGS_KEY).and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let layout = stored(LAYOUT_KEY).and_then(|text| Layout::from_stored(&text)).unwrap_or_default();
        let context = creation.egui_ctx.clone();
        let gpu = state.map_or(Ok(None), |state| device::splat_device(state, options.backend));
        let fallback_note = "the picture is summed on the processor, not on the graphics card";
        let gpu_error = gpu.as_ref().err().map(|why| format!("{fallback_note}: {why}"));
        let session = Session::new(SessionOptions {
            unwrap: options.unwrap,
            preview_size: options.preview_size.unwrap_or(settings.preview_size),
            exact_delay: options.exact_after,
            light_passes: options.light_passes,
            light_field_store: options.light_fields,
            resources: options.resources,
            bake_on: gpu.as_ref().ok().cloned().flatten().filter(|gpu| !gpu.is_in_software()),
            gpu: gpu.ok().flatten(),
            recovery_delay: options.recovery_delay,
            waker: Arc::new(move || context.request_repaint()),
            ..SessionOptions::default()
        })?;
        let blitter = state.map(Blitter::new);
        let mut shell = Self {
            session,
            tool: Tool::default(),
            settings,
            layout,
            hovered_pane: Pane::Picture,
            paint: PaintView::new(state, blitter.as_ref()),
            picture: PictureView::new(blitter),
            inspector: Inspector::default(),
            drawer: Drawer::default(),
            rack_from: None,
            toasts: Toasts::default(),
            palette: Palette::default(),
            help: Help::default(),
            gesture: BrushGesture::default(),
            aperture_orbit: ApertureOrbit::default(),
            export_dialog: ExportDialog::default(),
            picture_export: PictureExport::default(),
            export_file_name: String::new(),
            file_dialog: FileDialog::new(options.system_dialogs),
            unsaved_dialog: UnsavedChangesDialog::default(),
            depth_polarity: DepthPolarityDialog::default(),
            presets: PresetLibrary::open(options.presets),
            preset_name_dialog: PresetNameDialog::default(),
            exported_preset: None,
            after_save: None,
            may_close: false,
            title: String::new(),
            adapter: state
                .map_or_else(|| "no graphics adapter".into(), |state| state.adapter.get_info().name),
            showing_demo: false,
            is_dimmed: false,
            opening: None,
            had_jobs: false,
            drawing_since: None,
            player: options.replay.map(Player::new),
            trace: options.trace,
            frame_log: None,
        };
        if let Some(file) = &options.frame_log {
            match FrameLog::create(file) {
                Ok(log) => shell.frame_log = Some(log),
                Err(error) => shell.toasts.error(format!("{}: {error}", file.display())),
            }
        }
        if let Some(what) = gpu_error {
            shell.toasts.error(what);
        }
        match options.file {
            Some(file) => shell.open(file),
            None if options.demo => shell.open_demo(),
            None => {}
        }
        Ok(shell)
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The paint view.
    pub fn paint_view(&self) -> &PaintView {
        &self.paint
    }

    /// The picture view.
    pub fn picture_view(&self) -> &PictureView {
        &self.picture
    }

    /// The layout of the panels.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The view settings.
    pub fn settings(&self) -> &ViewSettings {
        &self.settings
    }

    /// The drawer beneath the views.
    pub fn drawer(&self) -> &Drawer {
        &self.drawer
    }

    /// Whether the dialog about the near end of a depth map is open.
    pub fn depth_polarity_dialog_is_open(&self) -> bool {
        self.depth_polarity.is_open()
    }

    /// The active tool.
    pub fn tool(&self) -> Tool {
        self.tool
    }

    /// The messages on screen, oldest first.
    pub fn messages(&self) -> impl Iterator<Item = (Severity, &str)> {
        self.toasts.texts()
    }

    /// The window's title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Executes a command of the command table if it is possible, like its menu entry.
    pub fn run(&mut self, id: CommandId, context: &Context) {
        let state = MenuState {
            document: self.session.document(),
            settings: &self.settings,
            has_jobs: !self.session.jobs().is_empty(),
        };
        if is_possible(id, &state) {
            self.execute(id, context);
        }
    }

    /// Sends a command to the session; a failure becomes a message.
    pub fn apply(&mut self, command: Command) {
        let applied = self.session.apply(command);
        self.show_failure(applied);
    }

    /// Shows an error message if the operation failed.
    fn show_failure(&mut self, done: Result<(), SessionError>) {
        match done {
            Ok(()) | Err(SessionError::Cancelled) => {}
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    fn use_aperture_mask(&mut self, path: PathBuf) {
        let Some(document) = self.session.document() else { return };
        let ratio = document.camera.aperture.ratio;
        match project::read_aperture_mask(&path, &path.display().to_string()) {
            Ok(mask) => {
                let shape = lens::ApertureShape::Mask(Arc::new(mask));
                self.apply(Command::EditCamera(CameraEdit::Aperture(lens::Aperture { shape, ratio })));
                self.apply(Command::FinishEdit);
            }
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// Handles the events of the session.
    fn handle_events(&mut self, context: &Context) {
        for event in self.session.poll() {
            match event {
                Event::Opened => {
                    // Undoes the automatic dimming for the previous scene.
                    if std::mem::take(&mut self.is_dimmed) {
                        self.settings.display_stops = 0.0;
                    }
                    self.document_opened(context);
                }
                Event::GlareDetected(stops) if self.settings.display_stops == 0.0 => {
                    (self.settings.display_stops, self.is_dimmed) = (stops.max(-10.0), true);
                    let stops = -stops;
                    self.toasts.notice(format!(
                        "Shown {stops} stops darker because its lights are very bright (Lens, Display)"
                    ));
                }
                Event::DepthPolarityRequired(question) => self.depth_polarity.open(*question, context),
                Event::GlareDetected(_) => {}
                Event::SurfaceChanged => {
                    self.picture.surface_changed();
                    if let Some(document) = self.session.document() {
                        self.paint.surface_changed(document, context);
                        if document.scene().picture.is_some() {
                            self.drawer.surface_changed();
                        }
                    }
                }
                Event::MapChanged(rectangles) => {
                    if let Some(document) = self.session.document() {
                        self.paint.map_changed(document, rectangles);
                    }
                }
                Event::SelectionChanged => {
                    if let Some(document) = self.session.document() {
                        self.paint.selection_changed(document);
                    }
                }
                Event::ReferenceReady(ReferenceKind::Truth) => self.picture.show(DisplayedPicture::Truth),
                Event::ReferenceReady(_) | Event::VerificationUpdated => {}
                Event::FileWritten(path) => self.file_written(path, context),
                Event::Failed(text) => {
                    self.after_save = None;
                    self.toasts.error(text);
                }
                Event::Notice(text) => self.toasts.notice(text),
                Event::CameraChanged
                | Event::LayersChanged
                | Event::BrushChanged
                | Event::PreviewReady(_)
                | Event::Progress(_) => {}
            }
        }
    }

    /// Handles keys: Esc aborts a stroke; the others are those of the command table.
    fn handle_keys(&mut self, context: &Context, actions: &mut Vec<Action>) {
        if self.palette.is_open()
            || self.file_dialog.is_open()
            || self.export_dialog.is_open()
            || self.unsaved_dialog.is_open()
            || self.depth_polarity.is_open()
            || self.preset_name_dialog.is_open()
        {
            return;
        }
        if self.gesture.has_input() {
            self.update_brush_gesture(context);
            return;
        }
        if self.picture.walk.is_on() && !context.text_edit_focused() {
            self.picture.walk.handle_keys(context, actions);
            return;
        }
        let escape = context.input(|input| input.key_pressed(egui::Key::Escape));
        if escape && (self.help.close() || std::mem::take(&mut self.toasts.is_list_open)) {
            return;
        }
        if escape && self.session.is_painting() {
            actions.push(Command::AbortStroke.into());
        } else if escape && self.session.sub_aperture_point().is_some() {
            self.use_full_aperture();
        }
        actions.extend(keys::pressed_commands(context).into_iter().map(Action::Run));
    }

    /// Shows the picture through the whole aperture again.
    fn use_full_aperture(&mut self) {
        let ended = self.aperture_orbit.stop(&mut self.session);
        self.show_failure(ended);
    }

    /// Lets pointer and keys adjust a parameter of the brush.
    fn update_brush_gesture(&mut self, context: &Context) {
        let Some(document) = self.session.document() else { return };
        if let Some(brush) = self.gesture.update(context, largest_radius(document)) {
            self.apply(Command::SetBrush(brush));
        }
    }

    fn perform_actions(&mut self, actions: Vec<Action>, context: &Context) {
        if !actions.is_empty() {
            context.request_repaint();
        }
        for action in actions {
            match action {
                Action::Run(id) => self.run(id, context),
                Action::Apply(command) => self.apply(*command),
                Action::Open(path) => self.confirm_then(PendingAction::Open(path), context),
                Action::ChooseMask => self.open_file_dialog(Purpose::ApertureMask, context),
                Action::ChooseEnvironment => self.open_file_dialog(Purpose::Environment, context),
                Action::Inspect(hit) => {
                    self.drawer.inspect(hit);
                    self.layout.open(Pane::Aperture);
                }
                Action::RackPoint(hit) => self.rack_point(hit),
                Action::Place(pane, PanelCommand::Enlarge) => self.layout.toggle_enlarged(pane),
                Action::Place(pane, PanelCommand::Float) => self.layout.toggle_floating(pane),
                Action::Place(pane, PanelCommand::Close) => self.layout.close(pane),
                Action::Preset(preset_action) => self.apply_preset_action(preset_action, context),
                Action::ShowError(text) => self.toasts.error(text),
            }
        }
    }

    /// Logs how long the last frame took, if that was requested.
    fn log_frame(&mut self, frame: &Frame) {
        let is_waited_for = |job: &jobs::JobStatus| !Session::BACKGROUND_JOBS.contains(&job.id);
        let jobs = self.session.jobs().iter().filter(|job| is_waited_for(job)).count();
        let seconds = frame.info().cpu_usage;
        if let Some(Err(error)) = self.frame_log.as_mut().map(|log| log.count(seconds, jobs)) {
            self.frame_log = None;
            self.toasts.error(format!("frames are no longer logged: {error}"));
        }
    }

    /// Passes the display settings to the session.
    fn update_display(&mut self) {
        let display = self.settings.display();
        if self.session.display() != display {
            self.apply(Command::SetDisplay(display));
        }
        let tolerance = self.settings.tolerance();
        if self.session.tolerance() != tolerance {
            self.apply(Command::SetTolerance(tolerance));
        }
    }

    /// Continues the recording being played.
    fn advance_playback(&mut self, context: &Context) {
        let Some(mut player) = self.player.take() else { return };
        context.request_repaint();
        match player.play(&mut self.session) {
            Ok(true) => self.player = Some(player),
            Ok(false) => self.finish_playback(&player, context),
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// The recording has ended: writes the latencies and closes the window, if requested.
    fn finish_playback(&mut self, player: &Player, context: &Context) {
        let Some(file) = self.trace.take() else { return };
        let text = player.latency_report(&self.session).map(|trace| format!("{trace:#}\n"));
        let written = text
            .and_then(|text| std::fs::write(&file, text).map_err(|error| SessionError::io(&file, &error)));
        match written {
            Ok(()) => {
                self.may_close = true;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            Err(error) => self.toasts.error(error.to_string()),
        }
    }
}

impl eframe::App for Shell {
    fn logic(&mut self, context: &Context, frame: &mut Frame) {
        self.log_frame(frame);
        self.update_display();
        self.handle_events(context);
        self.advance_playback(context);
        let advanced = self.aperture_orbit.advance(&mut self.session, context);
        self.show_failure(advanced);
        self.confirm_close(context);
        self.update_title(context);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut Frame) {
        let context = ui.ctx().clone();
        let mut actions = Vec::new();
        keys::set_key_map(&context, self.settings.key_map);
        theme::apply_theme(&context, self.settings.light_theme, self.settings.scale);
        self.open_dropped_file(&context);
        self.handle_keys(&context, &mut actions);
        let bar = theme::bar_frame(ui.style());
        Panel::top("menu").frame(bar).show(ui, |ui| {
            let working = !self.session.jobs().is_empty();
            let state =
                MenuState { document: self.session.document(), settings: &self.settings, has_jobs: working };
            menu_bar(ui, &state, &mut actions);
        });
        Panel::top("tool options").frame(bar).show(ui, |ui| {
            tool_options(ui, self.session.document(), self.tool, &mut actions);
        });
        let drawing = self.is_drawing_noticeably(&context);
        Panel::bottom("status").frame(bar).show(ui, |ui| {
            let tip = self
                .session
                .document()
                .map_or("Open a scene with Ctrl+O, or drop one here.", |_| self.tool.tip());
            let notes = StatusNotes { hover: self.hover_numbers(), is_drawing: drawing, tip };
            status_line(ui, &self.session, notes, &mut actions);
        });
        let window_width = context.content_rect().width();
        let column = bar.inner_margin(egui::Margin::symmetric(tool_column::MARGIN, 4));
        let panel = Panel::left("tools").frame(column).resizable(false);
        panel.exact_size(tool_column::width(window_width)).show(ui, |ui| {
            let with_names = tool_column::has_room_for_names(window_width);
            tool_column(ui, self.session.document(), self.tool, with_names, &mut actions);
        });
        // The panels fill the whole area.
        CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.panels(ui, &mut actions));
        self.first_hint(&context);
        actions.extend(self.palette.show(&context, self.session.document(), &self.presets));
        self.help.show(&context, &self.adapter);
        self.show_dialogs(&context);
        self.show_preset_name_dialog(&context);
        self.toasts.show(&context);
        self.perform_actions(actions, &context);
        let has_jobs = !self.session.jobs().is_empty();
        if std::mem::replace(&mut self.had_jobs, has_jobs) && !has_jobs {
            return_memory();
        }
        // While jobs run, their progress is updated twice a second.
        if has_jobs || self.session.exact_picture_progress().is_some() {
            context.request_repaint_after_secs(0.5);
        }
    }

    /// The window is cleared with the panel colour, so that panels need not be filled.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn save(&mut self, storage: &mut dyn Storage) {
        let mut settings = self.settings.clone();
        if self.is_dimmed {
            settings.display_stops = 0.0;
        }
        if let Ok(text) = serde_json::to_string(&settings) {
            storage.set_string(SETTINGS_KEY, text);
        }
        if let Ok(text) = serde_json::to_string(&self.layout) {
            storage.set_string(LAYOUT_KEY, text);
        }
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }
}

/// Returns memory that finished work has left, in the background.
fn return_memory() {
    let thread = std::thread::Builder::new().name("memory".into());
    // Without a thread it is returned after the next work.
    let _ = thread.spawn(crate::heap::return_unused_pages);
}
