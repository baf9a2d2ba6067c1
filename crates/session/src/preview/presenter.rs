//! How pictures come to be shown: where one differs from the one before, in what tone, with which number.

use crate::display::{
    Content, Layer, LivePicture, Patch, PictureRing, PictureSource, Rectangle, darkening_stops,
    enlarged_part, enlarged_rectangle, filled, whole,
};
use crate::preview::mailbox::Shared;
use crate::preview::picture::{DrawingCosts, PictureTimes, Preview, PreviewKind, Quality};
use lens::{Camera, Exposure, Picture};
use render::{Modelled, Tone, ToneCurve, to_screen};
use salf::Salf;
use splat::PictureOnCard;
use std::sync::Arc;
use std::time::Instant;
use trace::truth::Region;

/// A picture that was made.
pub(crate) struct NewPicture<'a> {
    pub picture: PictureSource<'a>,
    pub camera: &'a Camera,
    /// The size that it is shown in, if its pixels are means of many of those.
    pub enlarged_to: Option<[u32; 2]>,
    /// What is laid over it, in the size that it is shown in.
    pub layer: Option<Arc<dyn Layer>>,
    /// What it has to do with the one before.
    pub relation: Relation,
    pub kind: PreviewKind,
    pub quality: Quality,
    /// Seconds that it took.
    pub seconds: f64,
    pub modelled: Modelled,
}

/// What a picture has to do with the one that was followed before.
pub(crate) enum Relation {
    /// Nothing.
    New,
    /// It differs from it in this rectangle at most.
    Changed(Rectangle),
    /// It is a better picture of the same, to be laid over it.
    Overlay,
}

/// Shows pictures, each with a number.
pub(crate) struct Presenter {
    shared: Arc<Shared>,
    /// The newest picture.
    shown: Option<Preview>,
    /// It and those of before.
    pictures: PictureRing,
    /// What lies over it.
    layer: Option<Arc<dyn Layer>>,
    /// It, if it is on a card.
    on_card: Option<PictureOnCard>,
    tone: Tone,
    last_id: u64,
    /// Which of the session's documents is shown.
    pub generation: u64,
    /// Whether it was looked at how bright it is.
    is_glare_checked: bool,
    /// How many changes of the map the next picture has seen.
    pub map_serial: u64,
    /// When work on the next picture began.
    pub begun: Instant,
    /// What pictures cost, where that is known.
    pub costs: DrawingCosts,
}

impl Presenter {
    /// A presenter that has shown nothing.
    pub fn new(shared: Arc<Shared>) -> Self {
        Self {
            shared,
            shown: None,
            pictures: PictureRing::default(),
            layer: None,
            on_card: None,
            tone: Tone::default(),
            last_id: 0,
            generation: 0,
            is_glare_checked: false,
            map_serial: 0,
            begun: Instant::now(),
            costs: DrawingCosts::default(),
        }
    }

    /// Begins another document, with the number `generation`: what was shown is not of it.
    pub fn open(&mut self, generation: u64) {
        self.generation = generation;
        self.is_glare_checked = false;
        self.shown = None;
        self.costs = DrawingCosts::default();
    }

    /// Notes that what was shown is lost: whatever comes next is shown.
    pub fn forget_shown(&mut self) {
        self.shown = None;
    }

    /// Tells if a document must be shown darker; its first light field says so.
    pub fn check_glare(&mut self, salf: &Salf) {
        if !std::mem::replace(&mut self.is_glare_checked, true)
            && let Some(stops) = darkening_stops(salf)
        {
            self.shared.publish_glare(self.generation, stops);
        }
    }

    /// The newest picture; `None` before the first.
    pub fn shown(&self) -> Option<&Preview> {
        self.shown.as_ref()
    }

    /// The picture that is worked with, beneath a better one that may lie over it; none of one on a card.
    pub fn followed(&self) -> Option<Arc<Picture>> {
        self.pictures.followed()
    }

    /// By which exposure pictures are shown.
    pub fn exposure(&self) -> Exposure {
        self.tone.exposure
    }

    /// Shows a picture in place of the one shown.
    pub fn show(&mut self, new_picture: NewPicture) {
        let summed = Instant::now();
        let is_new = matches!(new_picture.relation, Relation::New);
        self.layer = new_picture.layer;
        let (picture, changed) = self.take_up(new_picture.picture, new_picture.relation);
        self.last_id += 1;
        let preview = Preview {
            id: self.last_id,
            enlarged_to: new_picture.enlarged_to.filter(|_| matches!(picture, LivePicture::InMemory(_))),
            picture,
            kind: new_picture.kind,
            quality: new_picture.quality,
            costs: self.costs,
            camera: new_picture.camera.clone(),
            seconds: new_picture.seconds,
            modelled: new_picture.modelled,
            map_serial: self.map_serial,
            generation: self.generation,
        };
        self.shown = Some(preview.clone());
        let patch = changed.map(|rectangle| self.patch(&preview, rectangle));
        let times =
            PictureTimes { map_serial: self.map_serial, begun: self.begun, summed, finished: Instant::now() };
        self.shared.publish(preview, patch, Some(times));
        if is_new {
            // The first dabs on it find room.
            self.pictures.make_room();
        }
    }

