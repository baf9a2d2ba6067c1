//! The picture view: the latest refocused picture from the shot camera, which can be painted on directly.

mod displayed_picture;
mod guides;
mod tone_mapper;
mod verify;
mod walk;
mod wipe;

pub use displayed_picture::DisplayedPicture;

use super::brush_hud::BrushHud;
use super::paint_view::{OrbitCamera, PIVOT_AT_INFINITY, paint_hint};
use crate::window::graphics::blit::{Blitter, Filter};
use crate::window::tools::active_tool::ActiveTool;
use crate::window::tools::brush_ring;
use crate::window::tools::drag_tool::DragView;
use crate::window::tools::navigation::{self, Motion};
use crate::window::tools::region_highlight::RegionHighlight;
use crate::window::tools::stroke_input::StrokeInput;
use crate::window::widgets::{controls, theme};
use crate::window::{Action, ViewSettings};
use displayed_picture::Textures;
use document::{CameraEdit, SurfaceHit};
use egui::{PointerButton, Pos2, Rect, Response, Sense, Ui, Vec2, vec2};
use focus::ViewFrame;
use glam::{DVec2, DVec3};
use guides::Guides;
use lens::Camera;
use render::Tone;
use session::{Command, PreviewActivity, PreviewKind, ReferenceKind, Session};
use verify::Verify;
use walk::Walk;
use wipe::Wipe;

/// Scroll distance that doubles the zoom, points.
const POINTS_PER_DOUBLING: f32 = 240.0;
/// Magnification from which on pixels are shown as squares.
const SQUARES_FROM: f32 = 3.0;

/// Rays per pixel of the ray-traced picture.
pub const TRUTH_SAMPLES: u32 = 64;

/// Scale and position of the picture in the view.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Zoom {
    /// As large as fits the view.
    Fit,
    /// Screen points per picture pixel, and the picture position (in [0, 1]²) at the centre of the view.
    Free { scale: f32, middle: Vec2 },
}

/// The view of the picture.
pub struct PictureView {
    blitter: Option<Blitter>,
    textures: Textures,
    /// Which picture is shown.
    pub displayed: DisplayedPicture,
    /// The wipe line and the compared picture.
    pub wipe: Wipe,
    /// The rectangle that is verified by ray tracing.
    pub verify: Verify,
    zoom: Zoom,
    stroke: StrokeInput,
    hud: BrushHud,
    hover: Option<SurfaceHit>,
    highlight: RegionHighlight,
    /// The shot camera while a drag moves it.
    orbit: Option<OrbitCamera>,
    /// The walk mode.
    pub walk: Walk,
    guides: Guides,
    rect: Rect,
    image: Rect,
}

impl PictureView {
    /// An empty view. Without a blitter it never shows a picture.
    pub fn new(blitter: Option<Blitter>) -> Self {
        Self {
            blitter,
            textures: Textures::default(),
            displayed: DisplayedPicture::Painted,
            wipe: Wipe::default(),
            verify: Verify::default(),
            zoom: Zoom::Fit,
            stroke: StrokeInput::default(),
            hud: BrushHud::default(),
            hover: None,
            highlight: RegionHighlight::default(),
            orbit: None,
            walk: Walk::default(),
            guides: Guides::default(),
            rect: Rect::NOTHING,
            image: Rect::NOTHING,
        }
    }

    /// Resets the view for another document.
    pub fn opened(&mut self) {
        *self = Self::new(self.blitter.take());
    }

    /// The surface was replaced: clears the hovered point.
    pub fn surface_changed(&mut self) {
        self.hover = None;
        self.highlight.clear();
    }

    /// Shows a picture, unless the wipe already shows it.
    pub fn show(&mut self, shown: DisplayedPicture) {
        if !(self.wipe.is_on && self.wipe.against == shown) {
            self.displayed = shown;
        }
    }

    /// Turns the wipe on or off.
    pub fn toggle_wipe(&mut self) {
        self.wipe.is_on = !self.wipe.is_on;
    }

    /// Cycles through the anaglyph, the side-by-side pair and the live picture.
    pub fn cycle_stereo(&mut self) {
        self.displayed = match self.displayed {
            DisplayedPicture::Anaglyph => DisplayedPicture::SideBySide,
            DisplayedPicture::SideBySide => DisplayedPicture::Painted,
            _ => DisplayedPicture::Anaglyph,
        };
        if self.wipe.is_on && self.wipe.against == self.displayed {
            self.wipe.against = DisplayedPicture::Painted;
        }
    }

