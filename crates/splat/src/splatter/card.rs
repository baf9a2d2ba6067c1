//! The graphics card that a picture is summed on, until it is lost.

use super::error::SplatError;
use super::resolve_steps::Finish;
use crate::draw::Pen;
use crate::draw_list::{Changes, Scene, hull};
use crate::gpu::{GpuError, GpuSums, PictureOnCard};
use crate::nodes::Nodes;
use crate::resolve::balance::{Gains, NO_REST, rest};
use graphics_card::Gpu;
use lens::Picture;
use progress::Progress;
use std::ops::Range;

/// The card that is used, if one is.
#[derive(Default)]
pub struct Card {
    gpu: Option<Gpu>,
    /// The card that would be used, while the processor is.
    bypassed: Option<Gpu>,
    /// Its sums, from the first render on.
    sums: Option<GpuSums>,
    is_lost: bool,
    /// Whether pictures stay on the card until they are fetched.
    pub keeps_picture: bool,
    /// The rows that are newer there.
    stale_rows: Range<u32>,
}

impl Card {
    /// Uses another card, or the processor if `None`; sums must be made anew.
    pub fn replace(&mut self, gpu: Option<Gpu>) {
        *self = Self { gpu, keeps_picture: self.keeps_picture, ..Self::default() };
    }

    /// Uses the processor in place of the card, or the card again. Returns whether that is a change.
    pub fn bypass(&mut self, bypasses: bool) -> bool {
        let keeps_picture = self.keeps_picture;
        match (bypasses, self.gpu.take(), self.bypassed.take()) {
            (true, Some(gpu), _) => *self = Self { bypassed: Some(gpu), keeps_picture, ..Self::default() },
            (false, None, Some(gpu)) => *self = Self { gpu: Some(gpu), keeps_picture, ..Self::default() },
            (_, gpu, bypassed) => {
                (self.gpu, self.bypassed) = (gpu, bypassed);
                return false;
            }
        }
        true
    }

    /// The same card with other sums of the same nodes, which are uploaded already.
    pub fn twin(&self) -> Self {
        // Where it has no room, the next sum finds out.
        let sums = self.sums.as_ref().and_then(|sums| sums.twin().ok());
        Self { gpu: self.gpu.clone(), sums, keeps_picture: self.keeps_picture, ..Self::default() }
    }

    /// Uploads the nodes, if that has not been done, for a picture of `size` columns and rows.
    pub fn upload_nodes(&mut self, nodes: &Nodes, size: [usize; 2]) {
        let (Some(gpu), None) = (&self.gpu, &self.sums) else { return };
        match GpuSums::new(gpu, nodes, size) {
            Ok(sums) => self.sums = Some(sums),
            Err(_) => *self = Self::default(),
        }
    }

    /// The next picture is of another aperture.
    pub fn invalidate_aperture(&mut self) {
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
    pub fn invalidate_paint(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.forget_paint();
        }
    }

    /// Whether the sums are on the card.
    pub fn has_sums(&self) -> bool {
        self.sums.is_some()
    }

    /// Whether the card is lost: work on it has failed, or its driver says so.
    pub fn is_lost(&self) -> bool {
        self.is_lost || self.gpu.as_ref().is_some_and(Gpu::is_lost)
    }

    /// The card, if one is used.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.gpu.as_ref()
    }

    /// The memory on the card, in bytes: of the nodes, then of the sums.
    pub fn bytes(&self) -> [usize; 2] {
        self.sums.as_ref().map_or([0; 2], GpuSums::bytes)
    }

    /// See [`Splatter::seconds_on_card`](crate::Splatter::seconds_on_card).
    pub fn seconds(&self) -> Option<f64> {
        self.sums.as_ref()?.seconds()
    }

    /// The picture on the card, of `size` columns and rows; `None` if it is not there.
    pub fn picture(&self, size: [u32; 2]) -> Option<PictureOnCard> {
        let (gpu, sums) = (self.gpu.as_ref()?, self.sums.as_ref()?);
        Some(PictureOnCard::from_buffer(gpu, sums.picture(), size))
    }

    /// Sums what a scene sends; `None` where the sums are not on a card.
    ///
    /// # Errors
    /// The work was cancelled, the card is lost, or an integer has overflowed.
    pub fn sum(&mut self, scene: &Scene, progress: &dyn Progress) -> Option<Result<(), SplatError>> {
        let set = self.sums.as_mut()?.set(scene, progress);
        Some(self.convert_result(set))
    }

    /// Takes nodes away and adds others; `None` where the sums are not on a card.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn change(&mut self, pen: &Pen, changes: &Changes) -> Option<Result<(), SplatError>> {
        let changed = self.sums.as_mut()?.change(pen, changes);
        Some(self.convert_result(changed))
    }

    /// Finds the shares of a standard picture, which stay on the card, and the gains.
    ///
    /// # Errors
    /// The card is lost or has no sums, or an integer has overflowed.
    pub fn find_shares(&mut self, nodes: &Nodes) -> Result<Gains, SplatError> {
        let gains = match &mut self.sums {
            Some(sums) => sums.find_shares(nodes),
            None => Err(GpuError::Lost),
        };
        self.convert_result(gains)
    }

    /// Makes pixel rows of a picture, and fetches them unless pictures stay on the card.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn make_picture(
        &mut self,
        nodes: &Nodes,
        rows: Range<u32>,
        finish: Finish,
        gains: &Gains,
        picture: &mut Picture,
    ) -> Result<(), SplatError> {
        let made = self.try_make_picture(nodes, rows, finish, gains, picture);
        self.convert_result(made)
    }

    fn try_make_picture(
        &mut self,
        nodes: &Nodes,
        rows: Range<u32>,
        finish: Finish,
        gains: &Gains,
        picture: &mut Picture,
    ) -> Result<(), GpuError> {
        let sums = self.sums.as_mut().ok_or(GpuError::Lost)?;
        sums.integrate(nodes, &rows, finish == Finish::Evened)?;
        let is_balanced = finish == Finish::Balanced;
        let rest = if is_balanced { rest(&sums.shared_sums(gains)?) } else { NO_REST };
        sums.make_picture(gains, rest, &rows);
        if !self.keeps_picture {
            return sums.read_picture(rows, picture);
        }
        let newer = std::mem::take(&mut self.stale_rows);
        self.stale_rows = hull([newer, rows].into_iter().filter(|rows| !rows.is_empty()));
        sums.finish()
    }

    /// Brings back what of the picture is newer on the card; `None` where nothing is.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn fetch(&mut self, picture: &mut Picture) -> Option<Result<(), SplatError>> {
        let rows = std::mem::take(&mut self.stale_rows);
        let sums = self.sums.as_ref().filter(|_| !rows.is_empty())?;
        let read = sums.read_picture(rows, picture);
        Some(self.convert_result(read))
    }

    /// What came of work on the card. The loss of the card stops all work on it.
    fn convert_result<T>(&mut self, result: Result<T, GpuError>) -> Result<T, SplatError> {
        result.map_err(|error| match error {
            GpuError::Overflow => SplatError::Overflow,
            GpuError::Cancelled => SplatError::Cancelled,
            GpuError::Lost => {
                self.is_lost = true;
                SplatError::Cancelled
            }
        })
    }

    /// The sums on the card, if they are there.
    #[cfg(test)]
    pub fn sums(&self) -> Option<&GpuSums> {
        self.sums.as_ref()
    }
}
