//! Building the hierarchy, block by block.

use crate::sample::{Salf, Sample, Visibility};
use crate::tree::grid::Grid;
use crate::tree::{BLOCK_PX, Block, LEVELS, Node, NodeVisibility, Tree};
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;

/// Nodes are joined whose standard circles of confusion differ by at most this share of the joint cell's side.
const SMOOTH: f32 = 0.5;

/// Partly occluded nodes are joined if at most this share of the aperture's cells differs between each and most.
const ALIKE: f32 = 0.3;

/// Samples whose weight changes by more than this over the aperture, as a share of it, are edge-on.
const STEEP: f32 = 0.75;

/// Edge-on nodes are joined if their weights over the aperture, as shares of the largest, differ by at most this.
const ALIKE_WEIGHTS: f32 = 0.5;

/// What a partly occluded node would send is scaled to what its children do by at most this factor.
const MOST_SCALED: f32 = 1.5;

pub fn build(salf: &Salf, highlight: f32) -> Tree {
    let grid = Grid::new(salf);
    let contents = grid.contents(&salf.samples);
    let parallax_px = salf.camera.optics().splat_radius_px(1.0) as f32;
    let parts: Vec<Part> = contents
        .par_iter()
        .enumerate()
        .map(|(index, content)| {
            let mut builder = Builder { grid: &grid, highlight, parallax_px, arena: Vec::new() };
            builder.build(grid.corner(index), content.samples(&salf.samples))
        })
        .collect();
    assemble(&parts, salf.samples.len())
}

/// Joins the blocks' parts.
fn assemble(parts: &[Part], samples: usize) -> Tree {
    let mut tree = Tree { node_of_sample: vec![0; samples], ..Tree::default() };
    tree.nodes.reserve_exact(parts.iter().map(|part| part.nodes.len()).sum());
    tree.words.reserve_exact(parts.iter().map(|part| part.words.len()).sum());
    for Part { nodes, roots, words } in parts {
        let (first, first_word) = (tree.nodes.len() as u32, tree.words.len() as u32);
        for node in nodes {
            if let Some(sample) = node.sample {
                tree.node_of_sample[sample as usize] = tree.nodes.len() as u32;
            }
            let visibility = match node.visibility {
                NodeVisibility::Open => NodeVisibility::Open,
                NodeVisibility::Cells8(at) => NodeVisibility::Cells8(first_word + at),
                NodeVisibility::Cells16(at) => NodeVisibility::Cells16(first_word + at),
            };
            let children = first + node.children.start..first + node.children.end;
            tree.nodes.push(Node { visibility, children, ..node.clone() });
        }
        tree.words.extend(words);
        tree.blocks.push(Block { nodes: first..tree.nodes.len() as u32, roots: first..first + roots });
    }
    tree
}

/// A block on its own: places are counted from its beginning.
struct Part {
    nodes: Vec<Node>,
    /// How many of them no other stands for.
    roots: u32,
    words: Vec<u64>,
}

/// A node while its block is being built.
struct Growing {
    node: Node,
    cells: Option<Cells>,
    children: Vec<usize>,
}

/// Visibility of a growing node: 16 × 16 cells.
#[derive(Clone, Copy)]
struct Cells {
    words: [u64; 4],
    /// Whether eight cells a side say it all.
    is_coarse: bool,
}

impl Growing {
    /// See [`Cells::sent`].
    fn sent(&self) -> f32 {
        self.cells.as_ref().map_or(0.0, |cells| cells.sent(&self.node))
    }
}

struct Builder<'a> {
    grid: &'a Grid,
    highlight: f32,
    parallax_px: f32,
    arena: Vec<Growing>,
}

