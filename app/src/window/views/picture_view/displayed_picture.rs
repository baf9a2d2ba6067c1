//! The pictures that the view can display, as textures.

use super::tone_mapper::ToneMapper;
use crate::window::graphics::blit::{Blitter, Drawable};
use document::Document;
use lens::Picture;
use render::{StereoForm, Tone, to_screen};
use session::{ReferenceKind, Screen, Session};
use splat::PictureOnCard;
use std::sync::Arc;

/// The displayed picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum DisplayedPicture {
    /// The live picture.
    #[default]
    Painted,
    /// The picture of the ordinary lens.
    Standard,
    /// Everything sharp.
    Pinhole,
    /// The ray-traced picture.
    Truth,
    /// The photograph that the camera looks through.
    Photograph,
    /// The live picture as a red-cyan anaglyph.
    Anaglyph,
    /// The live picture as a side-by-side stereo pair.
    SideBySide,
}

impl DisplayedPicture {
    /// All pictures, in the order of the menu.
    pub const ALL: [Self; 7] = [
        Self::Painted,
        Self::Standard,
        Self::Pinhole,
        Self::Anaglyph,
        Self::SideBySide,
        Self::Truth,
        Self::Photograph,
    ];

    /// Its name in the menu.
    pub fn name(self) -> &'static str {
        match self {
            Self::Painted => "Painted",
            Self::Standard => "Ordinary lens",
            Self::Pinhole => "Pinhole",
            Self::Truth => "Ray traced",
            Self::Photograph => "Photograph",
            Self::Anaglyph => "Stereo",
            Self::SideBySide => "Side by side",
        }
    }

    /// Its tooltip.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Painted => "The live picture, as painted.",
            Self::Standard => "The same lens without any paint.",
            Self::Pinhole => "Everything sharp.",
            Self::Truth => "The painted picture, ray traced: slow but reliable (F12 traces it again).",
            Self::Anaglyph => {
                "A red-cyan anaglyph of the painted picture: the fixated point (Alt+H and a click) lies in \
                 the plane of the screen."
            }
            Self::SideBySide => {
                "A stereo pair of the painted picture, for a stereoscope or parallel viewing. Alt+H and a \
                 click sets the fixated point."
            }
            Self::Photograph => {
                "The photograph of the current camera, at the common exposure of all photographs."
            }
        }
    }

    /// Whether this picture exists for the open document.
    pub fn exists_for(self, document: Option<&Document>) -> bool {
        match self {
            Self::Photograph => document.is_some_and(|document| !document.stage.scene.views.is_empty()),
            Self::Anaglyph | Self::SideBySide => {
                document.is_some_and(|document| document.camera.aperture_radius > 0.0)
            }
            _ => true,
        }
    }

    /// Whether it is a pair side by side, over which no other picture can be wiped.
    pub fn is_pair(self) -> bool {
        self == Self::SideBySide
    }

    /// The session's reference picture for it; `None` for the live picture.
    pub fn reference_kind(self) -> Option<ReferenceKind> {
        match self {
            Self::Painted => None,
            Self::Standard => Some(ReferenceKind::Standard),
            Self::Pinhole => Some(ReferenceKind::Pinhole),
            Self::Truth => Some(ReferenceKind::Truth),
            Self::Photograph => Some(ReferenceKind::Photograph),
            Self::Anaglyph => Some(ReferenceKind::Stereo(StereoForm::Anaglyph)),
            Self::SideBySide => Some(ReferenceKind::Stereo(StereoForm::SideBySide)),
        }
    }
}

/// The textures of the pictures, updated with them.
#[derive(Default)]
pub struct Textures {
    /// Created for the first picture on a graphics card.
    developer: Option<ToneMapper>,
    cached: [Option<CachedTexture>; DisplayedPicture::ALL.len()],
}

struct CachedTexture {
    drawn: Drawable,
    source: Source,
}