    /// As large as fits the view.
    pub fn fit(&mut self) {
        self.zoom = Zoom::Fit;
    }

    /// Zooms to one picture pixel per screen pixel, keeping the centre.
    pub fn actual_size(&mut self, pixels_per_point: f32) {
        let middle = match self.zoom {
            Zoom::Fit => vec2(0.5, 0.5),
            Zoom::Free { middle, .. } => middle,
        };
        self.zoom = Zoom::Free { scale: 1.0 / pixels_per_point, middle };
    }

    /// Rectangle of the view on screen.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// Rectangle of the picture on screen.
    pub fn image_rect(&self) -> Rect {
        self.image
    }

    /// Share of the view highlighted as affected by a click; `None` without a highlight.
    pub fn highlighted_share(&self) -> Option<f32> {
        self.highlight.share()
    }

    /// What lies under the pointer.
    pub fn hover(&self) -> Option<SurfaceHit> {
        self.hover
    }

    /// The view is not drawn: nothing lies under the pointer.
    pub fn pointer_left(&mut self) {
        self.hover = None;
    }

    /// Screen pixels per picture pixel, in percent.
    pub fn scale_percent(&self, session: &Session, pixels_per_point: f32) -> Option<f32> {
        let width = session.document()?.camera.width as f32;
        Some(self.image.width() * pixels_per_point / width * 100.0)
    }

