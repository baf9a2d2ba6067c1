//! The panels, the active tool over the views, and the surface under the pointer.

use super::Shell;
use crate::window::chrome::status_line::Hover;
use crate::window::chrome::view_header::{ViewHeader, panel_menu};
use crate::window::layout::{DockState, Pane, PaneContents};
use crate::window::tools::active_tool::ActiveTool;
use crate::window::tools::brush_ring::BrushRing;
use crate::window::views::drawer::Drawer;
use crate::window::views::inspector::{Inspected, Inspector};
use crate::window::views::paint_view::PaintView;
use crate::window::views::picture_view::PictureView;
use crate::window::widgets::brush_controls::signed_circle_px;
use crate::window::{Action, Tool, ViewSettings};
use document::SurfaceHit;
use egui::{Context, Ui};
use project::PresetLibrary;
use session::{PreviewActivity, Session};

/// Shorter work is not reported in the status line.
const MIN_NOTICEABLE_SECONDS: f64 = 0.5;

/// Smallest height of a view with room for the hint at first start, points.
const MIN_HEIGHT_FOR_HINT: f32 = 220.0;

impl Shell {
    /// Whether the picture has been summing for a noticeable time.
    pub(super) fn is_drawing_noticeably(&mut self, context: &Context) -> bool {
        if self.session.preview_activity() != PreviewActivity::Splatting {
            self.drawing_since = None;
            return false;
        }
        let now = context.input(|input| input.time);
        let since = *self.drawing_since.get_or_insert(now);
        context.request_repaint_after_secs(0.25);
        now - since > MIN_NOTICEABLE_SECONDS
    }

    pub(super) fn hovered_surface(&self) -> Option<document::SurfaceHit> {
        self.paint.hover().or(self.picture.hover())
    }

    /// The numbers of the surface point under the pointer.
    pub(super) fn hover_numbers(&self) -> Option<Hover> {
        let hit = self.hovered_surface()?;
        let document = self.session.document()?;
        let focus = self.session.focus_at(&hit)?;
        let depth = document.camera.camera_from_world(hit.position).z;
        let optics = document.camera.optics();
        let circle_of = |focus| 2.0 * optics.splat_radius_px(optics.kappa(1.0 / depth, focus));
        let becomes_px = self.tool.paints_focus(&document.brush).map(circle_of);
        let scene = document.scene();
        let node = scene.parts[scene.triangles[hit.point.triangle as usize].part as usize].node;
        let object = scene.nodes[node as usize].name.clone();
        (depth > 0.0).then(|| {
            let circle_px = circle_of(focus);
            Hover {
                object,
                depth,
                circle_px,
                becomes_px,
                t: focus.t,
                anchor: focus.anchor,
                gloss: focus.gloss,
            }
        })
    }

    pub(super) fn brush_ring(&self) -> Option<BrushRing> {
        let shows_ring = self.tool.paints() || self.tool.depth_repair().is_some();
        let document = self.session.document().filter(|_| shows_ring)?;
        let brush = &document.brush;
        let circle_px = match self.tool {
            Tool::Brush => signed_circle_px(&document.camera.optics(), brush.target.t),
            _ => 0.0,
        };
        // Normals of a surface made from depth are noisy: there the ring faces the camera of the picture.
        let scene = document.scene();
        let axis = || scene.cameras.first().map(|camera| camera.camera_to_world.z_axis.truncate());
        let facing = scene.picture.as_ref().and_then(|_| axis());
        Some(BrushRing { radius: brush.radius, hardness: brush.hardness, circle_px, facing })
    }

    /// The active tool with its settings.
    pub(super) fn active_tool(&self) -> ActiveTool {
        ActiveTool {
            tool: self.tool,
            settings: self.settings.tools.clone(),
            is_adjusting_brush: self.gesture.has_input(),
            ring: self.brush_ring(),
            stabiliser_points: self.settings.stabiliser,
        }
    }

