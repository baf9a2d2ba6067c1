//! The panels in tabs beneath the views, hidden at first: atlas, aperture view, blur histogram, photographs of
//! a capture, timeline.

mod aperture_pad;
mod aperture_view;
mod atlas_view;
mod histogram_view;
mod photograph_strip;
mod timeline;

use crate::window::Action;
use crate::window::layout::Pane;
use crate::window::tools::active_tool::ActiveTool;
use aperture_view::ApertureView;
use atlas_view::AtlasView;
use document::SurfaceHit;
use egui::Ui;
use histogram_view::HistogramView;
use photograph_strip::PhotographStrip;
use session::Session;
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
    /// Resets the panels for another document.
    pub fn opened(&mut self) {
        *self = Self::default();
    }

    /// The surface was replaced: the chosen point is no longer valid.
    pub fn surface_changed(&mut self) {
        self.aperture = ApertureView::default();
    }

    /// Chooses the point from which the aperture is inspected.
    pub fn inspect(&mut self, hit: SurfaceHit) {
        self.aperture.inspect(hit);
    }

    /// Whether such a point is chosen.
    pub fn has_aperture_point(&self) -> bool {
        self.aperture.has_point()
    }

    /// Starts or stops playback of the timeline.
    pub fn toggle_playing(&mut self) {
        self.timeline.toggle_playing();
    }

    /// Where the atlas is on screen.
    pub fn atlas_rect(&self) -> egui::Rect {
        self.atlas.rect()
    }

    /// The aperture as seen from the chosen point.
    pub fn aperture_image(&self) -> Option<&session::ApertureImage> {
        self.aperture.image()
    }

    /// Draws one of the drawer's panels into the remaining space of `ui`; does nothing for other panels.
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
