//! The dialog that asks which end of a depth map is near, with a preview of both answers.

use crate::window::widgets::false_colour::nearness_color;
use document::DepthPolarityRequest;
use egui::{Button, ColorImage, Context, Id, Image, TextureHandle, TextureOptions, vec2};

/// Width of a preview, points.
const WIDTH: f32 = 240.0;

/// The dialog; empty while closed.
#[derive(Default)]
pub struct DepthPolarityDialog {
    pending: Option<(DepthPolarityRequest, [TextureHandle; 2])>,
}

/// The answers: value of `--near`, label, and whether white is near.
const ANSWERS: [(&str, &str, bool); 2] =
    [("white", "White is near", true), ("black", "Black is near", false)];

impl DepthPolarityDialog {
    /// Opens the dialog.
    pub fn open(&mut self, question: DepthPolarityRequest, context: &Context) {
        let textures = ANSWERS.map(|(name, _, is_white)| {
            let share = |nearness: f32| if is_white { nearness } else { 1.0 - nearness };
            let pixels = question.nearness.iter().map(|&nearness| {
                let [r, g, b] = nearness_color(share(nearness));
                egui::Color32::from_rgb(r, g, b)
            });
            let image = ColorImage::new(question.size, pixels.collect());
            context.load_texture(name, image, TextureOptions::LINEAR)
        });
        self.pending = Some((question, textures));
    }

    /// Whether the dialog is open.
    pub fn is_open(&self) -> bool {
        self.pending.is_some()
    }

    /// Draws the dialog. Once answered, returns the question and the value of `--near`.
    pub fn show(&mut self, context: &Context) -> Option<(DepthPolarityRequest, &'static str)> {
        let (question, textures) = self.pending.as_ref()?;
        let mut answer = None;
        let mut is_cancelled = false;
        let frame = egui::Frame::popup(&context.global_style()).inner_margin(14.0);
        let modal = egui::Modal::new(Id::unique("which end is near")).frame(frame).show(context, |ui| {
            ui.heading("Which preview is right?");
            let map = question.map.file_name().unwrap_or_default().to_string_lossy();
            ui.label(format!("{map} does not specify which end is near. Yellow is near, dark blue is far."));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for ((name, label, _), texture) in ANSWERS.into_iter().zip(textures) {
                    ui.vertical(|ui| {
                        let [width, height] = texture.size().map(|side| side as f32);
                        let image =
                            Image::new(texture).fit_to_exact_size(vec2(WIDTH, WIDTH * height / width));
                        let tip = format!("Open it like this; on the command line: --near {name}.");
                        let is_shown =
                            ui.add(image.sense(egui::Sense::click())).on_hover_text(&tip).clicked();
                        let size = vec2(WIDTH, 0.0);
                        if ui.add(Button::new(label).min_size(size)).on_hover_text(tip).clicked() || is_shown
                        {
                            answer = Some(name);
                        }
                    });
                }
            });
            ui.add_space(8.0);
            is_cancelled = ui.button("Cancel").on_hover_text("Open nothing.").clicked();
        });
        if answer.is_none() && !is_cancelled && !modal.should_close() {
            return None;
        }
        let (question, _) = self.pending.take()?;
        answer.map(|answer| (question, answer))
    }
}