impl Builder<'_> {
    fn build(&mut self, corner: IVec2, samples: impl Iterator<Item = (u32, Sample)>) -> Part {
        let mut alone = Vec::new();
        // Nodes that may still be joined, with the corner of their cell in the block.
        let mut open_ended: Vec<(IVec2, usize)> = Vec::new();
        for (index, sample) in samples {
            let pixel = self.grid.pixel(sample.center);
            let growing = leaf(&sample, index, self.grid.cell_level(pixel));
            if Self::stays_alone(&growing.node) {
                alone.push(self.arena.len());
            } else {
                open_ended.push((pixel - corner, self.arena.len()));
            }
            self.arena.push(growing);
        }
        for level in 0..LEVELS as u8 {
            open_ended = self.join(level, open_ended);
        }
        let roots: Vec<_> = open_ended.into_iter().map(|(_, index)| index).chain(alone).collect();
        self.emit(roots)
    }

    /// Whether a sample is never joined with others.
    fn stays_alone(node: &Node) -> bool {
        let cell = (1 << node.level) as f32;
        !is_edge_on(node) && node.half_size.max_element() > cell / 2.0 || 1 << node.level >= BLOCK_PX
    }

    /// Whether a node may be joined with what else is in its cell of `level`: the samples of a cell at that of the cell, if
    /// they are highlights only then.
    fn may_join(&self, level: u8, node: &Node) -> bool {
        let is_of_cell = node.sample.is_some() && node.level == level;
        is_of_cell || node.level < level && node.radiance.max_element() <= self.highlight
    }

    /// Joins the nodes of each cell of `level`.
    fn join(&mut self, level: u8, nodes: Vec<(IVec2, usize)>) -> Vec<(IVec2, usize)> {
        let cells_a_row = (BLOCK_PX >> level) as usize;
        let mut of_cell = vec![Vec::new(); cells_a_row * cells_a_row];
        for (pixel, index) in nodes {
            let cell = pixel >> level as i32;
            of_cell[cell.y as usize * cells_a_row + cell.x as usize].push((pixel, index));
        }
        let mut joined = Vec::new();
        for members in of_cell {
            let mut groups: Vec<(IVec2, Vec<usize>)> = Vec::new();
            for (pixel, index) in members {
                // A cell that was sampled more coarsely waits for its level.
                let fits = self.may_join(level, &self.arena[index].node);
                let group = groups.iter_mut().find(|(_, group)| {
                    fits && group.len() < MOST_MEMBERS && self.belongs(level, index, group[0])
                });
                match group {
                    Some((_, group)) => group.push(index),
                    None => groups.push((pixel, vec![index])),
                }
            }
            for (pixel, group) in groups {
                match self.parent(level, &group) {
                    Some(parent) => joined.push((pixel, parent)),
                    None => joined.extend(group.into_iter().map(|index| (pixel, index))),
                }
            }
        }
        joined
    }

    fn belongs(&self, level: u8, index: usize, first: usize) -> bool {
        let (a, b) = (&self.arena[index], &self.arena[first]);
        let apart = (a.node.inverse_depth - b.node.inverse_depth).abs() * self.parallax_px;
        let is_smooth = self.may_join(level, &b.node) && apart <= SMOOTH * (1 << level) as f32;
        is_smooth
            && weigh_alike(&a.node, &b.node)
            && match (&a.cells, &b.cells) {
                (None, None) => true,
                (Some(a), Some(b)) => a.distance(b) <= ALIKE,
                _ => false,
            }
    }

    /// The node that stands for `children`; `None` for a single one, and if it would send another light than they do.
    fn parent(&mut self, level: u8, children: &[usize]) -> Option<usize> {
        if children.len() == 1 {
            return None;
        }
        let members: Vec<&Growing> = children.iter().map(|&index| &self.arena[index]).collect();
        let mut node = mean(level, &members);
        let cells = members[0].cells.is_some().then(|| most(&members));
        if let Some(cells) = &cells {
            // What most see is not what all see together; and weights of edge-on nodes are cut off where they would be
            // negative, so that sums of them are not quite linear.
            let sent: f32 = members.iter().map(|member| member.sent()).sum();
            let sends = cells.sent(&node);
            let is_close = sent <= MOST_SCALED * sends && sends <= MOST_SCALED * sent && sent > 0.0;
            let scale = is_close.then(|| sent / sends)?;
            node.weight *= scale;
            node.tilt *= scale;
        }
        self.arena.push(Growing { node, cells, children: children.to_vec() });
        Some(self.arena.len() - 1)
    }

    /// The block's nodes, level by level below its `roots`.
    fn emit(&self, roots: Vec<usize>) -> Part {
        let (mut nodes, mut words) = (Vec::with_capacity(self.arena.len()), Vec::new());
        let (count, mut order) = (roots.len() as u32, roots);
        while let Some(&index) = order.get(nodes.len()) {
            let growing = &self.arena[index];
            let visibility = growing.cells.map_or(NodeVisibility::Open, |cells| cells.store(&mut words));
            let first = order.len() as u32;
            order.extend(&growing.children);
            nodes.push(Node { visibility, children: first..order.len() as u32, ..growing.node.clone() });
        }
        Part { nodes, roots: count, words }
    }
}

