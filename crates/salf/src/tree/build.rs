//! Building the hierarchy, block by block.

use crate::salf::Salf;
use crate::sample::{Sample, Visibility, finer};
use crate::tree::grid::{Content, Grid};
use crate::tree::{BLOCK_PX, Block, LEVELS, Node};
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

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

/// Builds the hierarchy over a light field and makes something of every block, in parallel: of those of the picture and its
/// margin, row by row from the upper left one. Samples brighter than `highlight` stay alone.
pub fn each_block<T: Send>(salf: &Salf, highlight: f32, make: impl Fn(Block) -> T + Sync) -> Vec<T> {
    let grid = Grid::new(salf);
    let contents = grid.contents(&salf.samples);
    let parallax_px = salf.camera.optics().splat_radius_px(1.0) as f32;
    let builder = || Builder { grid: &grid, highlight, parallax_px, arena: Vec::new(), children: Vec::new() };
    let blocks = contents.par_iter().enumerate();
    let build = |builder: &mut Builder, (index, content): (usize, &Content)| {
        make(builder.build(grid.corner(index), content.samples(&salf.samples)))
    };
    blocks.map_init(builder, build).collect()
}

/// A node while its block is being built.
struct Growing {
    node: Node,
    /// The mean of its radiance times the distance from its centre along x and y, px.
    moments: [Vec3; 2],
    /// Its visibility; everything if `None`.
    cells: Option<Cells>,
    /// Their range in [`Builder::children`].
    children: Range<usize>,
}

/// The visibility of a node: 16 × 16 cells.
#[derive(Clone, Copy)]
struct Cells([u64; 4]);

impl Growing {
    /// See [`Cells::sent`].
    fn sent(&self) -> f32 {
        self.cells.as_ref().map_or(0.0, |cells| cells.sent(&self.node))
    }
}

/// A node that may still be joined with others: a pixel of its cell, from the block's corner, and its place in the arena.
type OpenEnded = (IVec2, usize);

/// Builds one block after another.
struct Builder<'a> {
    grid: &'a Grid,
    highlight: f32,
    parallax_px: f32,
    /// The nodes of the block.
    arena: Vec<Growing>,
    /// Places of their children.
    children: Vec<usize>,
}

