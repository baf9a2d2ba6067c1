//! Which nodes are drawn, and how that changes with the paint.

use crate::draw::Pen;
use crate::lens_in_use::{LensInUse, NodeFocus, Placed};
use crate::nodes::{Nodes, SplatNode};
use crate::paint::Paint;
use numerics::{prefetch, with_widest_simd};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::Range;

/// How many nodes ahead memory is prefetched.
pub const AHEAD: usize = 24;

/// The nodes to sum, with lens and paint.
pub struct Scene<'a> {
    /// What nodes are drawn with.
    pub pen: Pen<'a>,
    /// The lens, which decides where nodes are drawn and how large.
    pub lens: &'a LensInUse,
    /// The focus of the nodes.
    pub paint: &'a Paint,
    /// Pixel columns and rows of the picture.
    pub size: [u32; 2],
}

impl Scene<'_> {
    /// Calls `visit` with each node of a block that is drawn, painted as `paint` says, and the rows that its light may reach: in
    /// the order of the nodes.
    #[inline(always)]
    pub fn visit_drawn(
        &self,
        block: usize,
        paint: Option<&[NodeFocus]>,
        Spans(spans): &mut Spans,
        mut visit: impl FnMut(u32, &SplatNode, Placed, Range<u32>),
    ) {
        let Nodes { nodes, blocks, roots, .. } = self.pen.nodes;
        let first = blocks[block].start;
        spans.clear();
        spans.push(roots[block].clone());
        let mut next = 0;
        while let Some(span) = spans.get(next).cloned() {
            next += 1;
            for index in span {
                let node = &nodes[index as usize];
                prefetch(nodes.get(index as usize + AHEAD));
                let moved;
                let node = match &self.pen.view {
                    None => node,
                    Some(view) => {
                        moved = view.moved(node);
                        &moved
                    }
                };
                let focus = paint.map_or(NodeFocus::STANDARD, |paint| paint[(index - first) as usize]);
                let placed = self.lens.place(node, &focus);
                if node.is_leaf() || self.lens.may_merge(node, &focus, placed) {
                    // One by one, and so wherever nodes are many: what maps an array is not always inlined.
                    let columns = placed.reach(node, 0, self.size[0]);
                    let rows = placed.reach(node, 1, self.size[1]);
                    if !columns.is_empty() && !rows.is_empty() {
                        visit(index, node, placed, rows);
                    }
                    continue;
                }
                let children = node.children();
                match spans[next..].last_mut() {
                    Some(last) if last.end == children.start => last.end = children.end,
                    _ => {
                        prefetch(nodes.get(children.start as usize));
                        spans.push(children);
                    }
                }
            }
        }
    }

    /// Fills `list` with the drawn nodes of a block, painted as `paint` gives.
    pub fn list(
        &self,
        block: usize,
        paint: Option<&[NodeFocus]>,
        spans: &mut Spans,
        BlockList { drawn, rows: all_rows, cost }: &mut BlockList,
    ) {
        drawn.clear();
        (*all_rows, *cost) = with_widest_simd(
            #[inline(always)]
            || {
                let (mut first, mut end, mut cost) = (u32::MAX, 0, 0);
                self.visit_drawn(
                    block,
                    paint,
                    spans,
                    #[inline(always)]
                    |index, node, placed, rows| {
                        (first, end) = (first.min(rows.start), end.max(rows.end));
                        cost += self.pen.cost(node, placed);
                        drawn.push(DrawnNode { index, placed, rows: [rows.start, rows.end] });
                    },
                );
                (first.min(end)..end, cost)
            },
        );
    }

    /// Makes `lists` what is drawn of every block, and `changes` what becomes of that once it is painted as `then` says, while
    /// the block's nodes are near.
    pub fn list_all(&self, then: Option<&Paint>, lists: &mut Vec<BlockList>, Changes(changes): &mut Changes) {
        let count = self.pen.nodes.blocks.len();
        lists.resize_with(count, BlockList::default);
        changes.resize_with(count, BlockChanges::default);
        let all = lists.par_iter_mut().zip(changes).enumerate();
        all.for_each_init(<(Spans, BlockList)>::default, |(spans, painted), (block, (list, changes))| {
            let paint = self.paint.block(block);
            self.list(block, paint, spans, list);
            changes.clear();
            if let Some(then) = then.map(|then| then.block(block)).filter(|then| *then != paint) {
                self.list(block, then, spans, painted);
                changes.update(list, painted);
            }
        });
    }
}

/// Nodes of a block that are still to be visited; scratch memory.
#[derive(Default)]
pub struct Spans(Vec<Range<u32>>);

/// A node that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnNode {
    /// The node's index.
    pub index: u32,
    /// Where it is drawn, and how large.
    pub placed: Placed,
    /// The first pixel row that its light may reach, and the one behind the last.
    rows: [u32; 2],
}

