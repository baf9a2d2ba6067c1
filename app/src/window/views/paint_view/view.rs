//! The paint view as a panel: the surface, pointer input, the brush ring and the shot camera's frame.

use super::changed_pixels::changed_pixels;
use super::legend;
use super::orbit_camera::POINTS_PER_STEP;
use super::surface_overlay::{OverlayKind, SurfaceOverlay};
use super::{FocusTexture, GraphicsError, OrbitCamera, Stale, SurfaceFrame, SurfaceMesh, SurfaceRenderer};
use crate::window::Action;
use crate::window::graphics::blit::{self, Blitter, Drawable, Filter};
use crate::window::tools::active_tool::ActiveTool;
use crate::window::tools::brush_ring;
use crate::window::tools::drag_tool::DragView;
use crate::window::tools::navigation;
use crate::window::tools::region_highlight::RegionHighlight;
use crate::window::tools::stroke_input::StrokeInput;
use crate::window::view_settings::SurfaceAppearance;
use crate::window::views::brush_hud::BrushHud;
use crate::window::widgets::theme;
use document::{Document, SurfaceHit};
use egui::{Color32, Pos2, Rect, Response, Sense, Stroke, Ui, pos2, vec2};
use glam::{DVec2, DVec3};
use lens::Camera;
use light::PhotographLight;
use session::Session;
use std::ops::Range;
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// Margin around the picture when looking through the shot camera, as a factor.
const FRAME_MARGIN: f64 = 1.06;

/// While the shot camera is moved, a software adapter draws the view that follows it once in so long, s: most of the processor is left to the
/// picture.
const FOLLOWING_SECONDS: f64 = 0.5;

/// Key of the viewpoint in the saved document.
const VIEWPOINT_KEY: &str = "paint_view";
/// Pivot distance for a shot camera that focuses at infinity.
pub const PIVOT_AT_INFINITY: f64 = 10.0;

/// The 3D view for painting.
pub struct PaintView {
    blitter: Option<Blitter>,
    renderer: Option<SurfaceRenderer>,
    mesh: Option<SurfaceMesh>,
    upload: Option<mpsc::Receiver<Result<SurfaceMesh, GraphicsError>>>,
    /// The overlay that is shown or being uploaded.
    overlay: OverlayKind,
    focus: Option<FocusTexture>,
    /// The part of the drawn surface that is out of date.
    stale: Stale,
    drawn: Option<Drawable>,
    problem: Option<String>,
    camera: OrbitCamera,
    stroke: StrokeInput,
    hud: BrushHud,
    /// The surface point under the pointer.
    hover: Option<SurfaceHit>,
    highlight: RegionHighlight,
    rect: Rect,
    /// Width and height, px.
    size: [u32; 2],
    /// Whether to look through the shot camera from the next frame on.
    snap_to_camera: bool,
    /// The view through the shot camera while it is followed.
    following: Option<OrbitCamera>,
    /// The camera that was drawn last, and when, s.
    last_drawn: Option<(OrbitCamera, f64)>,
}

impl PaintView {
    /// An empty view. Without a graphics state it only shows an error.
    pub fn new(state: Option<&egui_wgpu::RenderState>, blitter: Option<&Blitter>) -> Self {
        let mut problem = None;
        let renderer = state.and_then(|state| match SurfaceRenderer::new(state) {
            Ok(renderer) => Some(renderer),
            Err(error) => {
                problem = Some(error.to_string());
                None
            }
        });
        if state.is_none() {
            problem = Some(
                "paint view: there is no graphics adapter (install a Vulkan driver; painting in \
                            the picture works)"
                    .into(),
            );
        }
        Self {
            blitter: blitter.cloned(),
            renderer,
            mesh: None,
            upload: None,
            overlay: OverlayKind::default(),
            focus: None,
            stale: Stale::Everything,
            drawn: None,
            problem,
            camera: OrbitCamera::default(),
            stroke: StrokeInput::default(),
            hud: BrushHud::default(),
            hover: None,
            highlight: RegionHighlight::default(),
            rect: Rect::NOTHING,
            size: [1; 2],
            snap_to_camera: false,
            following: None,
            last_drawn: None,
        }
    }

