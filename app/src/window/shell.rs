//! The window: one frame from top to bottom, and what the commands do.
//!
//! ```text
//! session events ─▶ views          keys, menus, panels, views ─▶ actions ─▶ session
//! ```
//!
//! A frame first takes up what happened, then draws everything from the document as it is; what is asked for is collected in a
//! list of [`Action`]s and carried out at the end.

mod commands;
mod document;
mod keying;
mod presets;
mod views;

use super::action::Placing;
use super::blit::Blitter;
use super::brush_gesture::BrushGesture;
use super::drawer::Drawer;
use super::file_dialog::{FileDialog, Purpose};
use super::help::Help;
use super::inspector::Inspector;
use super::layout::{Layout, Pane};
use super::looking_round::LookingRound;
use super::menu_bar::{MenuState, is_possible, menu_bar};
use super::near_asked::NearAsked;
use super::options::WindowOptions;
use super::paint_view::PaintView;
use super::palette::Palette;
use super::picture_view::{PictureView, Shown};
use super::player::Player;
use super::preset_name::PresetName;
use super::status_line::{StatusNotes, status_line};
use super::toasts::{Severity, Toasts};
use super::tool_bar::{largest_radius, tool_bar};
use super::unsaved_question::{Next, UnsavedQuestion};
use super::{Action, Tool, ViewSettings, graphics, keys, soft_painter, theme};
use eframe::{CreationContext, Frame, Storage};
use egui::{CentralPanel, Context, Panel, Ui, ViewportCommand};
use project::{Preset, PresetShelf};
use session::{
    CameraEdit, Command, CommandId, Event, ReferenceKind, Session, SessionError, SessionOptions, SurfaceHit,
};
use std::path::PathBuf;
use std::sync::Arc;

/// Where eframe keeps the settings between runs.
const SETTINGS_KEY: &str = "settings";
/// Where eframe keeps the layout between runs.
const LAYOUT_KEY: &str = "layout";

/// The window's application.
pub struct Shell {
    session: Session,
    tool: Tool,
    settings: ViewSettings,
    layout: Layout,
    /// The panel that the pointer was over last.
    pointed: Pane,
    paint: PaintView,
    picture: PictureView,
    inspector: Inspector,
    drawer: Drawer,
    toasts: Toasts,
    palette: Palette,
    help: Help,
    gesture: BrushGesture,
    looking_round: LookingRound,
    dialog: FileDialog,
    question: UnsavedQuestion,
    near: NearAsked,
    presets: PresetShelf,
    preset_name: PresetName,
    /// The preset that a file is asked for.
    exported_preset: Option<Preset>,
    /// The first point of a rack focus, until the second is clicked.
    rack_from: Option<SurfaceHit>,
    /// What waits for a save to end well.
    after_save: Option<Next>,
    /// Whether the window may close without a question.
    may_close: bool,
    title: String,
    adapter: String,
    showing_demo: bool,
    /// Whether the display is darker because of the scene, not by the user's choice.
    is_dimmed: bool,
    opening: Option<PathBuf>,
    /// When the picture began to be summed, in the window's time.
    drawing_since: Option<f64>,
    player: Option<Player>,
    /// Where the player's times go.
    trace: Option<PathBuf>,
}

