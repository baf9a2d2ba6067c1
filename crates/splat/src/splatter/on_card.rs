//! Sums on a graphics card, and on the processor again once the card is lost.

use super::{SplatError, Splatter, Summed, Wanted};
use crate::balance::{NO_REST, rest};
use crate::drawn::hull;
use crate::gpu::{Gpu, GpuError, GpuSums, PictureOnCard};
use progress::Progress;
use std::ops::Range;

/// The card that is used, if one is.
#[derive(Default)]
pub struct Card {
    gpu: Option<Gpu>,
    /// Its sums, from the first render on.
    sums: Option<GpuSums>,
    is_lost: bool,
    /// Whether pictures stay there until they are asked for.
    keeps: bool,
    /// The rows that are newer there.
    newer: Range<u32>,
}

impl Card {
    /// The next picture is of another aperture.
    pub fn forget_aperture(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.forget_aperture();
        }
    }

    /// Work on another picture begins.
    pub fn begin(&self) {
        if let Some(sums) = &self.sums {
            sums.begin();
        }
    }

    /// The next picture is painted otherwise.
    pub fn forget_paint(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.forget_paint();
        }
    }

    /// Whether the sums are on it.
    pub fn has_sums(&self) -> bool {
        self.sums.is_some()
    }

    /// Bytes of the hierarchy and of the sums.
    pub fn bytes(&self) -> [usize; 2] {
        self.sums.as_ref().map_or([0; 2], GpuSums::bytes)
    }

    /// What came of work on the card. The loss of the card stops all work on it.
    fn came_of(&mut self, result: Result<(), GpuError>) -> Result<(), SplatError> {
        result.map_err(|error| match error {
            GpuError::Overflow => SplatError::Overflow,
            GpuError::Cancelled => SplatError::Cancelled,
            GpuError::Lost => {
                self.is_lost = true;
                SplatError::Cancelled
            }
        })
    }
}

/// Each does its work on the card, and is `None` where the sums are not on one.
impl Splatter {
    /// Sums on a graphics card from the next [`Self::render`] on, or on the processor. The picture has the same bits.
    ///
    /// Once the card is lost, or where it does not hold the picture, the processor goes on: nothing else is lost.
    pub fn use_gpu(&mut self, gpu: Option<Gpu>) {
        self.card = Card { gpu, keeps: self.card.keeps, ..Card::default() };
        self.shares_of = None;
    }

    /// Sets whether pictures stay on the card (no, by default): they are shown from there ([`Self::picture_on_card`]), and
    /// [`Self::picture`] is that of the last [`Self::fetch`].
    pub fn keep_on_card(&mut self, keeps: bool) {
        self.card.keeps = keeps;
    }

    /// The picture on the card, which the next sum writes over. None where it is summed on the processor.
    pub fn picture_on_card(&self) -> Option<PictureOnCard> {
        let (gpu, sums) = (self.card.gpu.as_ref()?, self.card.sums.as_ref()?);
        let camera = &self.salf.camera;
        Some(PictureOnCard::of(gpu, sums.picture(), [camera.width, camera.height]))
    }

    /// Brings back what of the picture stayed on the card; from the processor, summed anew, if that is lost.
    pub fn fetch(&mut self) -> Result<(), SplatError> {
        let rows = std::mem::take(&mut self.card.newer);
        let (Some(sums), false) = (&self.card.sums, rows.is_empty()) else { return Ok(()) };
        let read = sums.read_picture(rows, &mut self.picture);
        let fetched = self.card.came_of(read);
        if self.drop_lost_card() { self.sum(&progress::Unwatched) } else { fetched }
    }

    /// The seconds by the card's own clock that the last picture took, from its first sum to its last pixel; none where it
    /// has no clock.
    pub fn seconds_on_card(&self) -> Option<f64> {
        self.card.sums.as_ref()?.seconds()
    }

