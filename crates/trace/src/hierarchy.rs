//! A hierarchy of boxes, four to a node, and the walk of a ray through it.
//!
//! The binary tree comes from `obvhs` (PLOC with reinsertion); its nodes are joined by fours, so that one
//! step tests four boxes side by side.

use crate::local_space::{FAR_STRETCH, LocalRay};
use glam::{DVec3, Vec3, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::ops::Range;

/// Where the stack of a walk lives without allocating; deeper trees than any but the most contrived need
/// more.
const SHALLOW_STACK: usize = 96;

/// Boxes over items that are numbered in the order of the leaves.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    /// The most entries that a walk can have waiting.
    stack_size: usize,
}

/// Four boxes and what they hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// By axis, the low and high sides of the four boxes. An absent child has a box turned inside out, which
    /// nothing meets.
    pub sides: [[Vec4; 2]; 3],
    /// A node, or the first item of a leaf.
    first: [u32; 4],
    /// Items of a leaf; 0 for a node.
    count: [u32; 4],
}

/// A child that a ray meets, and where.
#[derive(Clone, Copy, Default)]
struct Pending {
    near: f32,
    first: u32,
    count: u32,
}

/// What walks through a part of space.
pub(crate) trait Visit {
    /// The boxes of a node to visit, a bit each; `overlapping` are those that overlap the half-spaces.
    #[inline(always)]
    fn select_children(&mut self, _node: &Node, overlapping: u32) -> u32 {
        overlapping
    }

    /// Visits the items of a leaf; returns the distance up to which the traversal continues: −∞ ends it.
    fn leaf(&mut self, items: Range<usize>) -> f32;
}

impl<F: FnMut(Range<usize>) -> f32> Visit for F {
    #[inline(always)]
    fn leaf(&mut self, items: Range<usize>) -> f32 {
        self(items)
    }
}