impl Builder<'_> {
    fn build(&mut self, corner: IVec2, samples: impl Iterator<Item = (u32, Sample)>) -> Block {
        self.arena.clear();
        self.children.clear();
        let (mut alone, mut open_ended) = (Vec::new(), Vec::new());
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
        let mut groups = Vec::new();
        for level in 0..LEVELS as u8 {
            open_ended = self.join(level, open_ended, &mut groups);
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

    /// Joins the nodes of each cell of `level`, with `groups` as room to work in.
    fn join(
        &mut self,
        level: u8,
        mut nodes: Vec<OpenEnded>,
        groups: &mut Vec<Vec<OpenEnded>>,
    ) -> Vec<OpenEnded> {
        let cell_of = |(pixel, _): &OpenEnded| (pixel.y >> level, pixel.x >> level);
        nodes.sort_by_key(cell_of);
        let mut joined = Vec::with_capacity(nodes.len());
        for members in nodes.chunk_by(|a, b| cell_of(a) == cell_of(b)) {
            let mut count = 0;
            for &member in members {
                // A cell that was sampled more coarsely waits for its level.
                let fits = self.may_join(level, &self.arena[member.1].node);
                let fits_group = |group: &Vec<OpenEnded>| {
                    fits && group.len() < MAX_MEMBERS && self.is_alike(level, member.1, group[0].1)
                };
                let place = groups[..count].iter().position(fits_group).unwrap_or(count);
                if place == groups.len() {
                    groups.push(Vec::new());
                }
                groups[place].push(member);
                count = count.max(place + 1);
            }
            for group in &mut groups[..count] {
                match self.parent(level, group) {
                    Some(parent) => joined.push((group[0].0, parent)),
                    None => joined.extend_from_slice(group),
                }
                group.clear();
            }
        }
        joined
    }

    fn is_alike(&self, level: u8, index: usize, first: usize) -> bool {
        let (a, b) = (&self.arena[index], &self.arena[first]);
        let apart = (a.node.inverse_depth - b.node.inverse_depth).abs() * self.parallax_px;
        let is_smooth = self.may_join(level, &b.node) && apart <= SMOOTH * (1 << level) as f32;
        is_smooth
            && weigh_alike(&a.node, &b.node)
            && match (&a.cells, &b.cells) {
                (None, None) => true,
                (Some(a), Some(b)) => a.distance(b) <= ALIKE && a.overlaps(b),
                _ => false,
            }
    }

    /// The node that replaces `children`; `None` for a single one, and if it would send different light than they do.
    fn parent(&mut self, level: u8, children: &[OpenEnded]) -> Option<usize> {
        if children.len() == 1 {
            return None;
        }
        let members = || children.iter().map(|&(_, index)| &self.arena[index]);
        let mut node = mean(level, || members().map(|member| &member.node));
        let moments = moments(&node, members);
        let [x, y] = moments;
        node.dipole = (x * x + y * y).max_element().sqrt();
        let is_partial = self.arena[children[0].1].cells.is_some();
        let cells = is_partial.then(|| majority(|| members().filter_map(|member| member.cells.as_ref())));
        if let Some(cells) = &cells {
            // What most see is not what all see together; and weights of edge-on nodes are cut off where they would be
            // negative, so that sums of them are not quite linear.
            let sent: f32 = members().map(Growing::sent).sum();
            let sends = cells.sent(&node);
            let is_close = sent <= MOST_SCALED * sends && sends <= MOST_SCALED * sent && sent > 0.0;
            let scale = is_close.then(|| sent / sends)?;
            node.weight *= scale;
            node.tilt *= scale;
        }
        let first = self.children.len();
        self.children.extend(children.iter().map(|&(_, index)| index));
        self.arena.push(Growing { node, moments, cells, children: first..self.children.len() });
        Some(self.arena.len() - 1)
    }

    /// The block's nodes, level by level below its `roots`.
    fn emit(&self, roots: Vec<usize>) -> Block {
        let mut block = Block {
            nodes: Vec::with_capacity(self.arena.len()),
            roots: roots.len() as u32,
            cells: Vec::new(),
        };
        let mut order = roots;
        order.reserve_exact(self.arena.len() - order.len());
        while let Some(&index) = order.get(block.nodes.len()) {
            let growing = &self.arena[index];
            let cells = growing.cells.map(|Cells(words)| {
                block.cells.push(words);
                block.cells.len() as u32 - 1
            });
            let first = order.len() as u32;
            order.extend_from_slice(&self.children[growing.children.clone()]);
            block.nodes.push(Node { cells, children: first..order.len() as u32, ..growing.node.clone() });
        }
        block
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
        Visibility::Cells { words } => Some(Cells::from_words(words)),
    };
    let node = Node {
        center: sample.center,
        half_size: sample.half_size,
        inverse_depth: sample.inverse_depth,
        inverse_depth_spread: 0.0,
        weight: sample.weight,
        tilt: sample.tilt,
        radiance: sample.radiance,
        dipole: 0.0,
        level,
        cells: None,
        children: 0..0,
        sample: Some(index),
    };
    Growing { node, moments: [Vec3::ZERO; 2], cells, children: 0..0 }
}

/// The node that replaces `nodes`.
fn mean<'a, I: Iterator<Item = &'a Node>>(level: u8, nodes: impl Fn() -> I) -> Node {
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
        dipole: 0.0,
        level,
        cells: None,
        children: 0..0,
        sample: None,
    }
}

/// See [`Growing::moments`]: those of the `members` that a node replaces, about its centre.
fn moments<'a, I: Iterator<Item = &'a Growing>>(node: &Node, members: impl Fn() -> I) -> [Vec3; 2] {
    let weight = |member: &Growing| largest_weight(&member.node);
    let total: f32 = members().map(weight).sum();
    [0, 1].map(|axis| {
        let of = |member: &Growing| {
            let apart = member.node.center[axis] - node.center[axis];
            weight(member) * (member.moments[axis] + apart * member.node.radiance)
        };
        members().map(of).sum::<Vec3>() / total
    })
}

/// The cells that most members see; where they are even, every other cell.
fn majority<'a, I: Iterator<Item = &'a Cells>>(members: impl Fn() -> I) -> Cells {
    const CHECKERS: u64 = 0x5555_AAAA_5555_AAAA;
    let number = members().count();
    Cells(std::array::from_fn(|word| {
        // Counts of 64 cells at once: bit k of the count of each in `count[k]`.
        let mut count = [0u64; COUNTER_BITS];
        for Cells(words) in members() {
            let mut carry = words[word];
            for bit in &mut count {
                (*bit, carry) = (*bit ^ carry, *bit & carry);
            }
        }
        let (more, even) = compare(&count, number / 2);
        more | if number.is_multiple_of(2) { even & CHECKERS } else { 0 }
    }))
}

/// Bits of the counts of [`majority`].
const COUNTER_BITS: usize = 5;