    /// Sums on the card of another of the same light field, whose nodes are there.
    pub(super) fn use_card_of(&mut self, other: &Self) {
        self.use_gpu(other.card.gpu.clone());
        self.card.keeps = other.card.keeps;
        // Where it has no room, the next sum finds out.
        self.card.sums = other.card.sums.as_ref().and_then(|sums| sums.twin().ok());
    }

    /// The card that is summed on; none where it is the processor.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.card.gpu.as_ref()
    }

    /// Uploads the nodes if that has not been done.
    pub(super) fn take_up_card(&mut self) {
        let (Some(gpu), Some(nodes), None) = (&self.card.gpu, &self.nodes, &self.card.sums) else { return };
        let camera = &self.salf.camera;
        match GpuSums::new(gpu, nodes, [camera.width as usize, camera.height as usize]) {
            Ok(sums) => self.card.sums = Some(sums),
            Err(_) => self.card = Card::default(),
        }
    }

    /// Goes on without a card that was lost. Returns whether one was.
    pub(super) fn drop_lost_card(&mut self) -> bool {
        let was_lost = self.card.is_lost;
        if was_lost {
            self.use_gpu(None);
        }
        was_lost
    }

    /// See [`Splatter::sum_nodes`].
    pub(super) fn sum_nodes_on_card(
        &mut self,
        summed: Summed,
        progress: &dyn Progress,
    ) -> Option<Result<(), SplatError>> {
        let (nodes, sums) = (self.nodes.as_ref()?, self.card.sums.as_mut()?);
        let paint = summed.paint(&self.paint);
        let scene = self.aperture.scene(nodes, &self.lens, paint, &self.salf.camera);
        let set = sums.set(&scene, progress);
        Some(self.card.came_of(set))
    }

    /// See [`Splatter::resolve`].
    pub(super) fn resolve_on_card(
        &mut self,
        rows: Range<u32>,
        wanted: Wanted,
    ) -> Option<Result<(), SplatError>> {
        self.card.sums.as_ref()?;
        let resolved = self.resolve_there(rows, wanted);
        Some(self.card.came_of(resolved))
    }

    fn resolve_there(&mut self, rows: Range<u32>, wanted: Wanted) -> Result<(), GpuError> {
        let (is_evened, is_balanced) = (self.is_evened(), self.is_balanced());
        let (Some(nodes), Some(sums)) = (&self.nodes, &mut self.card.sums) else {
            return Err(GpuError::Lost);
        };
        let gains = &mut self.balance.gains;
        if wanted.has_shares() {
            *gains = sums.find_shares(nodes)?;
        }
        if wanted.has_picture() {
            sums.integrate(nodes, &rows, is_evened)?;
            let rest = if is_balanced { rest(&sums.shared_sums(gains)?) } else { NO_REST };
            let asked_for = sums.make_picture(gains, rest, &rows);
            if self.card.keeps {
                let newer = std::mem::take(&mut self.card.newer);
                self.card.newer = hull([newer, rows].into_iter().filter(|rows| !rows.is_empty()));
                return sums.wait_for(asked_for);
            }
            sums.read_picture(rows, &mut self.picture)?;
        }
        Ok(())
    }

    /// See [`Splatter::change`].
    pub(super) fn change_on_card(&mut self) -> Option<Result<(), SplatError>> {
        let (nodes, sums) = (self.nodes.as_ref()?, self.card.sums.as_mut()?);
        let pen = self.aperture.pen(nodes, &self.lens);
        let changed = sums.change(&pen, &self.changes);
        Some(self.card.came_of(changed))
    }
}

#[cfg(test)]
impl Splatter {
    /// The sums on the processor.
    pub(crate) fn sums(&self) -> &crate::sums::Sums {
        &self.sums
    }

    /// The sums on the card.
    pub(crate) fn sums_on_card(&self) -> Option<&GpuSums> {
        self.card.sums.as_ref()
    }
}
