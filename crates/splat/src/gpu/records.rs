//! What is drawn, as the card reads it: listed here where a stroke changes it, else by the card itself ([`super::listing`]).

use crate::aperture::stencil::Place;
use crate::draw::{ALL, Form, Image, Large, Pen};
use crate::gpu::formats::{
    FORM_BOX, FORM_IMAGE, FORM_MASK, FORM_PARTIAL_BOX, FORM_PARTIAL_IMAGE, FORM_PARTS, FORM_TILTED,
    IS_COVERAGE, IS_PIECE, IS_REMOVED, IS_SHARING, KIND_BOXES, KIND_IMAGES, KIND_LARGE, KIND_PARTIAL, KINDS,
    LEVEL_BIT, LEVEL_MASK, PIECE_BIT, RECORD_WORDS,
};
use crate::lens_in_use::Placed;
use crate::nodes::{Cells, SplatNode};
use crate::sums::is_sharing;
use rayon::prelude::*;

/// Records by kind: of ordinary accumulators, then of wide ones.
#[derive(Clone, Debug, Default)]
pub struct Records {
    pub words: [[Vec<u32>; KINDS]; 2],
    /// The stencils that the records use.
    pub places: Vec<Place>,
}

impl Records {
    /// Adds the record of a node that is drawn (`sign` 1) or taken away (−1).
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
            let head = |form_argument: u32| [index - first, radius, form_argument, flags | number_of(form)];
            let Some((image, cells)) = image_of(pen, node, placed, form) else {
                let is_parts = matches!(form, Form::Parts(_));
                return words[KIND_BOXES].extend(head(if is_parts { placed.depth_share as u32 } else { 0 }));
            };
            match pen.stencil_size_of(&image) {
                Some(size) => {
                    let (place, phase, _) = pen.stencils.place(size, image.center[1]);
                    // Blocks use few different ones, one after another.
                    if places.last() != Some(&place) {
                        places.push(place);
                    }
                    let kind = if cells.is_some() { KIND_PARTIAL } else { KIND_IMAGES };
                    words[kind].extend(head(place.with_phase(phase)));
                }
                None => words[KIND_LARGE].extend(with_large(head(0), pen.large(&image, cells))),
            }
        });
    }
}

/// Whole records of large images, of those that the card listed, of nodes that begin at `first`.
pub fn complete_large(pen: &Pen, first: u32, listed: &[u32]) -> Vec<u32> {
    let complete = |record: &[u32; RECORD_WORDS]| {
        let [index, radius, _, flags] = *record;
        let level = (flags >> LEVEL_BIT & LEVEL_MASK) as u8;
        let placed = Placed { radius: radius as i32, depth_share: 0, is_standard: false, level };
        let whole_node = &pen.nodes.nodes[(first + index) as usize];
        let piece = || whole_node.pieces(level).nth((flags >> PIECE_BIT) as usize);
        let node = if flags & IS_PIECE != 0 { piece() } else { None }.unwrap_or(*whole_node);
        let mut whole = Vec::with_capacity(2 * RECORD_WORDS);
        pen.forms(&node, placed, |form| {
            let is_it = number_of(form) == flags & FORM_MASK;
            if let Some((image, cells)) = image_of(pen, &node, placed, form).filter(|_| is_it) {
                whole.extend(with_large(*record, pen.large(&image, cells)));
            }
        });
        whole
    };
    listed.as_chunks().0.par_iter().flat_map_iter(complete).collect()
}

fn with_large(record: [u32; RECORD_WORDS], large: Large) -> impl Iterator<Item = u32> {
    record.into_iter().chain([large.height, large.height_bits, large.share, 0])
}

/// The number of a form.
fn number_of(form: Form) -> u32 {
    match form {
        Form::Box(_) => FORM_BOX,
        Form::Parts(_) => FORM_PARTS,
        Form::Image(_) => FORM_IMAGE,
        Form::Tilted(_) => FORM_TILTED,
        Form::PartialBox => FORM_PARTIAL_BOX,
        Form::PartialImage => FORM_PARTIAL_IMAGE,
    }
}

/// The image of a form, and the cells it is seen through; `None` for forms that are boxes.
fn image_of<'n>(
    pen: &'n Pen,
    node: &'n SplatNode,
    placed: Placed,
    form: Form,
) -> Option<(Image<'n>, Option<(&'n Cells, u32)>)> {
    let mut image = pen.image(node, [0.0; 4], placed);
    let cells = match form {
        Form::Image(share) => {
            image.share = share;
            image.lean(node, pen.tilt_shift);
            None
        }
        Form::Tilted(share) => Some((&ALL, share)),
        Form::PartialImage => Some(pen.visible_part(node)),
        Form::Box(_) | Form::Parts(_) | Form::PartialBox => return None,
    };
    Some((image, cells))
}