/// Nodes that are joined at most.
const MAX_MEMBERS: usize = (1 << COUNTER_BITS) - 1;

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
    fn from_words(words: &[u64]) -> Self {
        match *words {
            [word] => Self(finer(word)),
            [a, b, c, d] => Self([a, b, c, d]),
            _ => unreachable!("a visibility has one word or four"),
        }
    }

    /// The sum over the cells of the weight that a node has toward them; unless it is edge-on, toward the centre.
    fn sent(&self, node: &Node) -> f32 {
        if !is_edge_on(node) {
            let visible: u32 = self.0.iter().map(|word| word.count_ones()).sum();
            return node.weight * visible as f32;
        }
        let cell = |k: usize| Vec2::new((k % 16) as f32 + 0.5, (k / 16) as f32 + 0.5) / 8.0 - 1.0;
        let is_visible = |k: &usize| self.0[k / 64] >> (k % 64) & 1 == 1;
        (0..256).filter(is_visible).map(|k| (node.weight + node.tilt.dot(cell(k))).max(0.0)).sum()
    }

    /// Whether any cell is visible to both.
    fn overlaps(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).any(|(a, b)| a & b != 0)
    }

    /// The share of cells that differ.
    fn distance(&self, other: &Self) -> f32 {
        let differing: u32 = self.0.iter().zip(other.0).map(|(a, b)| (a ^ b).count_ones()).sum();
        differing as f32 / 256.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use lens::Camera;
    use surface::SurfacePoint;

    #[test]
    fn most_is_a_majority() {
        let seen = [0b1110, 0b1100, 0b1010].map(|word| Cells([word, 0, u64::MAX, 0]));
        assert_eq!(majority(|| seen.iter()).0, [0b1110, 0, u64::MAX, 0]);
        assert_eq!(majority(|| seen[..2].iter()).0[0], 0b1100 | 0b0010 & 0x5555_AAAA_5555_AAAA);
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
                is_carried: false,
                visibility: Visibility::Open,
            }
        };
        let samples = (0..40 * 24).map(sample).collect();
        Salf::with_samples(camera, samples)
    }

    fn blocks(salf: &Salf) -> Vec<Block> {
        each_block(salf, 4.0, |block| block)
    }

    #[test]
    fn a_plane_becomes_a_pyramid_and_keeps_its_sums() {
        let salf = plane(|_, _| 0.5);
        let blocks = blocks(&salf);
        let nodes = || blocks.iter().flat_map(|block| &block.nodes);
        let mut samples: Vec<_> = nodes().filter_map(|node| node.sample).collect();
        samples.sort();
        assert!(samples.iter().copied().eq(0..salf.samples.len() as u32));
        let block = &blocks[1].nodes[0];
        assert_eq!((block.level, block.weight, block.center), (4, 256.0, Vec2::new(24.0, 8.0)));
        assert!((block.half_size - 8.0).abs().max_element() < 1e-3);
        assert!((block.radiance.x - 0.235).abs() < 1e-5);
        let highlight = nodes().find(|node| node.sample == Some(3 * 40 + 3)).expect("it is there");
        assert_eq!((highlight.radiance.x, highlight.level), (100.0, 0));
        // The sum of each tree is that of its leaves.
        let roots = blocks.iter().flat_map(|block| &block.nodes[..block.roots as usize]);
        let weight: f32 = roots.map(|root| root.weight).sum();
        assert_eq!(weight, 40.0 * 24.0);
    }

    #[test]
    fn every_node_is_a_root_or_below_one_node_that_comes_before_it() {
        for block in blocks(&plane(|x, y| if (x * 7 + y * 3) % 11 < 4 { 0.5 } else { 3.0 })) {
            let mut found = vec![0; block.nodes.len()];
            found[..block.roots as usize].fill(1);
            let mut next = block.roots;
            for (at, Node { children, sample, .. }) in block.nodes.iter().enumerate() {
                assert_eq!((children.start, children.is_empty()), (next, sample.is_some()), "{at}");
                children.clone().for_each(|child| found[child as usize] += 1);
                next = children.end;
            }
            assert_eq!(next as usize, block.nodes.len());
            assert!(found.iter().all(|&times| times == 1));
        }
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
        let blocks = blocks(&salf);
        let mut joined = 0;
        let nodes = blocks.iter().flat_map(|block| block.nodes.iter().map(move |node| (block, node)));
        for (block, node) in nodes.filter(|(_, node)| node.sample.is_none()) {
            let mut below: Vec<_> = node.children.clone().collect();
            let mut most = 0.0;
            while let Some(at) = below.pop() {
                let node = &block.nodes[at as usize];
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
        let blocks = blocks(&salf);
        let nodes = || blocks.iter().flat_map(|block| &block.nodes);
        assert!(nodes().all(|node| node.inverse_depth == 0.5 || node.inverse_depth == 3.0));
        assert!(nodes().any(|node| node.level == 4));
    }
}