impl Hierarchy {
    /// Builds over boxes; also returns the item at each place of the leaves' order.
    pub fn build(boxes: &[Aabb]) -> (Self, Vec<u32>) {
        if boxes.is_empty() {
            return (Self::default(), Vec::new());
        }
        let params = BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::medium_build() };
        let binary = build_bvh2(boxes, params, &mut std::time::Duration::default());
        let mut joined =
            NodeMerger { binary: &binary, nodes: Vec::new(), order: Vec::with_capacity(boxes.len()) };
        let depth = joined.join();
        let (nodes, order) = (joined.nodes, joined.order);
        (Self { nodes, stack_size: 3 * depth + 4 }, order)
    }

    /// All nodes; the first is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Bytes of memory that all nodes take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Calls `visit` for the items of every leaf that the ray meets before local t `far`, nearer leaves first
    /// (by and large); `visit` returns the new `far`, or `None` to end the walk.
    #[inline(always)]
    pub fn walk(&self, ray: &LocalRay, far: f32, visit: impl FnMut(Range<usize>) -> Option<f32>) {
        if self.stack_size <= SHALLOW_STACK {
            self.walk_with(&mut [Pending::default(); SHALLOW_STACK], ray, far, visit);
        } else {
            self.walk_with(&mut vec![Pending::default(); self.stack_size], ray, far, visit);
        }
    }

    /// Visits the items of every leaf whose box overlaps `space` and begins nearer than `far` (see
    /// [`Halfspaces::height`]), nearer ones first by and large; the visit of a leaf returns the new `far`.
    #[inline(always)]
    pub fn walk_halfspaces(&self, space: &Halfspaces, far: f32, visit: &mut impl Visit) {
        if self.stack_size <= SHALLOW_STACK {
            self.walk_halfspaces_with(&mut [Pending::default(); SHALLOW_STACK], space, far, visit);
        } else {
            self.walk_halfspaces_with(&mut vec![Pending::default(); self.stack_size], space, far, visit);
        }
    }

    #[inline(always)]
    fn walk_halfspaces_with(
        &self,
        stack: &mut [Pending],
        space: &Halfspaces,
        mut far: f32,
        visit: &mut impl Visit,
    ) {
        let mut waiting = usize::from(!self.nodes.is_empty());
        if waiting > 0 {
            stack[0] = Pending { near: f32::NEG_INFINITY, first: 0, count: 0 };
        }
        while waiting > 0 {
            waiting -= 1;
            let Pending { near, first, count } = stack[waiting];
            if near > far {
                continue;
            }
            if count > 0 {
                far = visit.leaf(first as usize..(first + count) as usize);
                continue;
            }
            let node = &self.nodes[first as usize];
            let (mut overlapping, near) = space.overlap(node);
            overlapping &= near.cmple(Vec4::splat(far)).bitmask();
            overlapping = visit.select_children(node, overlapping);
            let near = near.to_array();
            let base = waiting;
            while overlapping != 0 {
                let child = (overlapping.trailing_zeros() & 3) as usize;
                overlapping &= overlapping - 1;
                let new = Pending { near: near[child], first: node.first[child], count: node.count[child] };
                // The nearest on top.
                let mut place = waiting;
                while place > base && stack[place - 1].near < new.near {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = new;
                waiting += 1;
            }
        }
    }

    #[inline(always)]
    fn walk_with(
        &self,
        stack: &mut [Pending],
        ray: &LocalRay,
        mut far: f32,
        mut visit: impl FnMut(Range<usize>) -> Option<f32>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let splat = |v: Vec3| [Vec4::splat(v.x), Vec4::splat(v.y), Vec4::splat(v.z)];
        let [near_x, near_y, near_z] = splat(ray.near_origin);
        let [far_x, far_y, far_z] = splat(ray.far_origin);
        let [inverse_x, inverse_y, inverse_z] = splat(ray.inverse);
        let [side_x, side_y, side_z] = ray.near_side;
        let mut waiting = 0;
        let mut current = Pending { near: 0.0, first: 0, count: 0 };
        loop {
            if current.count == 0 {
                let node = &self.nodes[current.first as usize];
                let [x, y, z] = &node.sides;
                let near = ((x[side_x & 1] - near_x) * inverse_x)
                    .max((y[side_y & 1] - near_y) * inverse_y)
                    .max(((z[side_z & 1] - near_z) * inverse_z).max(Vec4::ZERO));
                let end = ((x[1 - (side_x & 1)] - far_x) * inverse_x)
                    .min((y[1 - (side_y & 1)] - far_y) * inverse_y)
                    .min((z[1 - (side_z & 1)] - far_z) * inverse_z)
                    * FAR_STRETCH;
                let mut met = near.cmple(end.min(Vec4::splat(far))).bitmask();
                let near = near.to_array();
                // Insert the children that are met so that the nearest lies on top.
                let base = waiting;
                while met != 0 {
                    let child = (met.trailing_zeros() & 3) as usize;
                    met &= met - 1;
                    let new =
                        Pending { near: near[child], first: node.first[child], count: node.count[child] };
                    let mut place = waiting;
                    while place > base && stack[place - 1].near < new.near {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = new;
                    waiting += 1;
                }
            } else {
                let first = current.first as usize;
                match visit(first..first + current.count as usize) {
                    Some(new_far) => far = new_far,
                    None => return,
                }
            }
            loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                current = stack[waiting];
                if current.near <= far {
                    break;
                }
            }
        }
    }
}

/// Half-spaces of local space; what lies in all of them, generously.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Halfspaces {
    /// Normal and offset: n·x + offset ≥ 0 inside.
    planes: [(Vec3, f32); Self::MAX_PLANES],
    count: usize,
    /// Boxes are visited in ascending order along this direction.
    toward: Vec3,
}

impl Halfspaces {
    const MAX_PLANES: usize = 6;

    /// What f32 may be wrong by, as a share of what is summed.
    const SLACK: f64 = 1.0 / (1u32 << 20) as f64;

    /// All of space; boxes are visited in ascending order along the direction `toward`.
    pub fn toward(toward: DVec3) -> Self {
        Self { toward: toward.as_vec3(), ..Self::default() }
    }

