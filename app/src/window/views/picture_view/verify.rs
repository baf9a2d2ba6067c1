//! Verification of a rectangle of the picture by ray tracing: selection, display and error.

use crate::window::Action;
use crate::window::widgets::controls;
use egui::{
    Color32, ColorImage, Key, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, TextureHandle,
    TextureOptions, Ui, UiBuilder, pos2, vec2,
};
use glam::DVec2;
use render::{Tone, to_screen};
use session::{Command, Session, VerifiedError};

/// What is shown in the rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
enum RegionDisplay {
    /// The ray-traced picture.
    #[default]
    Truth,
    /// Where the live picture differs from it.
    Error,
    /// The live picture.
    Live,
}

/// State of the verification in the view.
#[derive(Default)]
pub struct Verify {
    /// Whether the next drag draws the rectangle, and where it started.
    selecting: Option<Option<Pos2>>,
    display: RegionDisplay,
    texture: Option<TextureHandle>,
    /// The inputs of texture and error: picture, samples, display, tone.
    texture_key: Option<(u64, u32, RegionDisplay, Tone)>,
    error: Option<VerifiedError>,
}

impl Verify {
    /// Starts or cancels selecting a rectangle with the next drag.
    pub fn toggle_selecting(&mut self) {
        self.selecting = if self.selecting.is_none() { Some(None) } else { None };
    }

    /// Whether a rectangle is being selected.
    pub fn is_selecting(&self) -> bool {
        self.selecting.is_some()
    }