    /// Draws the view into the rest of `ui` and turns the pointer into actions.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        active_tool: &ActiveTool,
        settings: &ViewSettings,
        actions: &mut Vec<Action>,
    ) {
        let display = settings.display();
        let (rect, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(8.0, 8.0)), Sense::click_and_drag());
        self.rect = rect;
        controls::set_accessible_name(&response, "Picture");
        let Some(document) = session.document() else {
            ui.painter().rect_filled(rect, 0.0, theme::SURROUNDINGS);
            // A preview of the scene that is being opened.
            let [width, height] = session.screen().size();
            if width > 0 && height > 0 {
                self.image = self.picture_rect(vec2(width as f32, height as f32));
                let tone = Tone { display, ..Tone::default() };
                self.paint_picture(ui, session, tone, DisplayedPicture::Painted, rect);
            }
            return;
        };
        let size = vec2(document.camera.width as f32, document.camera.height as f32);
        self.navigate(ui, &response, session, size, actions);
        self.image = self.picture_rect(size);
        paint_surroundings(ui, rect, self.whole_rect());
        let tone = Tone { exposure: document.exposure, display };
        self.paint_picture(ui, session, tone, self.displayed, rect);
        let painter = ui.painter_at(rect);
        let mut is_wiping = false;
        let is_pair = self.displayed.is_pair();
        if self.wipe.is_on && !is_pair {
            let left = self.wipe.left_of(self.image).intersect(rect);
            self.paint_picture(ui, session, tone, self.wipe.against, left);
            is_wiping = self.wipe.handle(ui, self.image, rect, self.displayed);
        }
        self.request_pictures(session, actions);
        let image = self.image;
        if !is_pair {
            self.guides.paint(&painter, image, session, settings);
        }
        let shot = &document.camera;
        let frame = ViewFrame::from_camera(shot);
        let is_selecting = self.verify.is_selecting() || self.walk.is_on();
        let whole = self.whole_rect();
        let position = |at: Pos2| picture_position(image, in_left_picture(is_pair, image, at));
        let screen = |at: DVec2| image.min + vec2(at.x as f32, at.y as f32) * image.size();
        let view = DragView { frame, position: &position, screen: &screen };
        self.verify.select(ui, &response, image, position, actions);
        let is_for_tool = !(is_wiping || is_selecting || BrushHud::is_open(&response));
        if is_for_tool || session.is_painting() {
            actions.extend(self.stroke.update(ui, &response, session, active_tool, &view));
        }
        self.stroke.paint(ui, rect, session, active_tool, &view);
        let pointer = response.hover_pos().or_else(|| response.interact_pointer_pos());
        let pointer = pointer.filter(|at| whole.contains(*at) && !is_wiping && !is_selecting);
        self.hover = pointer.and_then(|at| active_tool.pick(session, &view, at));
        let targets = active_tool.targets(session, self.hover);
        self.highlight.paint(ui, document, (frame, image, rect), &targets);
        if let (Some(hit), Some(ring)) = (self.hover, active_tool.ring) {
            brush_ring::paint(&painter, &hit, ring, |point| self.screen_from_world(&document.camera, point));
        }
        self.hud.show(&response, session, self.hover, actions);
        if response.hovered() && !is_wiping {
            ui.set_cursor_icon(egui::CursorIcon::Crosshair);
        }
        self.verify.show(ui, session, image, rect, tone, actions);
        self.paint_notice(ui, session);
    }

    /// Where a world point is on screen.
    pub fn screen_from_world(&self, camera: &Camera, point: DVec3) -> Option<Pos2> {
        let camera_point = camera.camera_from_world(point);
        let pixel = camera.pixel_from_q(camera.optics().chief(camera_point));
        let share = vec2((pixel.x / camera.width as f64) as f32, (pixel.y / camera.height as f64) as f32);
        (camera_point.z > 0.0).then(|| self.image.min + share * self.image.size())
    }

    /// Draws the part of a picture that lies in `part` of the view.
    fn paint_picture(&mut self, ui: &Ui, session: &Session, tone: Tone, shown: DisplayedPicture, part: Rect) {
        let painter = ui.painter_at(part);
        // The photograph of another camera is not shown.
        let is_other =
            shown == DisplayedPicture::Photograph && !session.is_reference_current(ReferenceKind::Photograph);
        let place = if shown.is_pair() { self.whole_rect() } else { self.image };
        let drawn = self.blitter.as_ref().filter(|_| !is_other).and_then(|blitter| {
            let drawn = self.textures.texture(blitter, session, shown, tone)?;
            // A rough picture is enlarged smoothly; what is looked at from near shows its pixels.
            let full_width = session.document().map_or(drawn.size()[0], |document| document.camera.width);
            let squares = self.image.width() > SQUARES_FROM * full_width as f32;
            let filter = if squares { Filter::Nearest } else { Filter::Linear };
            blitter.paint(&painter, drawn, place, filter);
            Some(())
        });
        match drawn {
            Some(()) => {}
            None => {
                // Until it is there, a picture of the same view is shown.
                match shown.reference_kind() {
                    Some(ReferenceKind::Standard | ReferenceKind::Pinhole | ReferenceKind::Truth) => {
                        self.paint_picture(ui, session, tone, DisplayedPicture::Painted, part);
                    }
                    _ => {
                        painter.rect_filled(place, 0.0, egui::Color32::from_gray(28));
                    }
                }
                let text = match shown {
                    DisplayedPicture::Painted => "Drawing the first picture…",
                    DisplayedPicture::Standard => "Drawing the ordinary lens…",
                    DisplayedPicture::Pinhole => "Drawing the pinhole…",
                    DisplayedPicture::Truth => "Tracing rays…",
                    DisplayedPicture::Anaglyph | DisplayedPicture::SideBySide if is_pinhole(session) => {
                        "A pinhole cannot give a stereo pair: open the aperture."
                    }
                    DisplayedPicture::Anaglyph | DisplayedPicture::SideBySide => "Drawing for two eyes…",
                    DisplayedPicture::Photograph
                        if session.document().is_some_and(|d| d.photograph().is_none()) =>
                    {
                        "Choose a photograph as the camera (Lens, Camera)."
                    }
                    DisplayedPicture::Photograph => "Reading the photograph…",
                };
                paint_hint(ui, part.intersect(place), text);
            }
        }
    }

    /// Requests the shown pictures that are missing or out of date. A ray-traced picture is slow: it is made
    /// once, and again only on command.
    fn request_pictures(&self, session: &Session, actions: &mut Vec<Action>) {
        let against = (self.wipe.is_on && !self.displayed.is_pair()).then_some(self.wipe.against);
        for kind in
            [Some(self.displayed), against].into_iter().flatten().filter_map(DisplayedPicture::reference_kind)
        {
            let is_needed = match kind {
                ReferenceKind::Truth => session.reference(kind).is_none(),
                ReferenceKind::Photograph => {
                    let is_there = session.document().is_some_and(|document| document.photograph().is_some());
                    is_there && !session.is_reference_current(kind)
                }
                _ => !session.is_reference_current(kind),
            };
            if is_needed && !session.is_making_reference(kind) && session.is_idle() {
                actions.push(Command::MakeReference { kind, samples_per_pixel: TRUTH_SAMPLES }.into());
                return;
            }
        }
    }

    /// Whether a ray-traced picture is shown that is out of date.
    fn shows_outdated_truth(&self, session: &Session) -> bool {
        let kind = ReferenceKind::Truth;
        let is_shown = self.displayed == DisplayedPicture::Truth
            || (self.wipe.is_on && self.wipe.against == DisplayedPicture::Truth);
        is_shown && session.reference(kind).is_some() && !session.is_reference_current(kind)
    }

    /// Navigation: drags move the shot camera, or with Space the picture, according to the key map; the wheel zooms the picture at the
    /// pointer, a double click with the middle button fits it.
    fn navigate(
        &mut self,
        ui: &Ui,
        response: &Response,
        session: &Session,
        size: Vec2,
        actions: &mut Vec<Action>,
    ) {
        if self.walk.is_on() {
            self.walk.turn(response.drag_delta(), actions);
            if response.contains_pointer() {
                self.walk.scroll(ui.input(|input| input.smooth_scroll_delta().y));
            }
            return;
        }
        if response.double_clicked_by(PointerButton::Middle) {
            self.zoom = Zoom::Fit;
            return;
        }
        let mut nearer = 0.0;
        match navigation::view_drag(ui, response) {
            Some((motion, delta)) if self.orbit.is_some() || !navigation::is_space_held(ui.ctx()) => {
                self.move_camera(motion, delta, session, actions);
            }
            Some((Motion::Nearer, delta)) => nearer = -2.0 * delta.y,
            Some((Motion::Orbit | Motion::Slide, delta)) => {
                let image = self.picture_rect(size);
                self.zoom = self.zoom_showing(image.translate(delta), size);
            }
            None if self.orbit.take().is_some() => actions.push(Command::FinishEdit.into()),
            None => {}
        }
        let Some(pointer) = response.hover_pos().or_else(|| response.interact_pointer_pos()) else { return };
        let (scroll, pinch) = match response.contains_pointer() {
            true => ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta())),
            false => (0.0, 1.0),
        };
        let factor = ((scroll + nearer) / POINTS_PER_DOUBLING).exp2() * pinch;
        if factor != 1.0 {
            let image = self.picture_rect(size);
            let scale = image.width() / size.x;
            let factor = (scale * factor).clamp(0.02, 64.0) / scale;
            let zoomed = Rect::from_min_max(
                pointer + (image.min - pointer) * factor,
                pointer + (image.max - pointer) * factor,
            );
            self.zoom = self.zoom_showing(zoomed, size);
        }
    }

    /// Moves the shot camera by a drag: about the surface in the picture's middle, or the focus plane where there is none.
    fn move_camera(&mut self, motion: Motion, delta: Vec2, session: &Session, actions: &mut Vec<Action>) {
        let Some(document) = session.document() else { return };
        let camera = &document.camera;
        let orbit =
            self.orbit.get_or_insert_with(|| OrbitCamera::from_shot(camera, pivot_distance(session, camera)));
        let before = *orbit;
        let delta = DVec2::new(f64::from(delta.x), f64::from(delta.y));
        orbit.drag(motion, delta, f64::from(self.image.height()));
        if *orbit != before {
            actions.push(Command::EditCamera(CameraEdit::Pose(orbit.pose())).into());
        }
    }

    /// The zoom that shows the picture at `image`.
    fn zoom_showing(&self, image: Rect, size: Vec2) -> Zoom {
        let middle = (self.rect.center() - image.min) / image.size();
        let middle = vec2(middle.x.clamp(0.0, self.picture_count()), middle.y.clamp(0.0, 1.0));
        Zoom::Free { scale: image.width() / size.x, middle }
    }

    /// Number of pictures side by side.
    fn picture_count(&self) -> f32 {
        if self.displayed.is_pair() { 2.0 } else { 1.0 }
    }

    /// Rectangle of the picture, or of both pictures of a pair.
    fn whole_rect(&self) -> Rect {
        Rect::from_min_size(self.image.min, self.image.size() * vec2(self.picture_count(), 1.0))
    }

    /// Rectangle for a picture of `size` px; for a pair, of the left one.
    fn picture_rect(&self, size: Vec2) -> Rect {
        match self.zoom {
            Zoom::Fit => {
                let room = self.rect.shrink(8.0).size();
                let whole = size * vec2(self.picture_count(), 1.0);
                let scale = (room.x / whole.x).min(room.y / whole.y).max(1e-3);
                let corner = Rect::from_center_size(self.rect.center(), whole * scale).min;
                Rect::from_min_size(corner, size * scale)
            }
            Zoom::Free { scale, middle } => {
                let drawn = size * scale;
                Rect::from_min_size(self.rect.center() - middle * drawn, drawn)
            }
        }
    }

    /// Draws an unobtrusive note if the picture is not final.
    fn paint_notice(&self, ui: &Ui, session: &Session) {
        let kind = session.preview().map(|preview| preview.kind);
        let pinhole = kind == Some(PreviewKind::Pinhole);
        let text = match session.preview_activity() {
            _ if self.walk.is_on() => walk::HINT,
            _ if self.verify.is_selecting() => "drag a rectangle to verify it by ray tracing (Esc: cancel)",
            activity if activity.is_baking() && pinhole => {
                "rebuilding the light field, shown without blur meanwhile"
            }
            activity if activity.is_baking() => "rebuilding the light field",
            PreviewActivity::Splatting if pinhole => "drawing the picture, shown without blur meanwhile",
            PreviewActivity::Idle if pinhole => {
                "shown without blur: the light field was not built (F5 builds it)"
            }
            PreviewActivity::Idle if kind == Some(PreviewKind::Defocused) => {
                "blurred by depth: the light field was not built (F5 builds it)"
            }
            _ if self.shows_outdated_truth(session) => {
                "ray traced before the last change (F12 traces it anew)"
            }
            _ => return,
        };
        // The paint view may lie over the left corner.
        let at = self.rect.right_bottom() + vec2(-8.0, -6.0);
        let font = egui::FontId::proportional(12.0);
        ui.painter().text(at, egui::Align2::RIGHT_BOTTOM, text, font, egui::Color32::from_gray(200));
    }
}

