//! The pictures that the view can show, as textures.

use crate::window::blit::{Blitter, Drawable};
use crate::window::picture_view::develop::ToneMapper;
use lens::Picture;
use session::{Document, ReferenceKind, Screen, Session, StereoForm, Tone, to_screen};
use splat::PictureOnCard;
use std::sync::Arc;

/// Which picture is shown.
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
    /// The live picture for two eyes, through glasses of red and cyan.
    Anaglyph,
    /// The same, one eye's beside the other's.
    SideBySide,
}

impl DisplayedPicture {
    /// All, as a menu offers them.
    pub const ALL: [Self; 7] = [
        Self::Painted,
        Self::Standard,
        Self::Pinhole,
        Self::Anaglyph,
        Self::SideBySide,
        Self::Truth,
        Self::Photograph,
    ];

    /// What it is called.
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

    /// What it is.
    pub fn tip(self) -> &'static str {
        match self {
            Self::Painted => "The live picture, as painted.",
            Self::Standard => "The same lens without any paint.",
            Self::Pinhole => "Everything sharp.",
            Self::Truth => "The picture as painted, by rays: slow and sure (F12 traces it anew).",
            Self::Anaglyph => {
                "The picture as painted for two eyes, through glasses of red (left) and cyan: what they fixate (Alt+H and a click) lies in the screen."
            }
            Self::SideBySide => {
                "The picture as painted for two eyes, the left one's on the left: for a stereoscope, or eyes that can do without. What they fixate: Alt+H and a click."
            }
            Self::Photograph => {
                "The photograph that the camera looks through, exposed as all of them together."
            }
        }
    }

    /// Whether there is such a picture of what is open.
    pub fn exists_for(self, document: Option<&Document>) -> bool {
        match self {
            Self::Photograph => document.is_some_and(|document| !document.stage.scene.views.is_empty()),
            Self::Anaglyph | Self::SideBySide => {
                document.is_some_and(|document| document.camera.aperture_radius > 0.0)
            }
            _ => true,
        }
    }

    /// Whether it is two pictures beside each other: nothing else can be laid over it.
    pub fn is_pair(self) -> bool {
        self == Self::SideBySide
    }

    /// The session's picture of it.
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

/// The textures of the pictures, each as new as its picture.
#[derive(Default)]
pub struct Textures {
    /// From the first picture on a card on.
    developer: Option<ToneMapper>,
    cached: [Option<CachedTexture>; DisplayedPicture::ALL.len()],
}

struct CachedTexture {
    drawn: Drawable,
    source: Source,
}

/// What a texture holds.
#[derive(Clone)]
enum Source {
    /// The live picture, after this many changes of the screen.
    Live(u64),
    /// The same from a graphics card, and how it was put on screen.
    OnCard(u64, Tone),
    /// A picture to compare with, and how it was put on screen.
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

/// Writes what changed on the screen.
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

/// Develops what changed of a picture on a graphics card.
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

/// Writes another picture, or the same one by another tone.
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