    /// Shows another document; its surface is uploaded in the background.
    pub fn opened(&mut self, document: &Document, context: &egui::Context) {
        self.view_through_camera();
        self.highlight.clear();
        if let Some(camera) = stored_viewpoint(&document.view) {
            self.camera = camera;
            self.snap_to_camera = false;
        }
        let Some(renderer) = &self.renderer else { return };
        let (device, queue) = renderer.device();
        (self.mesh, self.drawn, self.last_drawn) = (None, None, None);
        match FocusTexture::new(device, queue, &document.map) {
            Ok(focus) => self.focus = Some(focus),
            Err(error) => self.problem = Some(error.to_string()),
        }
        self.surface_changed(document, context);
    }

    /// Shows another surface, or the same with other materials.
    pub fn surface_changed(&mut self, document: &Document, context: &egui::Context) {
        self.hover = None;
        self.highlight.clear();
        self.upload_surface(document, (OverlayKind::Materials, None), context);
    }

    /// Switches the overlay if the appearance or the available light calls for another one.
    fn update_overlay(
        &mut self,
        session: &Session,
        document: &Document,
        appearance: SurfaceAppearance,
        context: &egui::Context,
    ) {
        if self.upload.is_some() {
            return;
        }
        let light = session.photograph_light();
        let target_overlay = match document.stage.scene.picture {
            Some(_) if appearance.depth => OverlayKind::Depth,
            Some(_) if appearance.photograph_counts => OverlayKind::Invented,
            None if light.is_some() && appearance.photograph_counts => OverlayKind::PhotographCount,
            None if light.is_some() => OverlayKind::Photographs,
            _ => OverlayKind::Materials,
        };
        if target_overlay != self.overlay {
            self.upload_surface(document, (target_overlay, light), context);
        }
    }

    /// Uploads the surface with an overlay in the background; the old one is drawn until it is done.
    fn upload_surface(
        &mut self,
        document: &Document,
        (overlay, light): (OverlayKind, Option<Arc<PhotographLight>>),
        context: &egui::Context,
    ) {
        let Some(renderer) = &self.renderer else { return };
        let (device, queue) = renderer.device();
        let (sender, receiver) = mpsc::channel();
        self.upload = Some(receiver);
        let (device, queue, context) = (device.clone(), queue.clone(), context.clone());
        let stage = document.stage.clone();
        self.overlay = overlay;
        let upload = move || {
            let coat = SurfaceOverlay::build(&stage, light.as_deref(), overlay);
            // The receiver may be gone if the view was closed or shows another scene.
            let _ =
                sender.send(SurfaceMesh::upload(&device, &queue, &stage.scene, &stage.atlas, coat.as_ref()));
            context.request_repaint();
        };
        let thread = std::thread::Builder::new().name("surface upload".into());
        if let Err(error) = thread.spawn(upload) {
            self.problem =
                Some(format!("paint view: no thread could be started: {error} (close other programs)"));
        }
    }

    /// Updates changed texels of the focus map.
    pub fn map_changed(&mut self, document: &Document, rectangles: Vec<[Range<u32>; 2]>) {
        let (Some(renderer), Some(focus)) = (&self.renderer, &self.focus) else { return };
        let size = self.drawn.as_ref().map_or([0; 2], |_| self.size);
        self.stale.join(changed_pixels(
            &document.stage.scene,
            &document.stage.texels,
            &rectangles,
            &self.camera,
            size,
        ));
        for [columns, rows] in rectangles {
            focus.update(renderer.device().1, &document.map, columns, rows);
        }
    }

    /// Updates the frozen texels after a change of the selection.
    pub fn selection_changed(&mut self, document: &Document) {
        let (Some(renderer), Some(focus)) = (&self.renderer, &mut self.focus) else { return };
        focus.freeze(renderer.device().1, document);
        self.stale.join(Stale::AllColors);
    }

    /// Whether the surface is drawn.
    pub fn is_ready(&self) -> bool {
        self.mesh.is_some() && self.drawn.is_some()
    }

    /// Rectangle of the view on screen.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// The camera of the view.
    pub fn camera(&self) -> &OrbitCamera {
        &self.camera
    }

    /// The surface point under the pointer.
    pub fn hover(&self) -> Option<SurfaceHit> {
        self.hover
    }

