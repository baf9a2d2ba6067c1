//! First hit of a ray among the scene's triangles: a small bounding volume hierarchy, enough for baking.

use glam::Vec3;

struct Node {
    low: Vec3,
    high: Vec3,
    /// First triangle of a leaf, or the second child (the first follows its parent).
    first: u32,
    /// Triangles in a leaf; 0 for an inner node.
    count: u32,
}

/// The hierarchy.
pub struct Rays {
    nodes: Vec<Node>,
    order: Vec<u32>,
    corners: Vec<[Vec3; 3]>,
}

impl Rays {
    /// Over these triangles.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = Vec::new();
        split(triangles, &mut order, 0, &mut nodes);
        let corners = order.iter().map(|&t| triangles[t as usize]).collect();
        Self { nodes, order, corners }
    }

    /// The index of the first triangle hit within `limit`.
    pub fn first(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<u32> {
        self.walk(origin, direction, limit, false)
    }

    /// Whether anything is hit within `limit`.
    pub fn blocked(&self, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        self.walk(origin, direction, limit, true).is_some()
    }

    fn walk(&self, origin: Vec3, direction: Vec3, limit: f32, any: bool) -> Option<u32> {
        let inverse = direction.recip();
        let enters = |node: &Node, best: f32| {
            let (a, b) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            near <= far && far >= 0.0 && near <= best
        };
        let mut best = limit;
        let mut hit = None;
        let mut stack = [0u32; 64];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let index = stack[top];
            let node = &self.nodes[index as usize];
            if !enters(node, best) {
                continue;
            }
            if node.count == 0 {
                stack[top] = node.first;
                stack[top + 1] = index + 1;
                top += 2;
                continue;
            }
            for k in node.first..node.first + node.count {
                if let Some(distance) = intersect(&self.corners[k as usize], origin, direction)
                    && distance < best
                {
                    best = distance;
                    hit = Some(self.order[k as usize]);
                    if any {
                        return hit;
                    }
                }
            }
        }
        hit
    }
}

fn split(triangles: &[[Vec3; 3]], order: &mut [u32], first: u32, nodes: &mut Vec<Node>) {
    let bounds = order.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &t| {
        triangles[t as usize].iter().fold((low, high), |(low, high), p| (low.min(*p), high.max(*p)))
    });
    let index = nodes.len();
    nodes.push(Node { low: bounds.0, high: bounds.1, first, count: order.len() as u32 });
    if order.len() <= 4 {
        return;
    }
    let center = |t: u32| triangles[t as usize].iter().sum::<Vec3>();
    let (low, high) = order.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &t| {
        (low.min(center(t)), high.max(center(t)))
    });
    let extent = high - low;
    let axis = if extent.x >= extent.y.max(extent.z) {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| center(a)[axis].total_cmp(&center(b)[axis]));
    let (left, right) = order.split_at_mut(middle);
    split(triangles, left, first, nodes);
    nodes[index].first = nodes.len() as u32;
    nodes[index].count = 0;
    split(triangles, right, first + middle as u32, nodes);
}

/// Distance to the triangle along the ray (Möller and Trumbore).
fn intersect([a, b, c]: &[Vec3; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
    let (e1, e2) = (*b - *a, *c - *a);
    let p = direction.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = origin - *a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = direction.dot(q) / det;
    let distance = e2.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::noise::hash;

    #[test]
    fn the_hierarchy_finds_what_a_search_through_all_finds() {
        let point = |i: i32, k: i32| Vec3::new(hash(i, k, 0), hash(i, k, 1), hash(i, k, 2)) * 2.0 - 1.0;
        let triangles: Vec<[Vec3; 3]> =
            (0..300).map(|i| [0, 1, 2].map(|k| point(i, 9) + point(i, k) * 0.5)).collect();
        let rays = Rays::new(&triangles);
        let mut hits = 0;
        for i in 0..500 {
            let (origin, direction) = (point(i, 50) * 2.0, point(i, 51).normalize());
            let distances = triangles.iter().map(|t| intersect(t, origin, direction));
            let nearest = distances.enumerate().filter_map(|(k, d)| Some((d?, k as u32)));
            let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
            assert_eq!(rays.first(origin, direction, f32::INFINITY), nearest.map(|(_, k)| k));
            if let Some((distance, _)) = nearest {
                hits += 1;
                assert!(rays.blocked(origin, direction, distance * 1.001));
                assert!(!rays.blocked(origin, direction, distance * 0.999));
            }
        }
        assert!(hits > 50, "{hits} hits prove little");
    }
}
