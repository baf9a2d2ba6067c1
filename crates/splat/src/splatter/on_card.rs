//! Summing on a graphics card: the public methods of [`Splatter`].

use super::{SplatError, Splatter};
use crate::gpu::PictureOnCard;
use graphics_card::Gpu;

impl Splatter {
    /// Sums on a graphics card from the next [`Self::render`] on, or on the processor. The picture has the same bits.
    ///
    /// If the card is lost, or cannot hold the picture, the processor takes over and nothing else changes.
    pub fn use_gpu(&mut self, gpu: Option<Gpu>) {
        self.card.replace(gpu);
        self.shares_of = None;
    }

    /// Sets whether pictures stay on the card (no, by default): they are shown from there ([`Self::picture_on_card`]), and
    /// [`Self::picture`] is that of the last [`Self::fetch_picture`].
    pub fn keep_on_card(&mut self, keeps: bool) {
        self.card.keeps_picture = keeps;
    }

    /// The picture on the card, which the next sum writes over. None where it is summed on the processor.
    pub fn picture_on_card(&self) -> Option<PictureOnCard> {
        self.card.picture(self.size)
    }

    /// Brings back what of the picture stayed on the card; from the processor, summed anew, if that is lost.
    ///
    /// # Errors
    /// [`SplatError::Overflow`] if the picture is too bright for its integers.
    pub fn fetch_picture(&mut self) -> Result<(), SplatError> {
        let Some(fetched) = self.card.fetch(&mut self.resolver.picture) else { return Ok(()) };
        if self.drop_lost_card() { self.sum(&progress::Unwatched) } else { fetched }
    }

    /// Sums on the processor what a card had summed that is lost. Returns whether it is.
    ///
    /// # Errors
    /// [`SplatError::Overflow`] if the picture is too bright for its integers.
    pub fn leave_lost_card(&mut self) -> Result<bool, SplatError> {
        let was_summed = self.card.has_sums() && self.has_paint();
        let is_left = self.drop_lost_card();
        if is_left && was_summed {
            self.sum(&progress::Unwatched)?;
        }
        Ok(is_left)
    }

    /// The seconds by the card's own clock that the last picture took, from its first sum to its last pixel; `None`
    /// where it has no clock.
    pub fn seconds_on_card(&self) -> Option<f64> {
        self.card.seconds()
    }

    /// The card that is summed on; `None` where it is the processor.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.card.gpu()
    }
}

#[cfg(test)]
impl Splatter {
    /// The sums on the processor.
    pub(crate) fn sums(&self) -> &crate::sums::Sums {
        &self.sums
    }

    /// The sums on the card.
    pub(crate) fn sums_on_card(&self) -> Option<&crate::gpu::GpuSums> {
        self.card.sums()
    }
}