/// How far ahead of the shot camera lies what it turns about.
fn pivot_distance(session: &Session, camera: &Camera) -> f64 {
    let ahead = session.picture_ray(DVec2::splat(0.5)).and_then(|ray| session.pick(&ray));
    let depth = ahead.map(|hit| camera.camera_from_world(hit.position).z);
    let is_ahead = |distance: &f64| *distance > 0.0 && distance.is_finite();
    depth.filter(is_ahead).or(Some(camera.focus_distance).filter(is_ahead)).unwrap_or(PIVOT_AT_INFINITY)
}

/// Fills the view around the picture. No pixel is drawn twice, which would be slow on a software adapter.
fn paint_surroundings(ui: &Ui, rect: Rect, image: Rect) {
    let visible = image.intersect(rect);
    if !visible.is_positive() {
        ui.painter().rect_filled(rect, 0.0, theme::SURROUNDINGS);
        return;
    }
    let beside = rect.with_min_y(visible.top()).with_max_y(visible.bottom());
    let strips = [
        rect.with_max_y(visible.top()),
        rect.with_min_y(visible.bottom()),
        beside.with_max_x(visible.left()),
        beside.with_min_x(visible.right()),
    ];
    for strip in strips.into_iter().filter(Rect::is_positive) {
        ui.painter().rect_filled(strip, 0.0, theme::SURROUNDINGS);
    }
}

/// Maps a screen position in the right picture of a pair to the same pixel of the left picture.
fn in_left_picture(is_pair: bool, image: Rect, at: Pos2) -> Pos2 {
    if is_pair && at.x >= image.right() { at - vec2(image.width(), 0.0) } else { at }
}

fn is_pinhole(session: &Session) -> bool {
    session.document().is_some_and(|document| document.camera.aperture_radius <= 0.0)
}

/// Maps a screen position to the picture: (0, 0) is its upper left corner, (1, 1) its lower right.
fn picture_position(image: Rect, at: Pos2) -> DVec2 {
    let share = (at - image.min) / image.size();
    DVec2::new(share.x as f64, share.y as f64)
}