    /// Clears the hovered point while the view is not drawn.
    pub fn pointer_left(&mut self) {
        self.hover = None;
    }

    /// Screen position of a world point.
    pub fn screen_from_world(&self, point: DVec3) -> Option<Pos2> {
        let at = self.camera.project(point, aspect(self.rect))?;
        Some(screen_from_clip(self.rect, at))
    }

    /// Looks through the shot camera, with the whole picture in view, and follows it until the user navigates.
    pub fn view_through_camera(&mut self) {
        self.following = None;
        self.snap_to_camera = true;
    }

    /// The viewpoint as saved with the document: null while the view follows the shot camera.
    pub fn viewpoint(&self) -> serde_json::Value {
        if self.snap_to_camera || self.following == Some(self.camera) {
            return serde_json::Value::Null;
        }
        serde_json::json!({ VIEWPOINT_KEY: self.camera })
    }

    /// Follows the shot camera as it or the view's size changes, until the user navigates.
    fn follow_camera(&mut self, camera: &Camera) {
        if !self.snap_to_camera && self.following != Some(self.camera) {
            return;
        }
        self.snap_to_camera = false;
        // The pivot is at the focus distance, or at a default distance for focus at infinity.
        let distance =
            if camera.focus_distance.is_finite() { camera.focus_distance } else { PIVOT_AT_INFINITY };
        self.camera = OrbitCamera::from_shot(camera, distance);
        // This view looks along the axis; the frame of a shifted sensor lies off the axis.
        let [middle, half] = camera.frame_q();
        let reach = middle.abs() + half;
        let room = FRAME_MARGIN * (reach.x / aspect(self.rect)).max(reach.y);
        self.camera.yfov = 2.0 * ((camera.yfov / 2.0).tan() * room).atan();
        self.following = Some(self.camera);
    }

    /// Frames the whole scene.
    pub fn frame_all(&mut self, document: &Document) {
        self.camera.frame(document.stage.bounds, aspect(self.rect));
    }

    /// Makes the point under the pointer the pivot; frames the whole scene if there is none.
    pub fn frame_cursor(&mut self, document: &Document) {
        match self.hover {
            Some(hit) => self.camera.center_on(hit.position),
            None => self.frame_all(document),
        }
    }

