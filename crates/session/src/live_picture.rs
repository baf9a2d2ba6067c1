//! The live picture, where it was made.

use lens::Picture;
use splat::PictureOnCard;
use std::sync::Arc;

/// The live picture: as it was when it was shown, or in the memory of a graphics card, which shows it from there.
#[derive(Clone, Debug)]
pub enum LivePicture {
    /// As it was.
    Here(Arc<Picture>),
    /// As it is by now.
    There(PictureOnCard),
}

impl LivePicture {
    /// Columns and rows, px.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Here(picture) => [picture.width, picture.height],
            Self::There(picture) => picture.size(),
        }
    }

    /// Its pixels, brought back from the card if they are there, which takes some milliseconds. `None` where that was lost: the
    /// next picture is made by the processor.
    pub fn bring(&self) -> Option<Arc<Picture>> {
        match self {
            Self::Here(picture) => Some(picture.clone()),
            Self::There(picture) => picture.read().map(Arc::new),
        }
    }
}

/// A picture that was made, to be shown.
#[derive(Clone)]
pub(crate) enum Source<'a> {
    /// In the processor's memory.
    Here(&'a Picture),
    /// On a card.
    There(PictureOnCard),
}