/// Whether the plane of a node's surface passes by the aperture so closely that its weight changes much over it.
fn is_edge_on(node: &Node) -> bool {
    node.tilt.abs().element_sum() > STEEP * node.weight
}

/// What a node counts for among others: its weight, or if it is edge-on the largest toward any aperture point.
fn largest_weight(node: &Node) -> f32 {
    if is_edge_on(node) { node.weight.abs() + node.tilt.abs().element_sum() } else { node.weight }
}

/// Whether the weights of two nodes change over the aperture about alike.
fn weigh_alike(a: &Node, b: &Node) -> bool {
    if !is_edge_on(a) && !is_edge_on(b) {
        return true;
    }
    let relative = |node: &Node| Vec3::new(node.weight, node.tilt.x, node.tilt.y) / largest_weight(node);
    (relative(a) - relative(b)).abs().element_sum() <= ALIKE_WEIGHTS
}

fn leaf(sample: &Sample, index: u32, level: u8) -> Growing {
    let cells = match &sample.visibility {
        Visibility::Open => None,
        Visibility::Cells { words } => Some(Cells::of(words)),
    };
    let node = Node {
        center: sample.center,
        half_size: sample.half_size,
        inverse_depth: sample.inverse_depth,
        inverse_depth_spread: 0.0,
        weight: sample.weight,
        tilt: sample.tilt,
        radiance: sample.radiance,
        level,
        visibility: NodeVisibility::Open,
        children: 0..0,
        sample: Some(index),
    };
    Growing { node, cells, children: Vec::new() }
}

/// The node that stands for `members`.
fn mean(level: u8, members: &[&Growing]) -> Node {
    let nodes = || members.iter().map(|growing| &growing.node);
    let total: f32 = nodes().map(largest_weight).sum();
    let center = nodes().map(|node| largest_weight(node) * node.center).sum::<Vec2>() / total;
    let variance = |node: &Node| node.half_size * node.half_size / 3.0 + (node.center - center).powf(2.0);
    let variance = nodes().map(|node| largest_weight(node) * variance(node)).sum::<Vec2>() / total;
    let low = nodes().map(|n| n.inverse_depth - n.inverse_depth_spread / 2.0).fold(f32::INFINITY, f32::min);
    let high =
        nodes().map(|n| n.inverse_depth + n.inverse_depth_spread / 2.0).fold(f32::NEG_INFINITY, f32::max);
    let inverse_depth = nodes().map(|node| largest_weight(node) * node.inverse_depth).sum::<f32>() / total;
    Node {
        center,
        half_size: (3.0 * variance).map(f32::sqrt),
        inverse_depth,
        inverse_depth_spread: 2.0 * (high - inverse_depth).max(inverse_depth - low),
        weight: nodes().map(|node| node.weight).sum(),
        tilt: nodes().map(|node| node.tilt).sum(),
        radiance: nodes().map(|node| largest_weight(node) * node.radiance).sum::<Vec3>() / total,
        level,
        visibility: NodeVisibility::Open,
        children: 0..0,
        sample: None,
    }
}

/// What most of `members` see; where they are even, every other cell.
fn most(members: &[&Growing]) -> Cells {
    const CHECKERS: u64 = 0x5555_AAAA_5555_AAAA;
    let seen: Vec<_> = members.iter().filter_map(|growing| growing.cells.as_ref()).collect();
    let words = std::array::from_fn(|word| {
        // Counts of 64 cells at once: bit k of the count of each in `count[k]`.
        let mut count = [0u64; COUNTER_BITS];
        for cells in &seen {
            let mut carry = cells.words[word];
            for bit in &mut count {
                (*bit, carry) = (*bit ^ carry, *bit & carry);
            }
        }
        let (more, even) = compare(&count, seen.len() / 2);
        more | if seen.len() % 2 == 0 { even & CHECKERS } else { 0 }
    });
    let is_coarse = seen.iter().all(|cells| cells.is_coarse) && finer(coarser(words)) == words;
    Cells { words, is_coarse }
}

/// Bits of the counts of [`most`].
const COUNTER_BITS: usize = 5;

/// Nodes that are joined at most.
const MOST_MEMBERS: usize = (1 << COUNTER_BITS) - 1;

