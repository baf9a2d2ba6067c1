//! The panels that are folded away at first, in tabs beneath the views: the atlas, the aperture as one point sees it, how
//! blurred the picture is, the photographs of a capture, the timeline.

mod aperture_pad;
mod aperture_view;
mod atlas_view;
mod histogram_view;
mod photograph_strip;
mod timeline;

use super::Action;
use super::hand::ActiveTool;
use super::layout::Pane;
use aperture_view::ApertureView;
use atlas_view::AtlasView;
use egui::Ui;
use histogram_view::HistogramView;
use photograph_strip::PhotographStrip;
use session::{Session, SurfaceHit};
use timeline::Timeline;

/// The drawer's state between frames.
#[derive(Default)]
pub struct Drawer {
    atlas: AtlasView,
    aperture: ApertureView,
    histogram: HistogramView,
    photographs: PhotographStrip,
    timeline: Timeline,
}

impl Drawer {
    /// Another document: everything old goes.
    pub fn opened(&mut self) {
        *self = Self::default();
    }

    /// Another surface: a point that was chosen is no place of it.
    pub fn surface_changed(&mut self) {
        self.aperture = ApertureView::default();
    }

    /// Takes a point to look from at the aperture.
    pub fn inspect(&mut self, hit: SurfaceHit) {
        self.aperture.inspect(hit);
    }

    /// Whether a point was chosen to look from at the aperture.
    pub fn has_aperture_point(&self) -> bool {
        self.aperture.has_point()
    }

    /// Plays the timeline, or stops it.
    pub fn toggle_playing(&mut self) {
        self.timeline.toggle_playing();
    }

    /// Where the atlas is on screen.
    pub fn atlas_rect(&self) -> egui::Rect {
        self.atlas.rect()
    }

    /// What of the aperture the point sees that was looked from.
    pub fn aperture_image(&self) -> Option<&session::ApertureImage> {
        self.aperture.image()
    }

    /// Draws one of its panels into the rest of `ui`; the others draw nothing.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        pane: Pane,
        active_tool: &ActiveTool,
        actions: &mut Vec<Action>,
    ) {
        if session.document().is_none() {
            ui.weak("Nothing is open.");
            return;
        }
        match pane {
            Pane::Atlas => self.atlas.ui(ui, session, active_tool, actions),
            Pane::Aperture => self.aperture.ui(ui, session, actions),
            Pane::Histogram => self.histogram.ui(ui, session),
            Pane::Photographs => self.photographs.ui(ui, session, actions),
            Pane::Timeline => self.timeline.ui(ui, session, actions),
            Pane::Paint | Pane::Picture | Pane::Inspector => {}
        }
    }
}
