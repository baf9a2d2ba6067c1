//! The photographs of a capture in a row: a click takes the camera of one, a Shift+click makes a camera path
//! to it.

use crate::window::Action;
use crate::window::widgets::controls;
use document::{CameraEdit, Document, camera_between};
use egui::{
    Color32, ColorImage, CornerRadius, Rect, ScrollArea, Sense, Slider, Stroke, TextureHandle, Ui, pos2, vec2,
};
use session::{Command, Session, Thumbnails};
use std::collections::HashMap;

/// Height reserved for the name beneath a picture, points.
const NAME_HEIGHT: f32 = 16.0;
/// Smallest height of a picture, points.
const MIN_HEIGHT: f32 = 40.0;
/// Number of textures from which on all are released.
const MAX_TEXTURES: usize = 400;

/// The strip's state between frames.
#[derive(Default)]
pub struct PhotographStrip {
    thumbnails: Option<Thumbnails>,
    textures: HashMap<usize, TextureHandle>,
    /// The camera path between two photographs.
    path: Option<Path>,
    /// The current photograph that was last scrolled into view.
    scrolled_to: Option<usize>,
}

struct Path {
    from: usize,
    to: usize,
    share: f64,
}

impl PhotographStrip {
    /// Draws the photographs and the controls of the camera path.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, actions: &mut Vec<Action>) {
        let Some(document) = session.document() else { return };
        let scene = &document.stage.scene;
        let count = scene.all_views().count();
        if count == 0 {
            ui.weak("This scene is not a capture: it has no photographs (File, Open a capture…).");
            return;
        }
        if !self.thumbnails.as_ref().is_some_and(|thumbnails| thumbnails.is_for_scene(scene)) {
            let context = ui.ctx().clone();
            let waker = std::sync::Arc::new(move || context.request_repaint());
            // Another scene, even with the same photographs: its thumbnails are read again.
            *self = Self { thumbnails: Some(Thumbnails::new(scene.clone(), waker)), ..Self::default() };
        }
        self.path_ui(ui, document, actions);
        let height = (ui.available_height() - NAME_HEIGHT - 14.0).max(MIN_HEIGHT);
        // The wheel scrolls horizontally, the only possible direction.
        ui.style_mut().always_scroll_the_only_direction = true;
        ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            ui.horizontal(|ui| {
                for number in 0..count {
                    self.picture_ui(ui, document, number, height, actions);
                }
            });
        });
    }

    /// One photograph; thumbnails are read only for those in view.
    fn picture_ui(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        number: usize,
        height: f32,
        actions: &mut Vec<Action>,
    ) {
        let scene = &document.stage.scene;
        let Some(view) = scene.all_views().nth(number) else { return };
        let [columns, rows] = view.lens.size_px().map(|side| side as f32);
        let size = vec2(height * columns / rows, height + NAME_HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        controls::set_accessible_name(&response, &view.name);
        let is_current = document.photograph().is_some_and(|current| current.name == view.name);
        if is_current && self.scrolled_to.replace(number) != Some(number) && !ui.is_rect_visible(rect) {
            response.scroll_to_me(Some(egui::Align::Center));
        }
        if !ui.is_rect_visible(rect) {
            return;
        }
        let picture = rect.with_max_y(rect.bottom() - NAME_HEIGHT);
        let is_left_out = number >= scene.views.len() && scene.picture.is_none();
        let error_text = self.paint_photograph(ui, picture, number, is_left_out);
        let is_end = self.path.as_ref().is_some_and(|path| [path.from, path.to].contains(&number));
        let visuals = ui.visuals();
        if is_current || is_end || response.hovered() {
            let color = if is_current { visuals.selection.stroke.color } else { visuals.weak_text_color() };
            ui.painter().rect_stroke(
                picture,
                CornerRadius::same(2),
                Stroke::new(2.0, color),
                egui::StrokeKind::Inside,
            );
        }
        let color = if is_current { visuals.strong_text_color() } else { visuals.text_color() };
        let name = view.name.rsplit('/').next().unwrap_or(&view.name);
        let galley = ui.painter().layout_no_wrap(name.into(), egui::FontId::proportional(11.0), color);
        let below = pos2((rect.center().x - galley.size().x / 2.0).max(rect.left()), picture.bottom() + 1.0);
        ui.painter().with_clip_rect(rect.intersect(ui.clip_rect())).galley(below, galley, color);
        let left_out = if is_left_out { "\nLeft out: its light is not used." } else { "" };
        let tip = error_text.unwrap_or_else(|| {
            format!(
                "{}, {columns} × {rows} px{left_out}\nClick to use its camera; Shift+click for a camera path \
                 from here.",
                view.name
            )
        });
        let response = response.on_hover_text(tip);
        if response.clicked() {
            let from = self.current_photograph(document);
            match from.filter(|&from| from != number && ui.input(|input| input.modifiers.shift)) {
                Some(from) => self.path = Some(Path { from, to: number, share: 0.0 }),
                None => {
                    self.path = None;
                    use_photograph_camera(document, number, actions);
                }
            }
        }
    }

    /// The photograph whose camera is active, or the start of the camera path.
    fn current_photograph(&self, document: &Document) -> Option<usize> {
        let scene = &document.stage.scene;
        let name = document.photograph().map(|view| &view.name);
        let mut views = scene.all_views();
        let current = name.and_then(|name| views.position(|view| view.name == *name));
        current.or(self.path.as_ref().map(|path| path.from))
    }

    /// Draws a photograph if its thumbnail is loaded. Returns the error if it cannot be read.
    fn paint_photograph(&mut self, ui: &Ui, rect: Rect, number: usize, is_left_out: bool) -> Option<String> {
        let painter = ui.painter();
        if !self.textures.contains_key(&number) {
            match self.thumbnails.as_ref().and_then(|thumbnails| thumbnails.get(number)) {
                Some(Ok(small)) => {
                    if self.textures.len() >= MAX_TEXTURES {
                        self.textures.clear();
                    }
                    let image = ColorImage::from_rgba_unmultiplied(small.size, small.pixels.as_flattened());
                    let name = format!("photograph {number}");
                    self.textures
                        .insert(number, ui.ctx().load_texture(name, image, egui::TextureOptions::LINEAR));
                }
                Some(Err(why)) => {
                    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
                    painter.text(
                        rect.center(),
                        egui::Align2::CENTER_CENTER,
                        "not read",
                        egui::FontId::proportional(11.0),
                        ui.visuals().error_fg_color,
                    );
                    return Some(why.to_string());
                }
                None => {}
            }
        }
        match self.textures.get(&number) {
            Some(texture) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                let tint = if is_left_out { Color32::from_white_alpha(110) } else { Color32::WHITE };
                painter.image(texture.id(), rect, whole, tint);
            }
            None => drop(painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color)),
        }
        None
    }

    /// Slider of the camera path between two photographs.
    fn path_ui(&mut self, ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
        let Some(path) = &mut self.path else { return };
        let scene = &document.stage.scene;
        let name = |number: usize| scene.all_views().nth(number).map_or("", |view| view.name.as_str());
        let mut is_over = false;
        ui.horizontal(|ui| {
            ui.label(name(path.from));
            ui.spacing_mut().slider_width = 240.0;
            let slider = Slider::new(&mut path.share, 0.0..=1.0).show_value(false);
            let response =
                ui.add(slider).on_hover_text("Position of the camera on the path between the photographs.");
            controls::set_accessible_name(&response, "Way between two photographs");
            ui.label(name(path.to));
            if response.changed()
                && let (Some(from), Some(to)) =
                    (photograph_camera(document, path.from), photograph_camera(document, path.to))
            {
                let camera = camera_between(&from, &to, path.share);
                actions.push(Command::EditCamera(CameraEdit::Whole(Box::new(camera))).into());
            }
            controls::finish_edit(&response, actions);
            is_over = ui
                .button("Done")
                .on_hover_text("Ends the camera path; the camera stays where it is.")
                .clicked();
        });
        if is_over {
            self.path = None;
        }
    }
}

fn photograph_camera(document: &Document, number: usize) -> Option<lens::Camera> {
    document.photograph_cameras().nth(number)
}

fn use_photograph_camera(document: &Document, number: usize, actions: &mut Vec<Action>) {
    if let Some(camera) = photograph_camera(document, number) {
        actions.push(Command::EditCamera(CameraEdit::Whole(Box::new(camera))).into());
        actions.push(Command::FinishEdit.into());
    }
}
