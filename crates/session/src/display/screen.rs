//! The live picture as the screen shows it, and where it changed lately.

use crate::display::picture_ring::Rectangle;
use focus::rectangle_union;
use render::{ScreenPixel, Tone};
use splat::PictureOnCard;
use std::collections::VecDeque;
use std::ops::Range;

/// Changes that are remembered: a window that looks at every frame needs one or two.
const MAX_REMEMBERED_CHANGES: usize = 16;

/// The live picture, exposed, tone mapped and encoded: ready to be shown. One on a graphics card is still to be.
#[derive(Debug, Default)]
pub struct Screen {
    size: [u32; 2],
    pixels: Vec<ScreenPixel>,
    on_card: Option<(PictureOnCard, Tone)>,
    /// Counts up with every change.
    serial: u64,
    /// What changed, with the serial after it.
    changes: VecDeque<(u64, Rectangle)>,
}

/// A rectangle of the picture that was made anew.
#[derive(Debug)]
pub(crate) struct Patch {
    /// Of the whole picture.
    pub size: [u32; 2],
    /// Columns and rows.
    pub rectangle: Rectangle,
    pub content: Content,
}

/// What is in it.
#[derive(Debug)]
pub(crate) enum Content {
    /// Row by row.
    Pixels(Vec<ScreenPixel>),
    /// What it holds in this rectangle of a card's memory.
    OnCard(PictureOnCard, Tone),
}

impl Patch {
    /// Whether it leaves nothing of what was shown.
    pub fn is_whole(&self) -> bool {
        self.rectangle == self.size.map(|side| 0..side)
    }
}

impl Screen {
    /// Columns and rows, px; 0 before the first picture.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// All pixels, row by row; none where the picture is [on a card](Self::on_card).
    pub fn pixels(&self) -> &[ScreenPixel] {
        &self.pixels
    }

    /// The picture on a graphics card, linear, and how it is to be shown.
    pub fn on_card(&self) -> Option<(&PictureOnCard, Tone)> {
        self.on_card.as_ref().map(|(picture, tone)| (picture, *tone))
    }

    /// A number that grows with every change of what is shown.
    pub fn serial(&self) -> u64 {
        self.serial
    }

    /// Columns and rows that hold all that changed since `serial`; `None` where nothing did.
    pub fn changed_since(&self, serial: u64) -> Option<[Range<u32>; 2]> {
        if serial == self.serial {
            return None;
        }
        let oldest = self.changes.front().map_or(u64::MAX, |(after, _)| *after);
        if serial > self.serial || serial.saturating_add(1) < oldest {
            return Some(self.size.map(|side| 0..side));
        }
        let newer = self.changes.iter().filter(|(after, _)| *after > serial);
        newer.map(|(_, rectangle)| rectangle.clone()).reduce(|a, b| rectangle_union(&a, &b))
    }

    /// Nothing is shown any more.
    pub(crate) fn clear(&mut self) {
        *self = Self { serial: self.serial + 1, ..Self::default() };
    }

    /// Takes up what was made anew.
    pub(crate) fn apply_patch(&mut self, patch: Patch) {
        let width = patch.rectangle[0].len();
        if std::mem::replace(&mut self.size, patch.size) != patch.size {
            self.pixels = Vec::new();
        }
        match patch.content {
            Content::OnCard(picture, tone) => {
                self.on_card = Some((picture, tone));
                self.pixels = Vec::new();
            }
            Content::Pixels(patch_pixels) => {
                self.on_card = None;
                self.pixels.resize(patch.size[0] as usize * patch.size[1] as usize, [0; 4]);
                for (pixels, row) in patch_pixels.chunks_exact(width.max(1)).zip(patch.rectangle[1].clone()) {
                    let first = row as usize * self.size[0] as usize + patch.rectangle[0].start as usize;
                    self.pixels[first..first + width].copy_from_slice(pixels);
                }
            }
        }
        self.serial += 1;
        self.changes.push_back((self.serial, patch.rectangle));
        if self.changes.len() > MAX_REMEMBERED_CHANGES {
            self.changes.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_looks_learns_what_changed_since() {
        let mut screen = Screen::default();
        assert_eq!(screen.changed_since(0), None);
        let patch = |rectangle: Rectangle, value: u8| {
            let pixels = vec![[value; 4]; rectangle[0].len() * rectangle[1].len()];
            Patch { size: [10, 8], rectangle, content: Content::Pixels(pixels) }
        };
        screen.apply_patch(patch([0..10, 0..8], 1));
        assert_eq!(screen.changed_since(0), Some([0..10, 0..8]));
        let before = screen.serial();
        screen.apply_patch(patch([2..4, 3..5], 2));
        screen.apply_patch(patch([6..7, 1..2], 3));
        assert_eq!(screen.changed_since(before), Some([2..7, 1..5]));
        assert_eq!(screen.changed_since(before + 1), Some([6..7, 1..2]));
        assert_eq!(screen.changed_since(screen.serial()), None);
        let values = [(0, 0), (2, 3), (3, 4), (4, 4), (6, 1)].map(|(x, y)| screen.pixels()[y * 10 + x][0]);
        assert_eq!(values, [1, 2, 2, 1, 3]);
        for _ in 0..MAX_REMEMBERED_CHANGES {
            screen.apply_patch(patch([0..1, 0..1], 4));
        }
        assert_eq!(screen.changed_since(before), Some([0..10, 0..8]), "what was forgotten may be anywhere");
        assert_eq!(screen.changed_since(99), Some([0..10, 0..8]), "a serial of another screen");
    }
}
