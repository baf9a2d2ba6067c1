//! The live picture, where it was made.

use lens::Picture;
use splat::PictureOnCard;
use std::sync::Arc;
use trace::truth::Region;

/// The live picture: as it was when it was shown, or in the memory of a graphics card, which shows it from there.
#[derive(Clone, Debug)]
pub enum LivePicture {
    /// As it was.
    InMemory(Arc<Picture>),
    /// As it is by now.
    OnCard(PictureOnCard),
}

impl LivePicture {
    /// Columns and rows, px.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::InMemory(picture) => [picture.width, picture.height],
            Self::OnCard(picture) => picture.size(),
        }
    }

    /// Whether it was on a card that is lost.
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::OnCard(picture) if picture.is_lost())
    }

    /// Its pixels, brought back from the card if they are there, which takes some milliseconds. `None` where that was lost: the
    /// next picture is made by the processor.
    pub fn fetch(&self) -> Option<Arc<Picture>> {
        match self {
            Self::InMemory(picture) => Some(picture.clone()),
            Self::OnCard(picture) => picture.read(0..picture.size()[1]).map(Arc::new),
        }
    }

    /// The pixels of a region, which must lie in the picture. `None` where the card was lost.
    pub fn fetch_region(&self, region: Region) -> Option<Picture> {
        let rows = region.y..region.y + region.height;
        let row_picture;
        let (picture, first) = match self {
            Self::InMemory(picture) => (&**picture, rows.start),
            Self::OnCard(picture) => {
                row_picture = picture.read(rows.clone())?;
                (&row_picture, 0)
            }
        };
        let mut cut = Picture::black(region.width, region.height);
        let (width, across) = (picture.width as usize, region.width as usize);
        for (k, row) in (first..first + region.height).enumerate() {
            let from = row as usize * width + region.x as usize;
            let to = k * across..(k + 1) * across;
            cut.radiance[to.clone()].copy_from_slice(&picture.radiance[from..from + across]);
            cut.coverage[to].copy_from_slice(&picture.coverage[from..from + across]);
        }
        Some(cut)
    }
}

/// A picture that was made, to be shown.
#[derive(Clone)]
pub(crate) enum PictureSource<'a> {
    /// In the processor's memory.
    InMemory(&'a Picture),
    /// On a card.
    OnCard(PictureOnCard),
}