impl Shell {
    /// The window's application, with the file of `options` (or the demo) being opened.
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
        let layout = stored(LAYOUT_KEY).and_then(|text| Layout::stored(&text)).unwrap_or_default();
        let context = creation.egui_ctx.clone();
        let gpu = state.map_or(Ok(None), |state| graphics::summing(state, options.backend));
        let instead = "the processor sums the picture, not the graphics card";
        let unused = gpu.as_ref().err().map(|why| format!("{instead}: {why}"));
        let session = Session::new(SessionOptions {
            unwrap: options.unwrap,
            preview_size: options.preview_size.unwrap_or(settings.preview_size),
            exact_after: options.exact_after,
            light_passes: options.light_passes,
            light_fields: options.light_fields,
            gpu: gpu.ok().flatten(),
            waker: Arc::new(move || context.request_repaint()),
            ..SessionOptions::default()
        })?;
        let blitter = state.map(Blitter::new);
        let mut shell = Self {
            session,
            tool: Tool::default(),
            settings,
            layout,
            pointed: Pane::Picture,
            paint: PaintView::new(state, blitter.as_ref()),
            picture: PictureView::new(blitter),
            inspector: Inspector::default(),
            drawer: Drawer::default(),
            rack_from: None,
            toasts: Toasts::default(),
            palette: Palette::default(),
            help: Help::default(),
            gesture: BrushGesture::default(),
            looking_round: LookingRound::default(),
            dialog: FileDialog::new(options.system_dialogs),
            question: UnsavedQuestion::default(),
            near: NearAsked::default(),
            presets: PresetShelf::open(options.presets),
            preset_name: PresetName::default(),
            exported_preset: None,
            after_save: None,
            may_close: false,
            title: String::new(),
            adapter: state
                .map_or_else(|| "no graphics adapter".into(), |state| state.adapter.get_info().name),
            showing_demo: false,
            is_dimmed: false,
            opening: None,
            drawing_since: None,
            player: options.replay.map(Player::new),
            trace: options.trace,
        };
        if let Some(what) = unused {
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

    /// Where the panels are.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// How things are shown.
    pub fn settings(&self) -> &ViewSettings {
        &self.settings
    }

    /// The drawer beneath the views.
    pub fn drawer(&self) -> &Drawer {
        &self.drawer
    }

    /// Whether it asks which end of a depth map is near.
    pub fn asks_which_end_is_near(&self) -> bool {
        self.near.is_open()
    }

    /// The chosen tool.
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

    /// Does what a command of the table says, as its menu entry does.
    pub fn run(&mut self, id: CommandId, context: &Context) {
        let state = MenuState {
            document: self.session.document(),
            settings: &self.settings,
            working: !self.session.jobs().is_empty(),
        };
        if is_possible(id, &state) {
            self.carry_out(id, context);
        }
    }

    /// Sends a command to the session; a failure becomes a message.
    pub fn apply(&mut self, command: Command) {
        let applied = self.session.apply(command);
        self.report(applied);
    }

    /// Says what failed.
    fn report(&mut self, done: Result<(), SessionError>) {
        match done {
            Ok(()) | Err(SessionError::Cancelled) => {}
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    fn use_mask(&mut self, path: PathBuf) {
        let Some(document) = self.session.document() else { return };
        let ratio = document.camera.aperture.ratio;
        match project::read_aperture_mask(&path, &path.display().to_string()) {
            Ok(mask) => {
                let shape = lens::ApertureShape::Mask(Arc::new(mask));
                self.apply(Command::Camera(CameraEdit::Aperture(lens::Aperture { shape, ratio })));
                self.apply(Command::FinishEdit);
            }
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// Takes up what happened in the session.
    fn take_events(&mut self, context: &Context) {
        for event in self.session.poll() {
            match event {
                Event::Opened => {
                    // What another scene needed is no choice of the user's.
                    if std::mem::take(&mut self.is_dimmed) {
                        self.settings.display_stops = 0.0;
                    }
                    self.document_opened(context);
                }
                Event::Glaring(stops) if self.settings.display_stops == 0.0 => {
                    (self.settings.display_stops, self.is_dimmed) = (stops.max(-10.0), true);
                    let stops = -stops;
                    self.toasts.notice(format!(
                        "Shown {stops} stops darker: its lights are that bright (Lens, Display)"
                    ));
                }
                Event::AsksNear(question) => self.near.ask(*question, context),
                Event::Glaring(_) => {}
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
                Event::ReferenceReady(ReferenceKind::Truth) => self.picture.show(Shown::Truth),
                Event::ReferenceReady(_) | Event::Verified => {}
                Event::Written(path) => self.written(path, context),
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

    /// Keys: Esc takes a stroke back; the rest is the command table's.
    fn keys(&mut self, context: &Context, actions: &mut Vec<Action>) {
        if self.palette.is_open()
            || self.dialog.is_open()
            || self.question.is_open()
            || self.near.is_open()
            || self.preset_name.is_open()
        {
            return;
        }
        if self.gesture.has_input() {
            self.set_up_brush(context);
            return;
        }
        let escape = context.input(|input| input.key_pressed(egui::Key::Escape));
        if escape && self.session.is_painting() {
            actions.push(Command::AbortStroke.into());
        } else if escape && self.session.looked_through().is_some() {
            self.look_through_all();
        }
        actions.extend(keys::pressed(context).into_iter().map(Action::Run));
    }

    /// The picture shows all of the aperture again.
    fn look_through_all(&mut self) {
        let ended = self.looking_round.stop(&mut self.session);
        self.report(ended);
    }

    /// The pointer and the keys set a number of the brush.
    fn set_up_brush(&mut self, context: &Context) {
        let Some(document) = self.session.document() else { return };
        if let Some(brush) = self.gesture.update(context, largest_radius(document)) {
            self.apply(Command::SetBrush(brush));
        }
    }

    fn perform(&mut self, actions: Vec<Action>, context: &Context) {
        if !actions.is_empty() {
            context.request_repaint();
        }
        for action in actions {
            match action {
                Action::Run(id) => self.run(id, context),
                Action::Do(command) => self.apply(*command),
                Action::Open(path) => self.ask_then(Next::Open(path), context),
                Action::ChooseMask => self.ask_for(Purpose::ApertureMask, context),
                Action::ChooseEnvironment => self.ask_for(Purpose::Environment, context),
                Action::Inspect(hit) => {
                    self.drawer.inspect(hit);
                    self.layout.open(Pane::Aperture);
                }
                Action::RackPoint(hit) => self.rack_point(hit),
                Action::Place(pane, Placing::Enlarge) => self.layout.toggle_enlarged(pane),
                Action::Place(pane, Placing::Float) => self.layout.toggle_floating(pane),
                Action::Place(pane, Placing::Close) => self.layout.close(pane),
                Action::Preset(wish) => self.preset(wish, context),
                Action::Complain(text) => self.toasts.error(text),
            }
        }
    }

    /// Tells the session how the screen shows pictures.
    fn show_display(&mut self) {
        let display = self.settings.display();
        if self.session.display() != display {
            self.apply(Command::SetDisplay(display));
        }
        let tolerance = self.settings.tolerance();
        if self.session.tolerance() != tolerance {
            self.apply(Command::SetTolerance(tolerance));
        }
    }

    /// Plays on what is being played.
    fn play(&mut self, context: &Context) {
        let Some(mut player) = self.player.take() else { return };
        context.request_repaint();
        match player.play(&mut self.session) {
            Ok(true) => self.player = Some(player),
            Ok(false) => self.played(&player, context),
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// All was played: its times are written, and the window closes, if that was asked for.
    fn played(&mut self, player: &Player, context: &Context) {
        let Some(file) = self.trace.take() else { return };
        let text = player.trace(&self.session).map(|trace| format!("{trace:#}\n"));
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
    fn logic(&mut self, context: &Context, _frame: &mut Frame) {
        self.show_display();
        self.take_events(context);
        self.play(context);
        let gone_on = self.looking_round.go_on(&mut self.session, context);
        self.report(gone_on);
        self.guard_close(context);
        self.update_title(context);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut Frame) {
        let context = ui.ctx().clone();
        let mut actions = Vec::new();
        keys::obey(&context, self.settings.key_map);
        theme::choose(&context, self.settings.light_theme, self.settings.scale);
        self.dropped_files(&context);
        self.keys(&context, &mut actions);
        let bar = theme::bar(ui.style());
        Panel::top("menu").frame(bar).show(ui, |ui| {
            let working = !self.session.jobs().is_empty();
            let state = MenuState { document: self.session.document(), settings: &self.settings, working };
            menu_bar(ui, &state, &mut actions);
        });
        Panel::top("tools")
            .frame(bar)
            .show(ui, |ui| tool_bar(ui, self.session.document(), self.tool, &mut actions));
        let drawing = self.is_drawing_long(&context);
        Panel::bottom("status").frame(bar).show(ui, |ui| {
            let tip = self
                .session
                .document()
                .map_or("Open a scene with Ctrl+O, or drop one here.", |_| self.tool.tip());
            let notes = StatusNotes { hover: self.hover_numbers(), drawing, tip };
            status_line(ui, &self.session, notes, &mut actions);
        });
        // The panels fill all of it.
        CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.panels(ui, &mut actions));
        self.first_hint(&context);
        if let Some(id) = self.palette.show(&context) {
            actions.push(id.into());
        }
        self.help.show(&context, &self.adapter);
        self.answer_questions(&context);
        self.take_preset_name(&context);
        self.toasts.show(&context);
        self.perform(actions, &context);
        // While work goes on, its progress is shown twice a second.
        if !self.session.jobs().is_empty() || self.session.drawing_exactly().is_some() {
            context.request_repaint_after_secs(0.5);
        }
    }

    /// What lies beneath everything: panels need not be filled.
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
