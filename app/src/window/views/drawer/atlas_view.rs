//! The flat atlas: every chart in the false colours of its blur; it can be painted on in 2D.

use crate::window::Action;
use crate::window::tools::active_tool::ActiveTool;
use crate::window::widgets::{controls, false_colour};
use document::{Document, StrokePoint, StrokeTarget};
use egui::{Color32, ColorImage, Pos2, Rect, Sense, TextureHandle, TextureOptions, Ui, pos2, vec2};
use focus::FocusMap;
use glam::DVec2;
use rayon::prelude::*;
use session::{Command, Session};

/// Longest side of the drawn atlas, px: larger maps are subsampled.
const MAX_SIDE_PX: u32 = 1024;

/// The atlas's state between frames.
#[derive(Default)]
pub struct AtlasView {
    texture: Option<TextureHandle>,
    /// The inputs from which the texture was made.
    texture_key: Option<(FocusMap, lens::Camera)>,
    rect: Option<Rect>,
    painting: bool,
}

impl AtlasView {
    /// Where the atlas is on screen.
    pub fn rect(&self) -> Rect {
        self.rect.unwrap_or(Rect::NOTHING)
    }

    /// Draws the atlas and turns the pointer into strokes.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        active_tool: &ActiveTool,
        actions: &mut Vec<Action>,
    ) {
        let Some(document) = session.document() else { return };
        let (area, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(8.0, 8.0)), Sense::click_and_drag());
        controls::set_accessible_name(&response, "Atlas view");
        self.draw(ui, document);
        let [width, height] = document.map.size().map(|side| side as f32);
        let scale = (area.width() / width).min(area.height() / height).max(1e-3);
        let rect = Rect::from_center_size(area.center(), vec2(width, height) * scale);
        self.rect = Some(rect);
        if let Some(texture) = &self.texture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter_at(area).image(texture.id(), rect, whole, Color32::WHITE);
        }
        let atlas_position = |at: Pos2| {
            let share = (at - rect.min) / rect.size();
            DVec2::new(share.x.into(), share.y.into())
        };
        let hit_at = |at: Pos2| document.stage.surface_at(atlas_position(at));
        if response.hovered() {
            ui.set_cursor_icon(egui::CursorIcon::Crosshair);
        }
        self.paint(ui, &response, session, active_tool, atlas_position, actions);
        if let Some(hit) = response.hover_pos().and_then(hit_at) {
            let chart = document.stage.atlas.chart_of[hit.point.triangle as usize];
            let part = document.scene().triangles[hit.point.triangle as usize].part;
            let node = document.scene().parts[part as usize].node;
            let name = &document.scene().nodes[node as usize].name;
            let at = area.left_top() + vec2(6.0, 4.0);
            let font = egui::FontId::proportional(12.0);
            let text = format!("{name}, chart {chart}");
            ui.painter().text(at, egui::Align2::LEFT_TOP, text, font, ui.visuals().text_color());
        }
    }

    /// Strokes on the flat atlas. Dabs are round on the surface: they continue across chart edges.
    fn paint(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        session: &Session,
        active_tool: &ActiveTool,
        place_of: impl Fn(Pos2) -> DVec2,
        actions: &mut Vec<Action>,
    ) {
        let Some(document) =
            session.document().filter(|_| active_tool.tool.paints() && !active_tool.is_adjusting_brush)
        else {
            return;
        };
        let point = |at| StrokePoint { target: StrokeTarget::Atlas(at), pressure: 1.0 };
        let pointer = response.interact_pointer_pos().map(place_of);
        let is_here = response.is_pointer_button_down_on() || response.clicked();
        let pressed = is_here && ui.input(|input| input.pointer.primary_pressed());
        self.painting &= session.is_painting();
        if pressed && let Some(at) = pointer.filter(|at| document.stage.surface_at(*at).is_some()) {
            let mode = active_tool.tool.mode(document.brush.mode);
            if mode != document.brush.mode {
                actions.push(Command::SetBrush(focus::Brush { mode, ..document.brush.clone() }).into());
            }
            actions.push(Command::BeginStroke(point(at)).into());
            self.painting = true;
        } else if self.painting && !ui.input(|input| input.pointer.primary_down()) {
            actions.push(Command::CommitStroke.into());
            self.painting = false;
        } else if self.painting
            && response.dragged()
            && ui.input(|input| input.pointer.is_moving())
            && let Some(at) = pointer
        {
            actions.push(Command::ExtendStroke(point(at)).into());
        }
    }

    /// Brings the texture up to date.
    fn draw(&mut self, ui: &Ui, document: &Document) {
        let fits = |(map, camera): &(FocusMap, lens::Camera)| {
            map.shares_tiles_with(&document.map) && *camera == document.camera
        };
        if self.texture_key.as_ref().is_some_and(fits) {
            return;
        }
        let [width, height] = document.map.size();
        let step = width.max(height).div_ceil(MAX_SIDE_PX).max(1);
        let size = [width.div_ceil(step), height.div_ceil(step)];
        let (camera, optics) = (&document.camera, document.camera.optics());
        let empty = ui.visuals().extreme_bg_color;
        let texels = &document.stage.texels;
        let pixel = |index: u32| {
            let [x, y] = [index % size[0] * step, index / size[0] * step];
            let Some(covered) = texels.index.get((y * width + x) as usize) else { return empty };
            let Some(texel) = texels.texels.get(*covered as usize) else { return empty };
            let depth = camera.camera_from_world(texel.centroid.position(document.scene())).z;
            if depth <= 0.0 {
                return Color32::from_gray(90);
            }
            let kappa = optics.kappa(1.0 / depth, document.map.at(x, y));
            false_colour::color(2.0 * optics.splat_radius_px(kappa))
        };
        let pixels: Vec<Color32> = (0..size[0] * size[1]).into_par_iter().map(pixel).collect();
        let image = ColorImage::new(size.map(|side| side as usize), pixels);
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => self.texture = Some(ui.ctx().load_texture("atlas", image, TextureOptions::LINEAR)),
        }
        self.texture_key = Some((document.map.clone(), document.camera.clone()));
    }
}
