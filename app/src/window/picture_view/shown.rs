//! The pictures that the view can show, as textures.

use super::tone::{Tone, to_screen};
use egui::{ColorImage, TextureHandle, TextureOptions, Ui};
use lens::Picture;
use session::{ReferenceKind, Session};
use std::sync::Arc;

/// Which picture is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shown {
    /// The live picture.
    #[default]
    Painted,
    /// The picture of the ordinary lens.
    Standard,
    /// Everything sharp.
    Pinhole,
    /// The ray-traced picture.
    Truth,
}

impl Shown {
    /// All, as a menu offers them.
    pub const ALL: [Self; 4] = [Self::Painted, Self::Standard, Self::Pinhole, Self::Truth];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Painted => "Painted",
            Self::Standard => "Ordinary lens",
            Self::Pinhole => "Pinhole",
            Self::Truth => "Ray traced",
        }
    }

    /// What it is.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Painted => "The live picture, as painted.",
            Self::Standard => "The same lens without any paint.",
            Self::Pinhole => "Everything sharp.",
            Self::Truth => "The picture as painted, by rays: slow and sure (F12 traces it anew).",
        }
    }

    /// The session's picture of it.
    pub fn kind(self) -> Option<ReferenceKind> {
        match self {
            Self::Painted => None,
            Self::Standard => Some(ReferenceKind::Standard),
            Self::Pinhole => Some(ReferenceKind::Pinhole),
            Self::Truth => Some(ReferenceKind::Truth),
        }
    }

    fn picture(self, session: &Session) -> Option<&Arc<Picture>> {
        match self.kind() {
            None => session.preview().map(|preview| &preview.picture),
            Some(kind) => session.reference(kind).map(|reference| &reference.picture),
        }
    }
}

/// The textures of the pictures, each as new as its picture.
#[derive(Default)]
pub struct Textures {
    held: [Option<Held>; Shown::ALL.len()],
}

struct Held {
    texture: TextureHandle,
    /// What it holds, and how that was put on screen.
    picture: Arc<Picture>,
    tone: Tone,
    squares: bool,
}

impl Textures {
    /// The texture of a picture, if there is one. Drawn so large that pixels are seen, they are `squares`.
    pub fn of(
        &mut self,
        ui: &Ui,
        session: &Session,
        shown: Shown,
        tone: Tone,
        squares: bool,
    ) -> Option<&TextureHandle> {
        let picture = shown.picture(session);
        let held = &mut self.held[shown as usize];
        let Some(picture) = picture else {
            *held = None;
            return None;
        };
        let fits =
            |held: &Held| Arc::ptr_eq(&held.picture, picture) && (held.tone, held.squares) == (tone, squares);
        if !held.as_ref().is_some_and(fits) {
            let size = [picture.width as usize, picture.height as usize];
            let image = ColorImage::new(size, to_screen(picture, tone));
            let magnification =
                if squares { egui::TextureFilter::Nearest } else { egui::TextureFilter::Linear };
            let options = TextureOptions { magnification, ..TextureOptions::LINEAR };
            let texture = match held.take() {
                Some(mut held) => {
                    held.texture.set(image, options);
                    held.texture
                }
                None => ui.ctx().load_texture(shown.name(), image, options),
            };
            *held = Some(Held { texture, picture: picture.clone(), tone, squares });
        }
        held.as_ref().map(|held| &held.texture)
    }
}
