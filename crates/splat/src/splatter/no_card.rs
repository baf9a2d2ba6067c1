//! Where this crate is built without graphics cards: the processor sums.

use super::error::SplatError;
use super::resolve_steps::Finish;
use crate::draw::Pen;
use crate::draw_list::{Changes, Scene};
use crate::nodes::Nodes;
use crate::resolve::balance::Gains;
use lens::Picture;
use progress::Progress;
use std::convert::Infallible;
use std::ops::Range;

/// No card.
#[derive(Default)]
pub struct Card;

impl Card {
    pub fn replace(&mut self, _gpu: Option<Infallible>) {}

    pub fn bypass(&mut self, _bypasses: bool) -> bool {
        false
    }

    pub fn twin(&self) -> Self {
        Self
    }

    pub fn upload_nodes(&mut self, _nodes: &Nodes, _size: [usize; 2]) {}

    pub fn invalidate_aperture(&mut self) {}

    pub fn begin(&self) {}

    pub fn invalidate_paint(&mut self) {}

    pub fn has_sums(&self) -> bool {
        false
    }

    pub fn is_lost(&self) -> bool {
        false
    }

    pub fn bytes(&self) -> [usize; 2] {
        [0; 2]
    }

    pub fn sum(&mut self, _scene: &Scene, _progress: &dyn Progress) -> Option<Result<(), SplatError>> {
        None
    }

    pub fn change(&mut self, _pen: &Pen, _changes: &Changes) -> Option<Result<(), SplatError>> {
        None
    }

    pub fn find_shares(&mut self, _nodes: &Nodes) -> Result<Gains, SplatError> {
        Err(SplatError::Cancelled)
    }

    pub fn make_picture(
        &mut self,
        _nodes: &Nodes,
        _rows: Range<u32>,
        _finish: Finish,
        _gains: &Gains,
        _picture: &mut Picture,
    ) -> Result<(), SplatError> {
        Err(SplatError::Cancelled)
    }
}
