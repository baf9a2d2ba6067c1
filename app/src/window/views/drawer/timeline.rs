//! The timeline: keys of the lens and of the active layer over time. Dragging scrubs, clicking a key goes to
//! it, dragging a key moves it.

use crate::window::Action;
use crate::window::widgets::{controls, keys};
use document::Document;
use egui::{Align2, Color32, DragValue, FontId, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2};
use focus::{Keys, LayerEdit};
use session::{Command, CommandId, Session};

/// Frame rate of the displayed frame numbers; times snap to these frames.
const FRAMES_PER_SECOND: f64 = 24.0;
/// Smallest displayed time span, s.
const MIN_SPAN_SECONDS: f64 = 4.0;
/// Time displayed beyond the last key, s.
const TRAILING_SECONDS: f64 = 1.0;
/// Height of a row of keys, and of the ruler, points.
const ROW: f32 = 26.0;
const RULER: f32 = 18.0;
/// Width of the names of the rows, points.
const NAMES: f32 = 74.0;
/// Half a key's width, points.
const KEY: f32 = 6.0;
/// Number of points of a drawn curve.
const CURVE_POINTS: usize = 96;

/// The timeline's state between frames.
#[derive(Default)]
pub struct Timeline {
    /// Whether it plays, and the window's time and the timeline's at the start of playback, s.
    playing: Option<Option<[f64; 2]>>,
    /// The key being dragged: its row and its time.
    dragged_key: Option<(Row, f64)>,
}

/// A row of keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Row {
    Focus,
    FNumber,
    Character,
    Opacity,
}

impl Row {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Focus, "Focus"),
        (Self::FNumber, "f-number"),
        (Self::Character, "Character"),
        (Self::Opacity, "Opacity"),
    ];

    fn times(self, document: &Document) -> Vec<f64> {
        fn key_seconds<T>(keys: &Keys<T>) -> Vec<f64> {
            keys.keys().iter().map(|key| key.seconds).collect()
        }
        match self {
            Self::Focus => key_seconds(&document.lens_motion.focus),
            Self::FNumber => key_seconds(&document.lens_motion.f_number),
            Self::Character => key_seconds(&document.lens_motion.character),
            Self::Opacity => key_seconds(&document.layers.active().motion.opacity),
        }
    }

    /// Value of the row's curve at a time; `None` without keys, and for characters, which have many numbers.
    fn value(self, document: &Document, seconds: f64) -> Option<f64> {
        let scene = document.scene();
        match self {
            Self::Focus if document.lens_motion.focus.is_empty() => None,
            Self::Focus => {
                let place = |point: scene::SurfacePoint| point.checked_position(scene);
                // Negated, so that far is up.
                Some(-1.0 / document.lens_motion.camera_at(seconds, &document.camera, &place).focus_distance)
            }
            Self::FNumber => document.lens_motion.f_number_at(seconds).map(f64::ln),
            Self::Character => None,
            Self::Opacity => {
                document.layers.active().motion.opacity.span_at(seconds).map(|around| around.interpolate())
            }
        }
    }

    /// The command that moves a key to another time.
    fn move_key_command(self, document: &Document, from: f64, to: f64) -> Option<Command> {
        fn shift<T: Clone>(keys: &mut Keys<T>, from: f64, to: f64) -> bool {
            let Some(mut key) = keys.keys().iter().find(|key| key.seconds == from).cloned() else {
                return false;
            };
            key.seconds = to;
            keys.remove(from) && keys.insert(key)
        }
        let mut lens = document.lens_motion.clone();
        let mut layer = document.layers.active().motion.clone();
        match self {
            Self::Focus => {
                shift(&mut lens.focus, from, to).then_some(Command::SetLensMotion("Move key", lens))
            }
            Self::FNumber => {
                shift(&mut lens.f_number, from, to).then_some(Command::SetLensMotion("Move key", lens))
            }
            Self::Character => {
                shift(&mut lens.character, from, to).then_some(Command::SetLensMotion("Move key", lens))
            }
            Self::Opacity => {
                let index = document.layers.active_index();
                shift(&mut layer.opacity, from, to)
                    .then_some(Command::EditLayers(LayerEdit::Motion(index, layer)))
            }
        }
    }
}

/// Maps times to positions on screen.
struct Scale {
    rect: Rect,
    seconds: f64,
}