    /// Draws the view into the remaining space of `ui` and turns pointer input into actions.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        active_tool: &ActiveTool,
        appearance: SurfaceAppearance,
        actions: &mut Vec<Action>,
    ) {
        let (rect, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(8.0, 8.0)), Sense::click_and_drag());
        self.rect = rect;
        crate::window::widgets::controls::set_accessible_name(&response, "Paint view");
        if self.drawn.is_none() {
            ui.painter().rect_filled(rect, 0.0, Color32::from_gray(32));
        }
        let Some(document) = session.document() else {
            paint_hint(
                ui,
                rect,
                match session.jobs().is_empty() {
                    true => {
                        "Drop a glTF scene, a project, the folder of a capture or a picture with depth here, \
                         or press Ctrl+O."
                    }
                    false => "Opening…",
                },
            );
            return;
        };
        self.follow_camera(&document.camera);
        self.receive_mesh(actions);
        self.update_overlay(session, document, appearance, ui.ctx());
        self.navigate(ui, &response);
        self.draw(ui, document, appearance, actions);
        let frame = self.camera.view(aspect(rect));
        let position = |at: Pos2| view_from_screen(rect, at);
        let screen = |at: DVec2| screen_from_position(rect, at);
        let view = DragView { frame, position: &position, screen: &screen };
        if !BrushHud::is_open(&response) || session.is_painting() {
            actions.extend(self.stroke.update(ui, &response, session, active_tool, &view));
        }
        let pointer = response.hover_pos().or_else(|| response.interact_pointer_pos());
        self.hover = pointer.and_then(|at| active_tool.pick(session, &view, at));
        let painter = ui.painter_at(rect);
        self.paint_shot_camera(&painter, &document.camera, document.stage.bounds);
        legend::paint(&painter, rect, appearance.focus_share > 0.0, self.overlay);
        self.stroke.paint(ui, rect, session, active_tool, &view);
        let targets = active_tool.targets(session, self.hover.filter(|_| response.hovered()));
        self.highlight.paint(ui, document, (frame, rect, rect), &targets);
        if let (Some(hit), Some(ring)) = (self.hover, active_tool.ring) {
            brush_ring::paint(&painter, &hit, ring, |point| self.screen_from_world(point));
        }
        self.hud.show(&response, session, self.hover, actions);
        if response.hovered() {
            ui.set_cursor_icon(egui::CursorIcon::Crosshair);
        }
        match &self.problem {
            Some(problem) => paint_hint(ui, rect, problem),
            None if self.mesh.is_none() => paint_hint(ui, rect, "Preparing the view…"),
            None => {}
        }
    }

    fn receive_mesh(&mut self, actions: &mut Vec<Action>) {
        let Some(received) = self.upload.as_ref().and_then(|receiver| receiver.try_recv().ok()) else {
            return;
        };
        self.upload = None;
        self.stale = Stale::Everything;
        match received {
            Ok(mesh) => {
                self.problem = None;
                self.mesh = Some(mesh);
            }
            Err(error) => {
                self.problem = Some(error.to_string());
                actions.push(Action::ShowError(error.to_string()));
            }
        }
    }

    /// Navigation: drags according to the key map, zoom by wheel, pan and zoom by two fingers.
    fn navigate(&mut self, ui: &Ui, response: &Response) {
        if let Some((motion, delta)) = navigation::view_drag(ui, response) {
            let delta = DVec2::new(delta.x as f64, delta.y as f64);
            self.camera.drag(motion, delta, self.rect.height() as f64);
        }
        if response.contains_pointer() {
            let (scroll, touch) =
                ui.input(|input| (input.smooth_scroll_delta().y as f64, input.multi_touch()));
            if scroll != 0.0 {
                self.camera.zoom(scroll / POINTS_PER_STEP);
            }
            if let Some(touch) = touch {
                self.camera.zoom((touch.zoom_delta as f64).ln() / -0.88f64.ln());
                let delta = touch.translation_delta;
                self.camera.pan(DVec2::new(delta.x as f64, delta.y as f64), self.rect.height() as f64);
            }
        }
    }

    /// How long the view waits until it follows the shot camera further, s; 0: it is drawn now.
    fn waiting_seconds(&self, now: f64) -> f64 {
        let is_software = self.renderer.as_ref().is_some_and(SurfaceRenderer::is_software);
        let follows = is_software && self.following == Some(self.camera);
        let behind = self.last_drawn.filter(|(camera, _)| follows && *camera != self.camera);
        behind.map_or(0.0, |(_, drawn)| (drawn + FOLLOWING_SECONDS - now).max(0.0))
    }

    fn draw(
        &mut self,
        ui: &Ui,
        document: &Document,
        appearance: SurfaceAppearance,
        actions: &mut Vec<Action>,
    ) {
        let now = ui.input(|input| input.time);
        let waiting = self.waiting_seconds(now);
        let (Some(blitter), Some(renderer), Some(mesh), Some(focus)) =
            (&self.blitter, &mut self.renderer, &self.mesh, &self.focus)
        else {
            return;
        };
        let scale = ui.ctx().pixels_per_point();
        let image = blit::snapped_to_pixels(self.rect, scale);
        self.size = [image.width(), image.height()].map(|side| (side * scale).round().max(1.0) as u32);
        let shown = SurfaceFrame { view: &self.camera, shot: &document.camera, appearance, size: self.size };
        let drawn = if waiting > 0.0 {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(waiting));
            Ok(false)
        } else {
            self.last_drawn = Some((self.camera, now));
            renderer.draw(mesh, focus, shown, std::mem::take(&mut self.stale))
        };
        match drawn {
            Ok(new_texture) => {
                if let Some(picture) = renderer.picture().filter(|_| new_texture || self.drawn.is_none()) {
                    self.drawn = Some(blitter.drawable(picture.clone()));
                }
            }
            Err(error) => {
                let text = error.to_string();
                if self.problem.as_ref() != Some(&text) {
                    actions.push(Action::ShowError(text.clone()));
                    self.problem = Some(text);
                }
            }
        }
        if let Some(drawn) = &self.drawn {
            // Nearest neighbour, unless the surface was supersampled.
            let filter = if drawn.size() == self.size { Filter::Nearest } else { Filter::Linear };
            blitter.paint(&ui.painter_at(self.rect), drawn, image, filter);
        }
    }

    /// Draws the frame of the shot camera at the focus distance and, unless the view looks through it, the
    /// edges from its eye.
    fn paint_shot_camera(&self, painter: &egui::Painter, camera: &Camera, bounds: (DVec3, DVec3)) {
        let extent = (bounds.1 - bounds.0).length();
        let is_outside_shot_camera = self.camera.eye().distance(camera.position()) > 1e-3 * extent;
        let depth = if camera.focus_distance.is_finite() { camera.focus_distance } else { extent };
        let half = (camera.yfov / 2.0).tan() * depth;
        let [middle, extent] = camera.frame_q();
        let corner = |x: f64, y: f64| {
            let at = middle + DVec2::new(x, y) * extent;
            camera.world_from_camera((at * half).extend(depth))
        };
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let frame = Stroke::new(1.0, Color32::from_white_alpha(120));
        let edge = Stroke::new(1.0, Color32::from_white_alpha(45));
        for k in 0..4 {
            self.paint_segment(painter, corners[k], corners[(k + 1) % 4], frame);
            if is_outside_shot_camera {
                self.paint_segment(painter, camera.position(), corners[k], edge);
            }
        }
    }

    /// Draws a world segment, clipped at the eye.
    fn paint_segment(&self, painter: &egui::Painter, a: DVec3, b: DVec3, stroke: Stroke) {
        let forward = self.camera.orientation * DVec3::NEG_Z;
        let depth = |p: DVec3| (p - self.camera.eye()).dot(forward);
        let near = 1e-3 * self.camera.distance;
        let (za, zb) = (depth(a), depth(b));
        if za < near && zb < near {
            return;
        }
        let cut = |p: DVec3, zp: f64, q: DVec3, zq: f64| {
            if zp >= near { p } else { p + (q - p) * ((near - zp) / (zq - zp)) }
        };
        let ends = [cut(a, za, b, zb), cut(b, zb, a, za)].map(|p| self.screen_from_world(p));
        if let [Some(a), Some(b)] = ends {
            painter.line_segment([a, b], stroke);
        }
    }
}