/// What a texture contains.
#[derive(Clone)]
enum Source {
    /// The live picture at this serial number of the screen.
    Live(u64),
    /// The live picture on a graphics card, and the tone it was mapped with.
    OnCard(u64, Tone),
    /// A reference picture, and the tone it was mapped with.
    Reference(Arc<Picture>, Tone),
}

impl Textures {
    /// The texture of a picture, if there is one.
    pub fn texture(
        &mut self,
        blitter: &Blitter,
        session: &Session,
        shown: DisplayedPicture,
        tone: Tone,
    ) -> Option<&Drawable> {
        let cached = &mut self.cached[shown as usize];
        match shown.reference_kind() {
            None => match session.screen().on_card() {
                Some(on_card) => {
                    let developer = self.developer.get_or_insert_with(|| ToneMapper::new(blitter));
                    show_on_card(cached, (blitter, developer), session.screen(), on_card);
                }
                None => show_live(cached, blitter, session.screen()),
            },
            Some(kind) => {
                let picture = session.reference(kind).map(|reference| &reference.picture);
                show_reference(cached, blitter, picture, tone);
            }
        }
        cached.as_ref().map(|held| &held.drawn)
    }
}

/// Uploads the changed part of the live picture.
fn show_live(cached: &mut Option<CachedTexture>, blitter: &Blitter, screen: &Screen) {
    let size = screen.size();
    if size.contains(&0) {
        *cached = None;
        return;
    }
    let previous = cached.take().filter(|held| held.drawn.size() == size);
    let (drawn, last_serial) = match previous {
        Some(CachedTexture { drawn, source: Source::Live(serial) }) => (drawn, Some(serial)),
        _ => (blitter.picture(size), None),
    };
    let changed = last_serial.map_or(Some(size.map(|side| 0..side)), |serial| screen.changed_since(serial));
    if let Some(rectangle) = changed {
        blitter.write(&drawn, screen.pixels(), &rectangle);
    }
    *cached = Some(CachedTexture { drawn, source: Source::Live(screen.serial()) });
}

/// Tone maps the changed part of a picture on a graphics card.
fn show_on_card(
    cached: &mut Option<CachedTexture>,
    (blitter, developer): (&Blitter, &ToneMapper),
    screen: &Screen,
    (picture, tone): (&PictureOnCard, Tone),
) {
    let size = screen.size();
    let previous = cached.take().filter(|held| held.drawn.size() == size);
    let (drawn, changed) = match previous {
        Some(CachedTexture { drawn, source: Source::OnCard(serial, last_tone) }) if last_tone == tone => {
            (drawn, screen.changed_since(serial))
        }
        Some(CachedTexture { drawn, source: Source::OnCard(..) }) => (drawn, Some(size.map(|side| 0..side))),
        _ => (developer.picture(blitter, size), Some(size.map(|side| 0..side))),
    };
    if let Some(rectangle) = changed {
        developer.tone_map(picture, tone, &drawn, &rectangle);
    }
    *cached = Some(CachedTexture { drawn, source: Source::OnCard(screen.serial(), tone) });
}

/// Uploads a reference picture if it or the tone changed.
fn show_reference(
    cached: &mut Option<CachedTexture>,
    blitter: &Blitter,
    picture: Option<&Arc<Picture>>,
    tone: Tone,
) {
    let Some(picture) = picture else {
        *cached = None;
        return;
    };
    let holds = |source: &Source| matches!(source, Source::Reference(last_picture, last_tone) if Arc::ptr_eq(last_picture, picture) && *last_tone == tone);
    if cached.as_ref().is_some_and(|held| holds(&held.source)) {
        return;
    }
    let size = [picture.width, picture.height];
    let previous = cached.take().map(|held| held.drawn).filter(|drawn| drawn.size() == size);
    let drawn = previous.unwrap_or_else(|| blitter.picture(size));
    blitter.write(&drawn, &to_screen(picture, tone), &size.map(|side| 0..side));
    *cached = Some(CachedTexture { drawn, source: Source::Reference(picture.clone(), tone) });
}
