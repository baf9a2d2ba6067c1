//! How much of each pixel's coverage samples have.
//!
//! A matte is the picture of a scene in which some samples send 1 and all others nothing. It is made of the sums that make the picture, with
//! the same nodes, places and shares: mattes that leave no sample out sum to the coverage. Their light is not scaled by gains
//! ([`crate::resolve::balance`]), as coverage is not.

use super::error::SplatError;
use super::resolve_steps::{ResolveOutput, SummedPaint};
use super::{LensInUse, Splatter};
use lens::Picture;
use progress::{Progress, Stage};
use std::ops::Range;
use std::sync::Arc;

/// The number of sets of samples that are drawn at once: red, green and blue.
pub const SETS: usize = 3;

/// Draws mattes of a picture that was rendered.
pub struct Mattes(Splatter);

impl Splatter {
    /// Makes samples black, before the first [`Self::render`]: they still cover what lies behind them.
    pub fn blacken(&mut self, is_black: impl Fn(u32) -> bool + Sync) {
        if let Some(nodes) = &mut self.nodes {
            Arc::make_mut(nodes).relight(&|sample, rgb| if is_black(sample) { [0.0; 3] } else { rgb });
        }
    }

    /// Converts to mattes of what was rendered. They are summed on the processor.
    pub fn into_mattes(mut self) -> Mattes {
        self.card.replace(None);
        self.shares_of = None;
        // Mattes are green's.
        self.colours = None;
        self.set_live(true);
        Mattes(self)
    }
}

impl Mattes {
    /// Draws [`SETS`] mattes at once, as the red, green and blue of a picture: the coverage of the samples that `in_sets` assigns to
    /// the first, the second and the third set. The picture's coverage is that of all samples.
    ///
    /// # Errors
    /// [`SplatError::Cancelled`] if `progress` is cancelled; [`SplatError::Overflow`] if the integers overflow.
    pub fn draw(
        &mut self,
        in_sets: &(impl Fn(u32) -> [bool; SETS] + Sync),
        progress: &dyn Progress,
    ) -> Result<Picture, SplatError> {
        let splatter = &mut self.0;
        let nodes = splatter.nodes.as_mut().ok_or(SplatError::Overflow)?;
        Arc::make_mut(nodes).relight(&|sample, _| in_sets(sample).map(|is_in| if is_in { 1.0 } else { 0.0 }));
        let has_shares = splatter.has_shares();
        let shares = Stage::new(progress, 0.0, if has_shares { 0.0 } else { 0.5 });
        let picture = Stage::new(progress, if has_shares { 0.0 } else { 0.5 }, 1.0);
        if !has_shares {
            splatter.in_finest_integers(|splatter| {
                splatter.sum_nodes(SummedPaint::Standard, &shares)?;
                splatter.resolve(splatter.frame(), ResolveOutput::Shares)
            })?;
            let lens: LensInUse = splatter.lens.clone();
            splatter.shares_of = Some((lens, false));
        }
        splatter.resolver.balance.reset();
        splatter.in_finest_integers(|splatter| {
            splatter.sum_nodes(SummedPaint::Painted, &picture)?;
            splatter.resolve(splatter.frame(), ResolveOutput::Picture)
        })?;
        Ok(splatter.picture().clone())
    }

    /// Calls `visit` with each sample of what was drawn last, and the columns and rows of the picture that its light may reach.
    pub fn reaches(&self, mut visit: impl FnMut(u32, [Range<u32>; 2])) {
        let Some(nodes) = &self.0.nodes else { return };
        let size = self.0.frame().map(|range| range.end);
        let mut below = Vec::new();
        for drawn in self.0.lists.iter().flat_map(|list| &list.drawn) {
            let node = &nodes.nodes[drawn.index as usize];
            let window = [0, 1].map(|axis| drawn.placed.reach(node, axis, size[1 - axis]));
            below.push(drawn.index);
            while let Some(index) = below.pop() {
                let node = &nodes.nodes[index as usize];
                if node.is_leaf() {
                    visit(nodes.sample_of_node[index as usize], window.clone());
                } else {
                    below.extend(node.children());
                }
            }
        }
    }
}