/// Draws a text in the middle of an empty view.
pub fn paint_hint(ui: &Ui, rect: Rect, text: &str) {
    let width = (rect.width() - 40.0).max(60.0);
    let color = Color32::from_gray(190);
    let galley = ui.painter().layout(text.into(), egui::FontId::proportional(14.0), color, width);
    let at = rect.center() - galley.size() / 2.0;
    ui.painter().rect_filled(Rect::from_min_size(at, galley.size()).expand(8.0), 4.0, theme::SURROUNDINGS);
    ui.painter().galley(at, galley, color);
}

fn aspect(rect: Rect) -> f64 {
    (rect.width().max(1.0) / rect.height().max(1.0)) as f64
}

/// The viewpoint saved with a document, if it is valid.
fn stored_viewpoint(view: &serde_json::Value) -> Option<OrbitCamera> {
    let camera: OrbitCamera = serde_json::from_value(view.get(VIEWPOINT_KEY)?.clone()).ok()?;
    camera.is_usable().then_some(camera)
}

/// Maps a screen position to the view: (0, 0) is its upper left corner, (1, 1) its lower right.
fn view_from_screen(rect: Rect, at: Pos2) -> DVec2 {
    let share = |at: f32, from: f32, length: f32| ((at - from) / length.max(1.0)) as f64;
    DVec2::new(share(at.x, rect.left(), rect.width()), share(at.y, rect.top(), rect.height()))
}

/// Maps a position in the view to the screen.
fn screen_from_position(rect: Rect, at: DVec2) -> Pos2 {
    rect.min + vec2(at.x as f32, at.y as f32) * rect.size()
}

fn screen_from_clip(rect: Rect, at: DVec2) -> Pos2 {
    pos2(
        rect.left() + (at.x as f32 + 1.0) / 2.0 * rect.width(),
        rect.top() + (1.0 - at.y as f32) / 2.0 * rect.height(),
    )
}
