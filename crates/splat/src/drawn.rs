//! Which nodes are drawn, and how that changes with the paint.

use crate::draw::Pen;
use crate::lens_in_use::{LensInUse, NodeFocus, Placed};
use crate::nodes::{Nodes, SplatNode};
use crate::paint::Paint;
use crate::widest::{ask_for, with_widest_instructions};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::Range;

/// How many nodes ahead of the one that is looked at, or drawn, are fetched from memory.
pub const AHEAD: usize = 8;

/// What is summed: nodes as a lens sees them, and their paint.
pub struct Scene<'a> {
    pub pen: Pen<'a>,
    pub lens: &'a LensInUse,
    pub paint: &'a Paint,
    /// Pixel columns and rows of the picture.
    pub size: [u32; 2],
}

impl Scene<'_> {
    /// Calls `visit` with each node of a block that is drawn, painted as `paint` says, and the rows that its light may reach.
    #[inline(always)]
    pub fn drawn(
        &self,
        block: usize,
        paint: Option<&[NodeFocus]>,
        mut visit: impl FnMut(u32, &SplatNode, Placed, Range<u32>),
    ) {
        let first = self.pen.nodes.blocks[block].start;
        let nodes = self.pen.nodes.of_block(block);
        let mut at = 0;
        while at < nodes.len() {
            let node = &nodes[at];
            ask_for(nodes.get(at + AHEAD));
            let focus = paint.map_or(NodeFocus::STANDARD, |paint| paint[at]);
            let placed = self.lens.place(node, &focus);
            if node.is_leaf || self.lens.may_merge(node, &focus, placed) {
                // One by one, and so wherever nodes are many: what maps an array is not always inlined.
                let columns = node.reach(0, placed, self.size[0]);
                let rows = node.reach(1, placed, self.size[1]);
                if !columns.is_empty() && !rows.is_empty() {
                    visit(first + at as u32, node, placed, rows);
                }
                at = (node.end - first) as usize;
            } else {
                at += 1;
            }
        }
    }

    /// Makes `list` what is drawn of a block, painted as `paint` says.
    pub fn list(&self, block: usize, paint: Option<&[NodeFocus]>, list: &mut BlockList) {
        let drawn = &mut list.drawn;
        // Those of before are probably the same. Where they are few, and far from each other, each would be waited for.
        if 2 * drawn.len() < self.pen.nodes.blocks[block].len() {
            drawn.iter().for_each(|before| ask_for(self.pen.nodes.nodes.get(before.index as usize)));
        }
        drawn.clear();
        (list.rows, list.cost) = with_widest_instructions(
            #[inline(always)]
            || {
                let (mut first, mut end, mut cost) = (u32::MAX, 0, 0);
                self.drawn(
                    block,
                    paint,
                    #[inline(always)]
                    |index, node, placed, rows| {
                        (first, end) = (first.min(rows.start), end.max(rows.end));
                        cost += self.pen.cost(node, placed);
                        drawn.push(Drawn { index, placed, rows: [rows.start, rows.end] });
                    },
                );
                (first.min(end)..end, cost)
            },
        );
    }

    /// What is no longer drawn of some blocks, and what is now, since the paint of each was the one beside it.
    pub fn all_changes<'p>(
        &self,
        blocks: impl ParallelIterator<Item = (usize, Option<&'p [NodeFocus]>)>,
    ) -> Changes {
        let of_blocks: Vec<_> = blocks.map(|(block, before)| self.changes(block, before)).collect();
        let mut changes = Changes::default();
        for more in of_blocks {
            changes.removed.extend(more.removed);
            changes.added.extend(more.added);
        }
        changes
    }

    /// Those of one block.
    fn changes(&self, block: usize, before: Option<&[NodeFocus]>) -> Changes {
        let mut changes = Changes::default();
        let now = self.paint.of_block(block);
        if before == now {
            return changes;
        }
        let mut lists = [BlockList::default(), BlockList::default()];
        lists.iter_mut().zip([before, now]).for_each(|(list, paint)| self.list(block, paint, list));
        let [mut old, mut new] = lists.map(|list| list.drawn.into_iter().peekable());
        loop {
            let order = match (old.peek(), new.peek()) {
                (Some(a), Some(b)) => a.index.cmp(&b.index),
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (None, None) => return changes,
            };
            match order {
                Ordering::Less => changes.removed.extend(old.next()),
                Ordering::Greater => changes.added.extend(new.next()),
                Ordering::Equal => {
                    let (was, is) = (old.next(), new.next());
                    if was != is {
                        changes.removed.extend(was);
                        changes.added.extend(is);
                    }
                }
            }
        }
    }
}

/// A node that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    pub index: u32,
    pub placed: Placed,
    /// The first pixel row that its light may reach, and the one behind the last.
    rows: [u32; 2],
}

impl Drawn {
    /// The pixel rows that its light may reach.
    #[inline(always)]
    pub fn rows(&self) -> Range<u32> {
        self.rows[0]..self.rows[1]
    }
}

/// What is drawn of a block.
#[derive(Default)]
pub struct BlockList {
    /// In the order of the nodes.
    pub drawn: Vec<Drawn>,
    /// The pixel rows that its light may reach.
    pub rows: Range<u32>,
    /// About what it costs to draw it, in nanoseconds.
    pub cost: u64,
}

/// The pixel rows that the light of any of them may reach.
pub fn rows_of<'a>(drawn: impl IntoIterator<Item = &'a Drawn>) -> Range<u32> {
    hull(drawn.into_iter().map(Drawn::rows))
}

/// What is no longer drawn, and what is now.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    pub removed: Vec<Drawn>,
    pub added: Vec<Drawn>,
}

impl Changes {
    /// The rows, and the columns of a picture `width` px wide, that they change.
    pub fn window(&self, nodes: &Nodes, width: u32) -> [Range<u32>; 2] {
        let all = || self.removed.iter().chain(&self.added);
        let columns = |drawn: &Drawn| nodes.nodes[drawn.index as usize].reach(0, drawn.placed, width);
        [rows_of(all()), hull(all().map(columns).filter(|columns| !columns.is_empty()))]
    }
}

/// The range from the first start to the last end.
fn hull(ranges: impl Iterator<Item = Range<u32>>) -> Range<u32> {
    ranges.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0)
}