    pub(super) fn panels(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        let active_tool = self.active_tool();
        let hover = self.hovered_surface();
        let Self {
            layout,
            paint,
            picture,
            session,
            settings,
            presets,
            inspector,
            drawer,
            hovered_pane: pointed,
            tool,
            ..
        } = self;
        let mut contents = PanelContents {
            paint,
            picture,
            inspector,
            drawer,
            session,
            settings,
            presets,
            tool: *tool,
            active_tool: &active_tool,
            hover,
            hovered_pane: pointed,
            drawn: Vec::new(),
            actions,
        };
        layout.ui(ui, &mut contents);
        let drawn = contents.drawn;
        // A view that is not drawn has no hovered point.
        if !drawn.contains(&Pane::Paint) {
            self.paint.pointer_left();
        }
        if !drawn.contains(&Pane::Picture) {
            self.picture.pointer_left();
        }
    }

    /// The hint at first start: three lines over the demo, until dismissed.
    pub(super) fn first_hint(&mut self, context: &Context) {
        if !self.showing_demo || self.settings.hint_dismissed || self.session.document().is_none() {
            return;
        }
        let rect = if self.layout.is_shown(Pane::Picture) { self.picture.rect() } else { self.paint.rect() };
        // In a small view it would cover what it describes.
        if rect.height() < MIN_HEIGHT_FOR_HINT {
            return;
        }
        let area = egui::Window::new("Try this").collapsible(false).resizable(false).title_bar(false);
        area.fixed_pos(rect.left_top() + egui::vec2(12.0, 12.0)).show(context, |ui| {
            ui.set_max_width((rect.width() - 60.0).clamp(160.0, 420.0));
            ui.label("Drag over the picture: what you paint becomes sharp.");
            ui.label("Move the slider above toward near or far to paint blur instead.");
            ui.label("Middle drag (or Alt+drag) turns the camera; a right click shows more; Ctrl+Z undoes anything.");
            if ui.button("Got it").clicked() {
                self.settings.hint_dismissed = true;
            }
        });
    }
}

/// The contents of the panels.
struct PanelContents<'a> {
    paint: &'a mut PaintView,
    picture: &'a mut PictureView,
    inspector: &'a mut Inspector,
    drawer: &'a mut Drawer,
    session: &'a Session,
    settings: &'a mut ViewSettings,
    presets: &'a PresetLibrary,
    tool: Tool,
    active_tool: &'a ActiveTool,
    hover: Option<SurfaceHit>,
    /// The panel that the pointer was over last.
    hovered_pane: &'a mut Pane,
    /// The panels drawn in this frame.
    drawn: Vec<Pane>,
    actions: &'a mut Vec<Action>,
}

impl PaneContents for PanelContents<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, pane: Pane, docked: DockState) -> bool {
        self.drawn.push(pane);
        if ui.rect_contains_pointer(ui.max_rect()) {
            *self.hovered_pane = pane;
        }
        // A panel that does not float lies directly on the window, which has the same colour.
        if pane.is_foldable() && docked == DockState::Floating {
            ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        }
        let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
        let Self { session, active_tool, actions, settings, picture, .. } = self;
        let dragged = ViewHeader { pane, docked, session, settings, picture }.show(ui, actions);
        match pane {
            Pane::Paint => self.paint.ui(ui, session, active_tool, settings.surface_appearance(), actions),
            Pane::Picture => picture.ui(ui, session, active_tool, settings, actions),
            Pane::Inspector
            | Pane::Atlas
            | Pane::Aperture
            | Pane::Histogram
            | Pane::Photographs
            | Pane::Timeline => {
                ui.spacing_mut().item_spacing.y = spacing;
                let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 2));
                frame.show(ui, |ui| match pane {
                    Pane::Inspector => {
                        let (presets, tool, hover) = (self.presets, self.tool, self.hover);
                        let inspected = Inspected { session, presets, tool, hover };
                        self.inspector.ui(ui, inspected, settings, actions);
                    }
                    _ => self.drawer.ui(ui, session, pane, active_tool, actions),
                });
            }
        }
        dragged
    }

    fn tabs_ui(&mut self, ui: &mut Ui, pane: Pane) {
        panel_menu(ui, pane, DockState::Tab, self.actions);
    }
}
