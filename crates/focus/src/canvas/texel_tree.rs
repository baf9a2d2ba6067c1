//! Finding points within a sphere: a bounding-box tree over points that it reorders.

use glam::Vec3;

/// A balanced tree of boxes (a k-d tree) over points that were reordered so that each box is a range.
///
/// A node splits its range in the middle, so ranges and children follow from the number of points alone.
#[derive(Clone, Debug)]
pub(crate) struct TexelTree {
    points: Vec<Vec3>,
    /// In pre-order: a node's left child follows it.
    nodes: Vec<Node>,
}

/// A box and, unless it is a leaf, its right child.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    right: u32,
}

/// Points in a leaf, at most.
const LEAF: usize = 32;

impl TexelTree {
    /// Builds the tree; also returns the original index of each of its points.
    pub(crate) fn new(points: &[Vec3]) -> (Self, Vec<u32>) {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let blank = Node { low: Vec3::ZERO, high: Vec3::ZERO, right: 0 };
        let mut nodes = vec![blank; node_count(points.len())];
        if !points.is_empty() {
            build(points, &mut order, &mut nodes, 0);
        }
        let points = order.iter().map(|&i| points[i as usize]).collect();
        (Self { points, nodes }, order)
    }

    /// The points, in the tree's order.
    pub(crate) fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The memory that it takes, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.points) + size_of_val(&*self.nodes)
    }

    /// Calls `visit` with the index (in the tree's order) and squared distance of every point at most
    /// `radius` from `center`, in order.
    pub(crate) fn visit_within(&self, center: Vec3, radius: f32, visit: &mut impl FnMut(usize, f32)) {
        if !self.points.is_empty() {
            self.visit_node(0, 0..self.points.len(), center, radius * radius, visit);
        }
    }

    fn visit_node(
        &self,
        node: usize,
        range: std::ops::Range<usize>,
        center: Vec3,
        radius_squared: f32,
        visit: &mut impl FnMut(usize, f32),
    ) {
        let Node { low, high, right } = self.nodes[node];
        if center.distance_squared(center.clamp(low, high)) > radius_squared {
            return;
        }
        if range.len() <= LEAF {
            for index in range {
                let distance_squared = self.points[index].distance_squared(center);
                if distance_squared <= radius_squared {
                    visit(index, distance_squared);
                }
            }
            return;
        }
        let middle = range.start + range.len() / 2;
        self.visit_node(node + 1, range.start..middle, center, radius_squared, visit);
        self.visit_node(right as usize, middle..range.end, center, radius_squared, visit);
    }
}

/// Nodes of the tree over `points` points.
fn node_count(points: usize) -> usize {
    node_counts(points)[0]
}

/// Numbers of nodes of the trees over `points` and over `points` + 1 points: each half has half as many, or one more.
fn node_counts(points: usize) -> [usize; 2] {
    if points < LEAF {
        return [1, 1];
    }
    let [half, more] = node_counts(points / 2);
    let even = 1 + 2 * half;
    let odd = 1 + half + more;
    match points.is_multiple_of(2) {
        true => [if points == LEAF { 1 } else { even }, odd],
        false => [odd, 1 + 2 * more],
    }
}

/// Sorts `order` so that every node of its tree is a range, and fills in the nodes, the first of which is number
/// `first` of the whole tree.
fn build(points: &[Vec3], order: &mut [u32], nodes: &mut [Node], first: usize) {
    let at = |i: u32| points[i as usize];
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = order.iter().map(|&i| at(i)).fold(start, |(l, h), p| (l.min(p), h.max(p)));
    let middle = order.len() / 2;
    let left_nodes = node_count(middle);
    let right = first + 1 + left_nodes;
    nodes[0] = Node { low, high, right: right as u32 };
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).max_position();
    // Ties are broken by index, so that the order depends on nothing but the points.
    order.select_nth_unstable_by(middle, |&i, &j| at(i)[axis].total_cmp(&at(j)[axis]).then(i.cmp(&j)));
    let (left_order, right_order) = order.split_at_mut(middle);
    let (left, rest) = nodes[1..].split_at_mut(left_nodes);
    rayon::join(|| build(points, left_order, left, first + 1), || build(points, right_order, rest, right));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_counted_as_they_are_built() {
        fn counted(points: usize) -> usize {
            if points <= LEAF { 1 } else { 1 + counted(points / 2) + counted(points - points / 2) }
        }
        for points in (0..400).chain([4095, 4096, 4097, 100_003]) {
            assert_eq!(node_count(points), counted(points), "{points}");
        }
    }

    #[test]
    fn finds_what_a_search_through_all_finds() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1664525).wrapping_add(1013904223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let points: Vec<_> = (0..5000).map(|_| Vec3::new(random(), random(), 0.1 * random())).collect();
        let (tree, order) = TexelTree::new(&points);
        for radius in [0.0, 0.02, 0.3, 3.0] {
            let center = Vec3::new(random(), random(), 0.05);
            let mut visited = Vec::new();
            tree.visit_within(center, radius, &mut |i, _| visited.push(order[i]));
            visited.sort_unstable();
            let inside = |i: &u32| points[*i as usize].distance_squared(center) <= radius * radius;
            assert_eq!(visited, (0..5000).filter(inside).collect::<Vec<_>>());
        }
    }

    #[test]
    fn empty_and_coincident_points() {
        let (tree, _) = TexelTree::new(&[]);
        tree.visit_within(Vec3::ZERO, 1.0, &mut |_, _| panic!("nothing to find"));
        let (tree, _) = TexelTree::new(&[Vec3::ONE; 1000]);
        let mut count = 0;
        tree.visit_within(Vec3::ONE, 0.0, &mut |_, _| count += 1);
        assert_eq!(count, 1000);
    }
}