impl Scale {
    fn x(&self, seconds: f64) -> f32 {
        self.rect.left() + (seconds / self.seconds) as f32 * self.rect.width()
    }

    /// The time of the frame nearest to a position.
    fn seconds(&self, x: f32) -> f64 {
        let share = f64::from((x - self.rect.left()) / self.rect.width().max(1.0)).clamp(0.0, 1.0);
        (share * self.seconds * FRAMES_PER_SECOND).round() / FRAMES_PER_SECOND
    }
}

impl Timeline {
    /// Starts playback, or stops it at the current time.
    pub fn toggle_playing(&mut self) {
        self.playing = if self.playing.is_some() { None } else { Some(None) };
    }

    /// Draws the timeline.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let Some(document) = session.document() else { return };
        let last = Row::ALL.iter().flat_map(|(row, _)| row.times(document)).fold(0.0, f64::max);
        let seconds = (last + TRAILING_SECONDS).max(MIN_SPAN_SECONDS);
        self.play(ui, document, seconds, actions);
        self.buttons(ui, document, actions);
        let height = RULER + Row::ALL.len() as f32 * ROW;
        let (all, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click_and_drag());
        controls::set_accessible_name(&response, "Keys over time");
        let scale = Scale { rect: all.with_min_x(all.left() + NAMES).shrink2(vec2(KEY, 0.0)), seconds };
        self.scrub(&response, &scale, actions);
        ruler(ui, &scale, all);
        for (number, (row, name)) in Row::ALL.into_iter().enumerate() {
            let top = all.top() + RULER + number as f32 * ROW;
            let line = Rect::from_min_max(pos2(all.left(), top), pos2(all.right(), top + ROW));
            ui.painter().text(
                line.left_center(),
                Align2::LEFT_CENTER,
                name,
                FontId::proportional(12.0),
                ui.visuals().text_color(),
            );
            curve(ui, document, row, &scale, line.shrink2(vec2(0.0, 4.0)));
            self.keys(ui, document, (row, name), &scale, line.center().y, actions);
        }
        let x = scale.x(document.seconds);
        let now = Stroke::new(1.5, ui.visuals().selection.stroke.color);
        ui.painter().vline(x, all.y_range(), now);
    }

    /// Advances the time during playback.
    fn play(&mut self, ui: &Ui, document: &Document, length: f64, actions: &mut Vec<Action>) {
        let Some(since) = &mut self.playing else { return };
        let now = ui.input(|input| input.time);
        let [began, from] = *since.get_or_insert([now, document.seconds]);
        let seconds = (from + now - began).rem_euclid(length);
        actions.push(Command::GoToTime(seconds).into());
        ui.ctx().request_repaint();
    }

    fn buttons(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        ui.horizontal(|ui| {
            let label = if self.playing.is_some() { "Stop" } else { "Play" };
            let play =
                ui.button(label).on_hover_text(keys::command_tooltip(ui.ctx(), CommandId::PlayTimeline));
            controls::set_accessible_name(&play, "Play");
            if play.clicked() {
                self.toggle_playing();
            }
            let mut frame = document.seconds * FRAMES_PER_SECOND + 1.0;
            let value =
                DragValue::new(&mut frame).range(1.0..=1e6).speed(0.2).max_decimals(1).prefix("frame ");
            let tip = "The displayed frame at 24 frames per second: frame 1 is at 0 s.";
            let response = ui.add(value).on_hover_text(tip);
            controls::set_accessible_name(&response, "Frame");
            if response.changed() {
                self.playing = None;
                actions.push(Command::GoToTime((frame - 1.0) / FRAMES_PER_SECOND).into());
            }
            ui.label(format!("{:.2} s", document.seconds));
            let commands =
                [CommandId::KeyLens, CommandId::KeyLayer, CommandId::RemoveKeys, CommandId::RackFocus];
            for id in commands {
                let has_key = document.lens_motion.times().any(|seconds| seconds == document.seconds);
                let button = egui::Button::new(id.info().name);
                let response = ui.add_enabled(id != CommandId::RemoveKeys || has_key, button);
                let tip = keys::command_tooltip(ui.ctx(), id);
                if response.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                    actions.push(id.into());
                }
            }
        });
    }

    fn scrub(&mut self, response: &Response, scale: &Scale, actions: &mut Vec<Action>) {
        let tip = "Drag to scrub. Click a key to go to it, drag it to move it.";
        let response = response.clone().on_hover_text_at_pointer(tip);
        if (response.dragged() || response.clicked())
            && let Some(at) = response.interact_pointer_pos()
        {
            self.playing = None;
            actions.push(Command::GoToTime(scale.seconds(at.x)).into());
        }
    }

    fn keys(
        &mut self,
        ui: &Ui,
        document: &Document,
        (row, name): (Row, &str),
        scale: &Scale,
        y: f32,
        actions: &mut Vec<Action>,
    ) {
        for (number, seconds) in row.times(document).into_iter().enumerate() {
            let middle = pos2(scale.x(seconds), y);
            let id = ui.scope_id().with(("key", name, number));
            let rect = Rect::from_center_size(middle, egui::Vec2::splat(2.0 * KEY));
            let response = ui.interact(rect, id, Sense::click_and_drag());
            controls::set_accessible_name(&response, &format!("{name} key at {seconds:.2} s"));
            if response.clicked() {
                self.playing = None;
                actions.push(Command::GoToTime(seconds).into());
            }
            if response.drag_started() {
                self.dragged_key = Some((row, seconds));
            }
            let is_held = self.dragged_key == Some((row, seconds));
            let pointer = response.interact_pointer_pos().filter(|_| is_held);
            if let Some(at) = pointer.filter(|_| response.drag_stopped()) {
                self.dragged_key = None;
                let to = scale.seconds(at.x);
                actions.extend(
                    row.move_key_command(document, seconds, to).filter(|_| to != seconds).map(Action::from),
                );
            }
            let x = pointer.map_or(middle.x, |at| scale.x(scale.seconds(at.x)));
            let is_now = seconds == document.seconds;
            diamond(ui, pos2(x, y), is_now || response.hovered() || is_held);
            response.on_hover_text(format!("{name} at {seconds:.2} s"));
        }
    }
}