/// Which counts are above a number, and which equal to it.
fn compare(count: &[u64; COUNTER_BITS], number: usize) -> (u64, u64) {
    let (mut more, mut even) = (0, u64::MAX);
    for (k, &bits) in count.iter().enumerate().rev() {
        if number >> k & 1 == 1 {
            even &= bits;
        } else {
            more |= even & bits;
            even &= !bits;
        }
    }
    (more, even)
}

impl Cells {
    fn of(words: &[u64]) -> Self {
        match *words {
            [word] => Self { words: finer(word), is_coarse: true },
            [a, b, c, d] => Self { words: [a, b, c, d], is_coarse: false },
            _ => unreachable!("a visibility has one word or four"),
        }
    }

    /// The sum over the cells of the weight that a node has toward them; unless it is edge-on, toward the centre.
    fn sent(&self, node: &Node) -> f32 {
        if !is_edge_on(node) {
            let seen: u32 = self.words.iter().map(|word| word.count_ones()).sum();
            return node.weight * seen as f32;
        }
        let cell = |k: usize| Vec2::new((k % 16) as f32 + 0.5, (k / 16) as f32 + 0.5) / 8.0 - 1.0;
        let is_seen = |k: &usize| self.words[k / 64] >> (k % 64) & 1 == 1;
        (0..256).filter(is_seen).map(|k| (node.weight + node.tilt.dot(cell(k))).max(0.0)).sum()
    }

    /// The share of cells that differ.
    fn distance(&self, other: &Self) -> f32 {
        let differing: u32 = self.words.iter().zip(other.words).map(|(a, b)| (a ^ b).count_ones()).sum();
        differing as f32 / 256.0
    }

    fn store(&self, words: &mut Vec<u64>) -> NodeVisibility {
        let at = words.len() as u32;
        if self.is_coarse {
            words.push(coarser(self.words));
            NodeVisibility::Cells8(at)
        } else {
            words.extend(self.words);
            NodeVisibility::Cells16(at)
        }
    }
}

/// 8 × 8 cells as 16 × 16.
fn finer(word: u64) -> [u64; 4] {
    let mut words = [0u64; 4];
    for row in 0..16 {
        let bits = word >> (row / 2 * 8) & 0xFF;
        let doubled = (0..8).map(|k| (bits >> k & 1) * (3 << (2 * k))).sum::<u64>();
        words[row / 4] |= doubled << (row % 4 * 16);
    }
    words
}

