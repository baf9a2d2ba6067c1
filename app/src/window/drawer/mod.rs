//! The drawer beneath the views, folded away at first: the atlas, the aperture as one point sees it, how blurred the
//! picture is.

mod aperture_view;
mod atlas_view;
mod histogram_view;

use super::pointer::Hand;
use super::{Action, controls, keys};
use aperture_view::ApertureView;
use atlas_view::AtlasView;
use egui::{Button, Ui};
use histogram_view::HistogramView;
use serde::{Deserialize, Serialize};
use session::{CommandId, Session, SurfaceHit};

/// What the drawer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Drawn {
    /// The focus map flat.
    Atlas,
    /// What of the aperture one point sees.
    Aperture,
    /// The circles of confusion of the picture.
    Histogram,
}

impl Drawn {
    /// All, left to right.
    pub const ALL: [Self; 3] = [Self::Atlas, Self::Aperture, Self::Histogram];

    /// The command that shows it, or folds it away.
    pub fn command(self) -> CommandId {
        match self {
            Self::Atlas => CommandId::ShowAtlas,
            Self::Aperture => CommandId::ShowAperture,
            Self::Histogram => CommandId::ShowHistogram,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Atlas => "Atlas",
            Self::Aperture => "Aperture view",
            Self::Histogram => "Blur histogram",
        }
    }
}

/// The drawer's state between frames.
#[derive(Default)]
pub struct Drawer {
    atlas: AtlasView,
    aperture: ApertureView,
    histogram: HistogramView,
}

impl Drawer {
    /// Another document: everything old goes.
    pub fn opened(&mut self) {
        *self = Self::default();
    }

    /// Takes a point to look from at the aperture.
    pub fn inspect(&mut self, hit: SurfaceHit) {
        self.aperture.inspect(hit);
    }

    /// Whether a point was chosen to look from at the aperture.
    pub fn has_aperture_point(&self) -> bool {
        self.aperture.has_point()
    }

    /// Where the atlas is on screen.
    pub fn atlas_rect(&self) -> egui::Rect {
        self.atlas.rect()
    }

    /// What of the aperture the point sees that was looked from.
    pub fn aperture_image(&self) -> Option<&session::ApertureImage> {
        self.aperture.image()
    }

    /// Draws it.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        shown: Drawn,
        hand: &Hand,
        actions: &mut Vec<Action>,
    ) {
        ui.horizontal(|ui| {
            for drawn in Drawn::ALL {
                let button = Button::selectable(drawn == shown, drawn.label());
                let response = ui.add(button).on_hover_text(keys::tip(ui.ctx(), drawn.command()));
                if response.clicked() && drawn != shown {
                    actions.push(drawn.command().into());
                }
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let close = ui.button("Close").on_hover_text("Fold this away.");
                controls::named(&close, "Close the drawer");
                if close.clicked() {
                    actions.push(shown.command().into());
                }
            });
        });
        if session.document().is_none() {
            ui.weak("Nothing is open.");
            return;
        }
        match shown {
            Drawn::Atlas => self.atlas.ui(ui, session, hand, actions),
            Drawn::Aperture => self.aperture.ui(ui, session, actions),
            Drawn::Histogram => self.histogram.ui(ui, session),
        }
        // As high as the user drew it, whatever is in it.
        let rest = ui.available_size();
        if rest.y > ui.spacing().item_spacing.y {
            ui.allocate_space(rest);
        }
    }
}
