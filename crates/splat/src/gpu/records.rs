//! Which nodes are drawn, as the card reads it.

use crate::draw::{Form, Pen};
use crate::drawn::{Scene, Spans};
use crate::gpu::passes::KINDS;
use crate::lens_in_use::Placed;
use crate::nodes::SplatNode;
use crate::stencil::Place;
use crate::sums::is_sharing;
use rayon::prelude::*;
use std::ops::Range;

/// Words of a record; of one of a large image twice as many.
pub const WORDS: usize = 4;

/// The kinds of draw.wgsl.
const BOXES: usize = 0;
const IMAGES: usize = 1;
const SEEN: usize = 2;
pub const LARGE: usize = 3;

/// Flags of a record.
const IS_SHARING: u32 = 8;
const IS_REMOVED: u32 = 16;
const IS_COVERAGE: u32 = 32;
const IS_PIECE: u32 = 64;
/// Where the level stands that it is drawn on.
const LEVEL_BIT: u32 = 8;
/// Where stands which piece it is.
const PIECE_BIT: u32 = 16;

/// Records by kind: of ordinary accumulators, then of wide ones.
#[derive(Clone, Debug, Default)]
pub struct Records {
    pub words: [[Vec<u32>; KINDS]; 2],
    /// Stencils that they ask for.
    pub places: Vec<Place>,
}

impl Records {
    /// All that is drawn of some blocks, whose nodes begin at `first`.
    pub fn of_blocks(scene: &Scene, blocks: Range<usize>, first: u32) -> Self {
        let of_block = |block| {
            let mut records = Self::default();
            scene.drawn(
                block,
                scene.paint.of_block(block),
                &mut Spans::default(),
                |index, node, placed, _| {
                    records.push(&scene.pen, index, first, node, placed, 1);
                },
            );
            records
        };
        let mut all = blocks.into_par_iter().map(of_block).reduce(Self::default, Self::joined);
        all.places.sort_unstable_by_key(|place| place.index);
        all.places.dedup();
        all
    }

    fn joined(mut self, more: Self) -> Self {
        for (of_width, more) in self.words.iter_mut().zip(more.words) {
            for (words, more) in of_width.iter_mut().zip(more) {
                words.extend(more);
            }
        }
        self.places.extend(more.places);
        self
    }

    /// Adds a node that is drawn (`sign` 1) or taken away (−1).
    pub fn push(&mut self, pen: &Pen, index: u32, first: u32, node: &SplatNode, placed: Placed, sign: i32) {
        let mut flags = if is_sharing(node, placed) { IS_SHARING } else { 0 };
        if sign < 0 {
            flags |= IS_REMOVED;
        }
        let mut push = |node: &SplatNode, flags: u32| {
            if node.is_bright {
                self.push_forms(1, pen, index, first, node, placed, flags);
                self.push_forms(0, pen, index, first, node, placed, flags | IS_COVERAGE);
            } else {
                self.push_forms(0, pen, index, first, node, placed, flags);
            }
        };
        if placed.level < node.level {
            flags |= IS_PIECE | (placed.level as u32) << LEVEL_BIT;
            for (k, piece) in node.pieces(placed.level).enumerate() {
                push(&piece, flags | (k as u32) << PIECE_BIT);
            }
        } else {
            push(node, flags | (placed.level as u32) << LEVEL_BIT);
        }
    }

    #[allow(clippy::too_many_arguments, reason = "a record's parts")]
    fn push_forms(
        &mut self,
        width: usize,
        pen: &Pen,
        index: u32,
        first: u32,
        node: &SplatNode,
        placed: Placed,
        flags: u32,
    ) {
        let Self { words, places } = self;
        let words = &mut words[width];
        let radius = placed.radius as u32;
        pen.forms(node, placed, |form| {
            let head = |of_form: u32, number: u32| [index - first, radius, of_form, flags | number];
            let mut image = pen.image(node, [0.0; 4], placed);
            let (number, cells) = match form {
                Form::Box(_) => return words[BOXES].extend(head(0, 0)),
                Form::Parts(_) => return words[BOXES].extend(head(placed.depth_share as u32, 1)),
                Form::SeenBox => return words[BOXES].extend(head(0, 4)),
                Form::Image(share) => {
                    image.share = share;
                    image.lean(node, pen.tilt_shift);
                    (2, None)
                }
                Form::Tilted(share) => (3, Some((&crate::draw::ALL, share))),
                Form::Seen => (5, Some(pen.seen_of(node))),
            };
            match pen.stencil_size_of(&image) {
                Some(size) => {
                    let (place, phase, _) = pen.stencils.place(size, image.center[1]);
                    // Blocks ask for few different ones, one after another.
                    if places.last() != Some(&place) {
                        places.push(place);
                    }
                    let kind = if cells.is_some() { SEEN } else { IMAGES };
                    words[kind].extend(head(place.with_phase(phase), number));
                }
                None => {
                    let large = pen.large(&image, cells);
                    words[LARGE].extend(head(0, number));
                    words[LARGE].extend([large.height, large.height_bits, large.share, 0]);
                }
            }
        });
    }
}