    /// Selects the rectangle by pointer; `position` maps a screen position to the picture, in [0, 1]².
    pub fn select(
        &mut self,
        ui: &Ui,
        response: &Response,
        image: Rect,
        position: impl Fn(Pos2) -> DVec2,
        actions: &mut Vec<Action>,
    ) {
        let Some(start) = self.selecting else { return };
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            self.selecting = None;
            return;
        }
        ui.set_cursor_icon(egui::CursorIcon::Crosshair);
        let down = ui.input(|input| input.pointer.button_down(PointerButton::Primary));
        let pressed = ui.input(|input| input.pointer.primary_pressed());
        let pointer = response.interact_pointer_pos().map(|at| image.clamp(at));
        match (start, pointer) {
            (None, Some(at)) if pressed && response.is_pointer_button_down_on() => {
                self.selecting = Some(Some(at));
            }
            (Some(from), Some(at)) if down => {
                let rect = Rect::from_two_pos(from, at);
                outline(ui, rect, image);
            }
            (Some(from), _) if !down => {
                let end = pointer.or_else(|| ui.input(|input| input.pointer.latest_pos()));
                let end = end.map_or(from, |at| image.clamp(at));
                self.selecting = None;
                if from.distance(end) > 3.0 {
                    let corners = [from, end].map(position);
                    actions.push(Command::VerifyRegion(corners).into());
                }
            }
            _ => {}
        }
    }

    /// Shows the verified rectangle over the picture at `image`.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        image: Rect,
        view: Rect,
        tone: Tone,
        actions: &mut Vec<Action>,
    ) {
        let (Some(verification), Some(preview)) = (session.verification(), session.preview()) else {
            *self = Self { selecting: self.selecting, display: self.display, ..Self::default() };
            return;
        };
        let (region, camera) = (verification.region, &verification.camera);
        let corner = |x: u32, y: u32| {
            image.min + vec2(x as f32 / camera.width as f32, y as f32 / camera.height as f32) * image.size()
        };
        let rect = Rect::from_min_max(
            corner(region.x, region.y),
            corner(region.x + region.width, region.y + region.height),
        );
        let samples = verification.estimate.as_ref().map_or(0, |estimate| estimate.samples_per_pixel);
        let texture_key = Some((preview.id, samples, self.display, tone));
        if let Some(estimate) = verification.estimate.as_ref().filter(|_| self.texture_key != texture_key) {
            self.texture_key = texture_key;
            self.error = verification.error_of(preview, tone.exposure).and_then(Result::ok);
            let size = [region.width as usize, region.height as usize];
            let pixels = match (self.display, &self.error) {
                (RegionDisplay::Truth, _) => {
                    let rgb = to_screen(&estimate.picture, tone);
                    Some(rgb.iter().map(|[r, g, b, _]| Color32::from_rgb(*r, *g, *b)).collect())
                }
                (RegionDisplay::Error, Some(error)) => {
                    let rgb = error.map.chunks_exact(3);
                    Some(rgb.map(|rgb| Color32::from_rgb(rgb[0], rgb[1], rgb[2])).collect())
                }
                (RegionDisplay::Error, None) | (RegionDisplay::Live, _) => None,
            };
            self.texture = pixels.map(|pixels| {
                ui.ctx().load_texture("verified", ColorImage::new(size, pixels), TextureOptions::LINEAR)
            });
        }
        if let Some(texture) = self.texture.as_ref().filter(|_| self.display != RegionDisplay::Live) {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter_at(view).image(texture.id(), rect, whole, Color32::WHITE);
        }
        outline(ui, rect, view);
        self.controls(ui, session, rect, view, samples, actions);
    }

    /// The bar beneath the rectangle: choice of display, error of the picture, and a close button.
    fn controls(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        rect: Rect,
        view: Rect,
        samples: u32,
        actions: &mut Vec<Action>,
    ) {
        let size = vec2(340.0f32.min(view.width() - 8.0), 46.0);
        let below = rect.bottom() + 4.0 + size.y <= view.bottom();
        let y = if below { rect.bottom() + 4.0 } else { (rect.top() - 4.0 - size.y).max(view.top()) };
        let x = rect.left().clamp(view.left() + 4.0, (view.right() - size.x - 4.0).max(view.left() + 4.0));
        let place = Rect::from_min_size(pos2(x, y), size);
        ui.painter_at(view).rect_filled(place, 3.0, Color32::from_black_alpha(190));
        let text = match (&self.error, samples) {
            (_, 0) => "Tracing rays…".to_string(),
            _ if !session.is_verification_current() => {
                "Traced before the last change (press R and drag to verify again).".to_string()
            }
            (None, _) => format!("{samples} rays per pixel; the picture is still being drawn."),
            (Some(error), _) => format!(
                "PSNR {:.1} dB, mean {:+.2} %, {samples} rays per pixel (accurate to {:.0} dB)",
                error.psnr,
                error.signed_mean_error * 100.0,
                error.noise_psnr.min(200.0),
            ),
        };
        ui.scope_builder(UiBuilder::new().max_rect(place.shrink(4.0)), |ui| {
            ui.horizontal(|ui| {
                let choices = [
                    (RegionDisplay::Truth, "Rays", "Show the ray-traced picture in the rectangle."),
                    (
                        RegionDisplay::Error,
                        "Error",
                        "Show where the live picture differs: black where it looks the same (FLIP).",
                    ),
                    (RegionDisplay::Live, "Live", "Show the live picture in the rectangle."),
                ];
                for (choice, name, tip) in choices {
                    ui.selectable_value(&mut self.display, choice, name).on_hover_text(tip);
                }
                let close = ui.button("Close").on_hover_text("Stop tracing and remove the rectangle.");
                controls::set_accessible_name(&close, "Close verification");
                if close.clicked() {
                    actions.push(Command::EndVerification.into());
                }
            });
            ui.label(egui::RichText::new(text).size(11.0)).on_hover_text(
                "Error of the live picture against the ray-traced one: peak signal-to-noise ratio, and mean \
                 difference. The noise of the rays limits the accuracy.",
            );
        });
    }
}

fn outline(ui: &Ui, rect: Rect, within: Rect) {
    let painter = ui.painter_at(within.expand(2.0));
    painter.rect_stroke(rect, 0.0, Stroke::new(3.0, Color32::from_black_alpha(140)), StrokeKind::Middle);
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, Color32::WHITE), StrokeKind::Middle);
}