    /// Adds the side on which `inside` lies of the plane through `on`. A normal of 0 adds nothing.
    pub fn add(&mut self, normal: DVec3, on: DVec3, inside: DVec3) {
        let Some(normal) = normal.try_normalize() else { return };
        let normal = if normal.dot(inside - on) < 0.0 { -normal } else { normal };
        let offset = -normal.dot(on);
        let slack = Self::SLACK * (2.0 + offset.abs());
        self.planes[self.count] = (normal.as_vec3(), (offset + slack) as f32);
        self.count += 1;
    }

    /// How high along `toward` a position lies: none of the boxes that hold it count as higher.
    pub fn height(toward: DVec3, position: DVec3) -> f32 {
        let height = toward.dot(position);
        (height + Self::SLACK * (2.0 + height.abs())) as f32
    }

    /// A bit for each of a node's boxes that reaches in here, and where each begins along `toward`.
    #[inline(always)]
    fn overlap(&self, node: &Node) -> (u32, Vec4) {
        let [low, high] = node.sides[0];
        let mut overlapping = low.cmple(high).bitmask();
        for (normal, offset) in &self.planes[..self.count] {
            let mut farthest = Vec4::splat(*offset);
            for (sides, normal) in node.sides.iter().zip(normal.to_array()) {
                farthest += sides[usize::from(normal >= 0.0)] * normal;
            }
            overlapping &= farthest.cmpge(Vec4::ZERO).bitmask();
        }
        let mut nearest = Vec4::ZERO;
        for (sides, toward) in node.sides.iter().zip(self.toward.to_array()) {
            nearest += sides[usize::from(toward < 0.0)] * toward;
        }
        (overlapping, nearest)
    }
}

/// The join of a binary tree's nodes by fours.
struct NodeMerger<'a> {
    binary: &'a Bvh2,
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl NodeMerger<'_> {
    /// Fills `nodes` and `order`; returns the depth. Works off a list, not the call stack: trees can be as
    /// deep as they have items.
    fn join(&mut self) -> usize {
        let mut deepest = 0;
        self.nodes.push(Node::EMPTY);
        let root = if self.binary.nodes[0].is_leaf() { vec![0] } else { self.four_descendants(0) };
        let mut open = vec![(0, root, 1)];
        while let Some((node, children, depth)) = open.pop() {
            deepest = deepest.max(depth);
            for (slot, child) in children.into_iter().enumerate() {
                let source = &self.binary.nodes[child];
                self.nodes[node].set_sides(slot, source.aabb());
                if source.is_leaf() {
                    let items =
                        source.first_index as usize..(source.first_index + source.prim_count) as usize;
                    self.nodes[node].first[slot] = self.order.len() as u32;
                    self.nodes[node].count[slot] = source.prim_count;
                    self.order.extend_from_slice(&self.binary.primitive_indices[items]);
                } else {
                    self.nodes[node].first[slot] = self.nodes.len() as u32;
                    let grandchildren = self.four_descendants(child);
                    open.push((self.nodes.len(), grandchildren, depth + 1));
                    self.nodes.push(Node::EMPTY);
                }
            }
        }
        deepest
    }

    /// Up to four descendants of a binary node: its children, the largest of them opened until there are
    /// four.
    fn four_descendants(&self, node: usize) -> Vec<usize> {
        let pair = |node: usize| {
            let first = self.binary.nodes[node].first_index as usize;
            [first, first + 1]
        };
        let mut children = pair(node).to_vec();
        while children.len() < 4 {
            let inner = (0..children.len()).filter(|&k| !self.binary.nodes[children[k]].is_leaf());
            let area = |&k: &usize| self.binary.nodes[children[k]].aabb().half_area();
            let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
            let [first, second] = pair(children.swap_remove(largest));
            children.extend([first, second]);
        }
        children
    }
}

impl Node {
    /// Of each child the node, or the first item of the leaf; and the number of items, 0 for a node.
    pub fn children(&self) -> ([u32; 4], [u32; 4]) {
        (self.first, self.count)
    }

    const EMPTY: Self =
        Self { sides: [[Vec4::INFINITY, Vec4::NEG_INFINITY]; 3], first: [0; 4], count: [0; 4] };

    fn set_sides(&mut self, slot: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.sides[axis][0][slot] = bounds.min[axis];
            self.sides[axis][1][slot] = bounds.max[axis];
        }
    }
}
