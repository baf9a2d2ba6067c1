//! Short messages that need no interaction, failures and notices; a window lists those that are gone.

use crate::window::widgets::theme;
use egui::{Align2, Context, Frame, Id, Order, RichText, ScrollArea, Window};

/// Display time of a notice, s.
const NOTICE_SECONDS: f64 = 5.0;
/// Display time of an error, s: long enough to read a path.
const ERROR_SECONDS: f64 = 20.0;
/// Maximum number of messages; the oldest are removed.
const MAX_SHOWN: usize = 5;
/// Maximum number of messages in the list.
const MAX_LISTED: usize = 100;

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Information.
    Notice,
    /// A failure.
    Error,
}

struct Toast {
    severity: Severity,
    text: String,
    /// When it disappears, in the window's time; set when first shown.
    until: Option<f64>,
}

/// The messages on screen.
#[derive(Default)]
pub struct Toasts {
    shown: Vec<Toast>,
    /// All messages of this session, the latest last.
    log: Vec<(Severity, String)>,
    /// Whether the list is open.
    pub is_list_open: bool,
}

impl Toasts {
    /// Shows a notice.
    pub fn notice(&mut self, text: impl Into<String>) {
        self.push(Severity::Notice, text.into());
    }

    /// Shows an error, with the message that the command line would print.
    pub fn error(&mut self, text: impl Into<String>) {
        self.push(Severity::Error, text.into());
    }

    /// The texts of the messages on screen, oldest first, with their severity.
    pub fn texts(&self) -> impl Iterator<Item = (Severity, &str)> {
        self.shown.iter().map(|toast| (toast.severity, toast.text.as_str()))
    }

    fn push(&mut self, severity: Severity, text: String) {
        // A repeated message only stays longer.
        self.shown.retain(|toast| toast.text != text);
        if self.log.last().is_none_or(|(_, last)| *last != text) {
            self.log.push((severity, text.clone()));
            let surplus = self.log.len().saturating_sub(MAX_LISTED);
            self.log.drain(..surplus);
        }
        self.shown.push(Toast { severity, text, until: None });
        if self.shown.len() > MAX_SHOWN {
            self.shown.remove(0);
        }
    }

    /// Draws the messages below the tools, where they cover no legend, and the list if it is open.
    pub fn show(&mut self, context: &Context) {
        self.show_list(context);
        let now = context.input(|input| input.time);
        self.shown.retain(|toast| toast.until.is_none_or(|until| until > now));
        if self.shown.is_empty() {
            return;
        }
        let mut closed = None;
        let area = egui::Area::new(Id::unique("toasts")).order(Order::Foreground);
        area.anchor(Align2::CENTER_TOP, [0.0, 84.0]).show(context, |ui| {
            for (index, toast) in self.shown.iter_mut().enumerate() {
                let stay = if toast.severity == Severity::Error { ERROR_SECONDS } else { NOTICE_SECONDS };
                let until = *toast.until.get_or_insert(now + stay);
                context.request_repaint_after_secs((until - now).max(0.05) as f32);
                if show_toast(ui, toast) {
                    closed = Some(index);
                }
            }
        });
        if let Some(index) = closed {
            self.shown.remove(index);
        }
    }
}

impl Toasts {
    /// The list of messages, the latest first.
    fn show_list(&mut self, context: &Context) {
        let window = Window::new("Messages").open(&mut self.is_list_open).default_size([520.0, 320.0]);
        let window = window.pivot(Align2::CENTER_CENTER).default_pos(context.content_rect().center());
        window.collapsible(false).show(context, |ui| {
            ScrollArea::vertical().auto_shrink([false; 2]).show(ui, |ui| {
                if self.log.is_empty() {
                    ui.weak("There were none.");
                }
                for (severity, text) in self.log.iter().rev() {
                    let text = RichText::new(text);
                    let text = if *severity == Severity::Error { text.color(theme::ERROR) } else { text };
                    ui.add(egui::Label::new(text).wrap().selectable(true));
                    ui.separator();
                }
            });
        });
    }
}

/// Draws a message. Returns whether it was closed.
fn show_toast(ui: &mut egui::Ui, toast: &Toast) -> bool {
    let mut closed = false;
    Frame::popup(ui.style()).inner_margin(8.0).show(ui, |ui| {
        ui.set_max_width(520.0);
        ui.horizontal_top(|ui| {
            if toast.severity == Severity::Error {
                ui.label(RichText::new("error:").color(theme::ERROR).strong());
            }
            ui.vertical(|ui| {
                ui.set_max_width(400.0);
                ui.add(egui::Label::new(&toast.text).wrap().selectable(true));
            });
            if ui.button("Copy").on_hover_text("Copy this message.").clicked() {
                ui.ctx().copy_text(toast.text.clone());
            }
            closed = ui.button("Close").on_hover_text("Remove this message.").clicked();
        });
    });
    closed
}