/// The inverse of [`finer`].
fn coarser(words: [u64; 4]) -> u64 {
    (0..64).map(|k| (words[k / 8 * 2 / 4] >> (k / 8 * 2 % 4 * 16 + k % 8 * 2) & 1) << k).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use lens::Camera;
    use scene::SurfacePoint;

    #[test]
    fn coarse_cells_survive() {
        for word in [0, u64::MAX, 0x0123_4567_89AB_CDEF] {
            assert_eq!(coarser(finer(word)), word);
            assert_eq!(finer(word).iter().map(|w| w.count_ones()).sum::<u32>(), 4 * word.count_ones());
        }
    }

    #[test]
    fn most_is_a_majority() {
        let growing = |word: u64| Growing {
            node: leaf(&plane(|_, _| 1.0).samples.get(0), 0, 0).node,
            cells: Some(Cells { words: [word, 0, u64::MAX, 0], is_coarse: false }),
            children: Vec::new(),
        };
        let members: Vec<_> = [0b1110, 0b1100, 0b1010].map(growing).into_iter().collect();
        let members: Vec<_> = members.iter().collect();
        assert_eq!(most(&members).words, [0b1110, 0, u64::MAX, 0]);
        assert_eq!(most(&members[..2]).words[0], 0b1100 | 0b0010 & 0x5555_AAAA_5555_AAAA);
    }

    fn plane(depth_of: impl Fn(u32, u32) -> f32) -> Salf {
        let camera = Camera { width: 40, height: 24, aperture_radius: 0.5, ..Camera::default() };
        let sample = |k: u32| {
            let (x, y) = (k % 40, k / 40);
            Sample {
                center: Vec2::new(x as f32 + 0.5, y as f32 + 0.5),
                half_size: Vec2::splat(0.5),
                inverse_depth: depth_of(x, y),
                weight: 1.0,
                tilt: Vec2::ZERO,
                radiance: Vec3::splat(if (x, y) == (3, 3) { 100.0 } else { x as f32 * 0.01 }),
                surface: Some(SurfacePoint { triangle: k, barycentric: DVec2::ZERO }),
                visibility: Visibility::Open,
            }
        };
        Salf { samples: (0..40 * 24).map(sample).collect(), camera, margin_px: 0 }
    }

    #[test]
    fn a_plane_becomes_a_pyramid_and_keeps_its_sums() {
        let salf = plane(|_, _| 0.5);
        let tree = Tree::new(&salf, 4.0);
        let leaves = tree.nodes.iter().filter(|node| node.sample.is_some()).count();
        assert_eq!(leaves, salf.samples.len());
        for (index, &node) in tree.node_of_sample.iter().enumerate() {
            assert_eq!(tree.nodes[node as usize].sample, Some(index as u32));
        }
        let block = &tree.nodes[tree.blocks[1].nodes.start as usize];
        assert_eq!((block.level, block.weight, block.center), (4, 256.0, Vec2::new(24.0, 8.0)));
        assert!((block.half_size - 8.0).abs().max_element() < 1e-3);
        assert!((block.radiance.x - 0.235).abs() < 1e-5);
        let highlight = &tree.nodes[tree.node_of_sample[3 * 40 + 3] as usize];
        assert_eq!((highlight.radiance.x, highlight.level), (100.0, 0));
        // The sum of each tree is that of its leaves.
        let roots = tree.blocks.iter().flat_map(|block| block.roots.clone());
        let weight: f32 = roots.map(|root| tree.nodes[root as usize].weight).sum();
        assert_eq!(weight, 40.0 * 24.0);
    }

    #[test]
    fn every_node_is_a_root_or_below_one_node_that_comes_before_it() {
        let tree = Tree::new(&plane(|x, y| if (x * 7 + y * 3) % 11 < 4 { 0.5 } else { 3.0 }), 4.0);
        let mut found = vec![0; tree.nodes.len()];
        for block in &tree.blocks {
            assert_eq!(block.roots.start, block.nodes.start);
            block.roots.clone().for_each(|root| found[root as usize] += 1);
            let mut next = block.roots.end;
            for at in block.nodes.clone() {
                let Node { children, sample, .. } = &tree.nodes[at as usize];
                assert_eq!((children.start, children.is_empty()), (next, sample.is_some()), "{at}");
                children.clone().for_each(|child| found[child as usize] += 1);
                next = children.end;
            }
            assert_eq!(next, block.nodes.end);
        }
        assert!(found.iter().all(|&times| times == 1));
    }

    #[test]
    fn edge_on_nodes_send_what_their_samples_send() {
        let mut salf = plane(|_, _| 0.5);
        let mut index = 0u64;
        salf.samples = salf.samples.changed(|sample| {
            // The side that sends nothing is hidden here and there.
            let hidden = index.wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let row = if index.is_multiple_of(3) { 0xFF00 } else { 0x8001 | hidden >> 55 };
            let words = vec![row | row << 16 | row << 32 | row << 48; 4];
            sample.visibility = Visibility::Cells { words: words.into() };
            (sample.weight, sample.tilt) = (-0.2 + 0.01 * (index % 9) as f32, Vec2::new(1.0, 0.1));
            index += 1;
        });
        let tree = Tree::new(&salf, 4.0);
        let mut joined = 0;
        for node in tree.nodes.iter().filter(|node| node.sample.is_none()) {
            let mut below: Vec<_> = node.children.clone().collect();
            let mut most = 0.0;
            while let Some(at) = below.pop() {
                let node = &tree.nodes[at as usize];
                below.extend(node.children.clone());
                most += if node.sample.is_some() { largest_weight(node) } else { 0.0 };
            }
            assert!(largest_weight(node) <= MOST_SCALED.powi(node.level.into()) * most, "{node:?}");
            joined += 1;
        }
        assert!(joined > 50, "{joined} nodes");
    }

    #[test]
    fn a_step_of_depth_is_not_joined() {
        let salf = plane(|x, _| if x < 21 { 0.5 } else { 3.0 });
        let tree = Tree::new(&salf, 4.0);
        assert!(tree.nodes.iter().all(|node| node.inverse_depth == 0.5 || node.inverse_depth == 3.0));
        assert!(tree.nodes.iter().any(|node| node.level == 4));
    }
}