fn diamond(ui: &Ui, at: Pos2, is_bright: bool) {
    let visuals = ui.visuals();
    let fill = if is_bright { visuals.selection.stroke.color } else { visuals.text_color() };
    let points = [vec2(0.0, -KEY), vec2(KEY, 0.0), vec2(0.0, KEY), vec2(-KEY, 0.0)].map(|offset| at + offset);
    let edge = Stroke::new(1.0, Color32::from_black_alpha(160));
    ui.painter().add(Shape::convex_polygon(points.to_vec(), fill, edge));
}

/// The seconds along the upper edge.
fn ruler(ui: &Ui, scale: &Scale, all: Rect) {
    let painter = ui.painter();
    painter.rect_filled(all.with_min_x(scale.rect.left() - KEY), 2.0, ui.visuals().extreme_bg_color);
    let faint = ui.visuals().weak_text_color();
    /// Largest number of tick marks that fit.
    const MAX_MARKS: f64 = 12.0;
    let step = [0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 3600.0];
    let step = step.into_iter().find(|step| scale.seconds / step <= MAX_MARKS).unwrap_or(scale.seconds);
    let mut seconds = 0.0;
    while seconds <= scale.seconds {
        let at = pos2(scale.x(seconds), all.top());
        painter.vline(at.x, all.y_range(), Stroke::new(0.5, faint.gamma_multiply(0.4)));
        let text = format!("{} s", controls::significant_digits(seconds));
        painter.text(at + vec2(3.0, 1.0), Align2::LEFT_TOP, text, FontId::proportional(10.0), faint);
        seconds += step;
    }
}

/// The curve of a row, scaled from its minimum at the bottom to its maximum at the top.
fn curve(ui: &Ui, document: &Document, row: Row, scale: &Scale, line: Rect) {
    let time = |k: usize| scale.seconds * k as f64 / (CURVE_POINTS - 1) as f64;
    let values: Option<Vec<f64>> = (0..CURVE_POINTS).map(|k| row.value(document, time(k))).collect();
    let Some(values) = values.filter(|values| values.iter().all(|value| value.is_finite())) else { return };
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    let height = |value: f64| if high > low { ((value - low) / (high - low)) as f32 } else { 0.5 };
    let points = values.iter().enumerate();
    let points =
        points.map(|(k, value)| pos2(scale.x(time(k)), line.bottom() - height(*value) * line.height()));
    ui.painter().line(points.collect(), Stroke::new(1.0, ui.visuals().weak_text_color()));
}