impl DrawnNode {
    /// The pixel rows that the node's light may reach.
    #[inline(always)]
    pub fn rows(&self) -> Range<u32> {
        self.rows[0]..self.rows[1]
    }
}

/// What is drawn of a block.
#[derive(Clone, Debug, Default)]
pub struct BlockList {
    /// In the order of the nodes.
    pub drawn: Vec<DrawnNode>,
    /// The pixel rows that its light may reach.
    pub rows: Range<u32>,
    /// About what it costs to draw it, in nanoseconds.
    pub cost: u64,
}

impl BlockList {
    /// About what it costs to draw a part of it.
    fn cost_of(&self, part: &[DrawnNode]) -> u64 {
        self.cost * part.len() as u64 / self.drawn.len().max(1) as u64
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.drawn.capacity() * size_of::<DrawnNode>()
    }
}

/// What is no longer drawn, and what is now, block by block; room for others once they are made.
#[derive(Clone, Debug, Default)]
pub struct Changes(pub Vec<BlockChanges>);

impl Changes {
    /// Sets the changes to those of some blocks; each is given with its paint of before (`None`: it had none).
    pub fn update(&mut self, scene: &Scene, blocks: &[(usize, Option<&[NodeFocus]>)]) {
        self.0.resize_with(blocks.len(), BlockChanges::default);
        let room = <(Spans, [BlockList; 2])>::default;
        self.0.par_iter_mut().zip(blocks).for_each_init(
            room,
            |(spans, [old, new]), (changes, (block, before))| {
                let now = scene.paint.block(*block);
                changes.clear();
                if *before != now {
                    scene.list(*block, *before, spans, old);
                    scene.list(*block, now, spans, new);
                    changes.update(old, new);
                }
            },
        );
    }

    /// The pixel rows that the changes may reach.
    pub fn rows(&self) -> Range<u32> {
        hull(self.0.iter().filter(|block| !block.is_empty()).map(|block| block.rows.clone()))
    }

    /// The rows, and the columns of a picture `width` px wide, that they change.
    pub fn window(&self, pen: &Pen, width: u32) -> [Range<u32>; 2] {
        let all = || self.0.iter().flat_map(|block| block.removed.iter().chain(&block.added));
        let columns = |drawn: &DrawnNode| drawn.placed.reach(&pen.node(drawn.index), 0, width);
        [self.rows(), hull(all().map(columns).filter(|columns| !columns.is_empty()))]
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        let drawn: usize = self.0.iter().map(|block| block.removed.capacity() + block.added.capacity()).sum();
        drawn * size_of::<DrawnNode>()
    }
}

/// What is no longer drawn of a block, and what is now: each in the order of the nodes.
#[derive(Clone, Debug, Default)]
pub struct BlockChanges {
    /// The nodes that are no longer drawn, as they were drawn.
    pub removed: Vec<DrawnNode>,
    /// The nodes that are drawn now.
    pub added: Vec<DrawnNode>,
    /// The pixel rows that their light may reach.
    pub rows: Range<u32>,
    /// About what it costs to draw them, in nanoseconds.
    pub cost: u64,
}

impl BlockChanges {
    /// Nothing changes.
    fn clear(&mut self) {
        self.removed.clear();
        self.added.clear();
    }

    /// Adds what is in one list alone; they are empty.
    fn update(&mut self, old: &BlockList, new: &BlockList) {
        let Self { removed, added, .. } = self;
        let (mut was, mut is) = (old.drawn.as_slice(), new.drawn.as_slice());
        loop {
            let order = match (was.first(), is.first()) {
                (Some(a), Some(b)) if a == b => {
                    (was, is) = (&was[1..], &is[1..]);
                    continue;
                }
                (Some(a), Some(b)) => a.index.cmp(&b.index),
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (None, None) => break,
            };
            if order.is_le() {
                removed.extend(was.split_off_first());
            }
            if order.is_ge() {
                added.extend(is.split_off_first());
            }
        }
        self.rows = hull(removed.iter().chain(&*added).map(DrawnNode::rows));
        self.cost = old.cost_of(removed) + new.cost_of(added);
    }

    /// The number of the first node that changes; `None` if none does.
    pub fn first(&self) -> Option<u32> {
        self.removed.first().or(self.added.first()).map(|drawn| drawn.index)
    }

    /// Whether nothing changes in the block.
    pub fn is_empty(&self) -> bool {
        self.first().is_none()
    }
}

/// The range from the least start to the greatest end; empty if there are no ranges.
pub fn hull(ranges: impl Iterator<Item = Range<u32>>) -> Range<u32> {
    ranges.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..0)
}
