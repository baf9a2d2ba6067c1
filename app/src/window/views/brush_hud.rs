//! What a right click in a view opens: the brush's parameters at the pointer, and what can be done with the surface there.

use crate::window::Action;
use crate::window::tools::tool::Tool;
use crate::window::widgets::brush_controls::{
    hardness_slider, largest_radius, push_brush_change, size_slider, strength_slider, target_slider,
};
use crate::window::widgets::controls;
use crate::window::widgets::icon::Icon;
use document::{Document, FillRegion, SurfaceHit};
use egui::{Popup, PopupCloseBehavior, Response, Ui};
use focus::CombineMode;
use lens::FocusOffset;
use session::{Command, Session};

/// Width of its contents, points.
const WIDTH: f32 = 232.0;

/// Width of the labels before the sliders, points.
const LABEL_WIDTH: f32 = 64.0;

/// The brush at the pointer.
#[derive(Default)]
pub struct BrushHud {
    /// The surface under the right click that opened it.
    hit: Option<SurfaceHit>,
}

impl BrushHud {
    /// Whether it is open: a click beside it closes it and does nothing else.
    pub fn is_open(response: &Response) -> bool {
        response.context_menu_opened()
    }

    /// Opens it on a right click on `response`, over the surface `hover`, and shows it while it is open.
    pub fn show(
        &mut self,
        response: &Response,
        session: &Session,
        hover: Option<SurfaceHit>,
        actions: &mut Vec<Action>,
    ) {
        let Some(document) = session.document() else { return };
        if response.secondary_clicked() {
            self.hit = hover;
        }
        let popup = Popup::context_menu(response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        popup.show(|ui| {
            ui.set_width(WIDTH);
            brush_rows(ui, document, actions);
            if let Some(hit) = self.hit {
                ui.separator();
                surface_entries(ui, document, hit, actions);
            }
        });
    }
}

fn brush_rows(ui: &mut Ui, document: &Document, actions: &mut Vec<Action>) {
    let mut brush = document.brush.clone();
    if let Some(target) = target_slider(ui, &document.camera.optics(), brush.target, WIDTH) {
        brush.target = target;
    }
    ui.spacing_mut().slider_width = WIDTH - LABEL_WIDTH - ui.spacing().item_spacing.x;
    let largest = largest_radius(document);
    egui::Grid::new("brush").num_columns(2).min_col_width(LABEL_WIDTH).show(ui, |ui| {
        size_slider(ui, &mut brush, largest);
        ui.end_row();
        strength_slider(ui, &mut brush);
        ui.end_row();
        hardness_slider(ui, &mut brush);
        ui.end_row();
    });
    push_brush_change(document, brush, actions);
}

fn surface_entries(ui: &mut Ui, document: &Document, hit: SurfaceHit, actions: &mut Vec<Action>) {
    let scene = document.scene();
    let part = &scene.parts[scene.triangles[hit.point.triangle as usize].part as usize];
    ui.weak(&scene.nodes[part.node as usize].name);
    let object = FillRegion::Node(hit);
    let target = document.brush.target;
    let sharp = FocusOffset::SHARP.with_gloss(target.gloss);
    let entries: [(Icon, &str, Tool, Action); 6] = [
        (Icon::FocusHere, "Focus the lens here", Tool::FocusHere, Command::FocusHere(hit).into()),
        (Icon::SharpHere, "Make the object sharp", Tool::SharpHere, Command::Fill(object, sharp).into()),
        (Icon::Fill, "Fill the object", Tool::FillObject, Command::Fill(object, target).into()),
        (
            Icon::SelectObject,
            "Select the object",
            Tool::SelectObject,
            Command::SelectRegion(object, CombineMode::Replace).into(),
        ),
        (Icon::Pick, "Pick up this focus", Tool::Pick, Command::Pick(hit).into()),
        (Icon::Inspect, "Look through the aperture", Tool::Inspect, Action::Inspect(hit)),
    ];
    for (icon, name, tool, action) in entries {
        if controls::icon_entry(ui, icon, name, String::new()).on_hover_text(tool.tip()).clicked() {
            actions.push(action);
            ui.close();
        }
    }
}
