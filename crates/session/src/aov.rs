//! Pictures beside the picture: what compositing and measuring ask for.

use crate::FirstHits;
use lens::{Camera, Picture};
use project::Layer;

/// An extra channel of a rendered picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aov {
    /// The model's sum for a scene of radiance 1; 1 in a standard picture.
    Coverage,
    /// Signed diameter of the circle of confusion, px: negative in near defocus. Of the first surface along
    /// the chief ray of each pixel's centre, as are the following.
    CircleOfConfusion,
    /// Axial depth in scene units; infinite where no surface is.
    Depth,
    /// The focus offset t, and with it the anchor a.
    Focus,
}

impl Aov {
    /// All of them, by the names that the command line knows.
    pub const ALL: [(&'static str, Aov); 4] = [
        ("coverage", Aov::Coverage),
        ("coc", Aov::CircleOfConfusion),
        ("depth", Aov::Depth),
        ("t", Aov::Focus),
    ];

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, aov)| *aov)
    }

    /// Whether it is made of first hits.
    pub(crate) fn needs_first_hits(self) -> bool {
        self != Self::Coverage
    }

    /// Its layers. `hits` may be missing only if the AOV needs none.
    pub(crate) fn layers(self, picture: &Picture, hits: Option<&FirstHits>, camera: &Camera) -> Vec<Layer> {
        let layer = |name: &str, values| Layer { name: name.into(), values };
        match (self, hits) {
            (Self::Coverage, _) => vec![Layer::coverage(picture)],
            (Self::CircleOfConfusion, Some(hits)) => vec![layer("coc", hits.circle_of_confusion_px(camera))],
            (Self::Depth, Some(hits)) => vec![layer("depth", hits.depth.clone())],
            (Self::Focus, Some(hits)) => vec![
                layer("t", hits.focus.iter().map(|focus| focus.t as f32).collect()),
                layer("anchor", hits.focus.iter().map(|focus| focus.anchor as f32).collect()),
            ],
            (_, None) => Vec::new(),
        }
    }
}