    /// Shows pictures in another tone from now on, the newest one at once.
    pub fn set_tone(&mut self, tone: Tone) {
        if tone == self.tone {
            return;
        }
        self.tone = tone;
        if let Some(mut preview) = self.shown.clone() {
            self.last_id += 1;
            preview.id = self.last_id;
            let patch = self.patch(&preview, preview.picture.size().map(|side| 0..side));
            self.shared.publish(preview, Some(patch), None);
        }
    }

    /// The picture that is shown from now on, and where it differs from the one before.
    fn take_up(&mut self, picture: PictureSource, relation: Relation) -> (LivePicture, Option<Rectangle>) {
        let picture = match picture {
            PictureSource::InMemory(picture) => picture,
            PictureSource::OnCard(picture) => return self.take_up_on_card(&picture, relation),
        };
        self.on_card = None;
        let (picture, changed) = match relation {
            Relation::New => (self.pictures.begin(picture), Some(whole(picture))),
            Relation::Changed(rectangle) => self.pictures.follow(picture, &rectangle),
            Relation::Overlay => self.pictures.overlay(picture),
        };
        (LivePicture::InMemory(picture), changed)
    }

    /// The same of one on a card: it does not come back.
    fn take_up_on_card(
        &mut self,
        picture: &PictureOnCard,
        relation: Relation,
    ) -> (LivePicture, Option<Rectangle>) {
        // What is kept of the processor's pictures is of before.
        self.pictures = PictureRing::default();
        let reusable = self.on_card.take_if(|shown| shown.is_like(picture));
        let (shown, changed) = match (reusable, relation) {
            (Some(shown), Relation::Changed(rectangle)) => (shown, rectangle),
            // Where there is no room for another, what is summed is shown while it is.
            (reusable, _) => {
                let shown =
                    reusable.or_else(|| PictureOnCard::new_like(picture)).unwrap_or_else(|| picture.clone());
                (shown, picture.size().map(|side| 0..side))
            }
        };
        if !shown.is_same(picture) {
            shown.copy(picture, &changed);
        }
        self.on_card = Some(shown.clone());
        (LivePicture::OnCard(shown), Some(changed))
    }

    /// A rectangle of a picture, as the screen shows it; all of one that is seen through a point of the aperture, since what fills its
    /// holes comes from far.
    fn patch(&self, preview: &Preview, rectangle: Rectangle) -> Patch {
        let is_holed = preview.camera.aperture.is_sub_aperture();
        if is_holed && let Some(picture) = preview.picture.fetch() {
            let whole_rectangle = preview.picture.size().map(|side| 0..side);
            let filled = LivePicture::InMemory(Arc::new(filled(&picture)));
            return self.patch_of(preview, &filled, whole_rectangle);
        }
        self.patch_of(preview, &preview.picture, rectangle)
    }

    fn patch_of(&self, preview: &Preview, picture: &LivePicture, rectangle: Rectangle) -> Patch {
        if let (Some(size), LivePicture::InMemory(picture)) = (preview.enlarged_to, picture) {
            let rectangle = enlarged_rectangle(picture, size, &rectangle);
            let mut part = enlarged_part(picture, size, rectangle.clone());
            if let Some(layer) = &self.layer {
                layer.lay_over(&mut part, &rectangle);
            }
            return Patch { size, rectangle, content: Content::Pixels(to_screen(&part, self.tone)) };
        }
        if let Some(layer) = &self.layer
            && let Some(mut part) = picture.fetch_region(region_of(&rectangle))
        {
            layer.lay_over(&mut part, &rectangle);
            let content = Content::Pixels(to_screen(&part, self.tone));
            return Patch { size: picture.size(), rectangle, content };
        }
        let content = match picture {
            LivePicture::InMemory(picture) => {
                Content::Pixels(self.tone.rectangle_to_screen(picture, rectangle.clone()))
            }
            LivePicture::OnCard(on_card) => match self.tone.display.curve {
                // Those of OpenColorIO are known here.
                ToneCurve::Ocio(_) => picture.fetch().map_or_else(
                    || Content::OnCard(on_card.clone(), self.tone),
                    |picture| Content::Pixels(self.tone.rectangle_to_screen(&picture, rectangle.clone())),
                ),
                _ => Content::OnCard(on_card.clone(), self.tone),
            },
        };
        Patch { size: picture.size(), rectangle, content }
    }
}

fn region_of([columns, rows]: &Rectangle) -> Region {
    Region { x: columns.start, y: rows.start, width: columns.len() as u32, height: rows.len() as u32 }
}
