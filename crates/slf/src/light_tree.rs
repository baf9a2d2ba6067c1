//! Importance sampling of many lights.
//!
//! A binary tree over all lights (Conty Estevez and Kulla 2018). Each node bounds the positions and orientations of its
//! lights, which gives an estimate of how much of their power arrives at a position: Φ·cos θ′/d², where θ′ is the least
//! angle at which any of them may be left and d the distance to their centre. Sampling descends from the root by these
//! estimates. A light has probability 0 exactly if its light cannot arrive.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Bounds of one light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightBounds {
    pub low: DVec3,
    pub high: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    pub both_sides: bool,
    pub power: f64,
}

/// A tree over lights, which keep the numbers of the input.
#[derive(Debug, Default)]
pub(crate) struct LightTree {
    /// A node's first child follows it directly.
    nodes: Vec<Node>,
    /// By light: which child leads to it at each level, starting from the lowest bit.
    trails: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: NodeBounds,
    kind: NodeKind,
}

#[derive(Clone, Copy, Debug)]
enum NodeKind {
    /// The light with this number.
    Leaf(u32),
    /// Two child nodes; this is the index of the second.
    Inner(u32),
}

/// Bounds of the lights of a node.
#[derive(Clone, Copy, Debug)]
struct NodeBounds {
    low: DVec3,
    high: DVec3,
    /// Axis of a cone that contains all normals, and its half angle, rad.
    axis: DVec3,
    spread: f64,
    both_sides: bool,
    power: f64,
}

/// Number of buckets along an axis between which splits are tried.
const BUCKETS: usize = 12;
/// At this depth and below, lights are split by number so that the trail bits suffice.
const MAX_SPLIT_DEPTH: usize = 32;

impl LightTree {
    /// Builds the tree over lights that have power; lights keep their numbers in `lights`.
    pub fn new(lights: &[LightBounds]) -> Self {
        let mut tree = Self { nodes: Vec::new(), trails: vec![0; lights.len()] };
        let mut lights_left: Vec<u32> = (0..lights.len() as u32).collect();
        if !lights_left.is_empty() {
            tree.build(lights, &mut lights_left, 0, 0);
        }
        tree
    }

    fn build(&mut self, lights: &[LightBounds], numbers: &mut [u32], depth: usize, trail: u64) {
        let all = numbers.iter().map(|&number| NodeBounds::from_light(&lights[number as usize]));
        let bounds = all.reduce(NodeBounds::union).expect("a node has lights");
        let place = self.nodes.len();
        if let [number] = *numbers {
            self.trails[number as usize] = trail;
            self.nodes.push(Node { bounds, kind: NodeKind::Leaf(number) });
            return;
        }
        self.nodes.push(Node { bounds, kind: NodeKind::Inner(0) });
        let middle = split_lights(lights, numbers, depth);
        let (first, second) = numbers.split_at_mut(middle);
        self.build(lights, first, depth + 1, trail);
        self.nodes[place].kind = NodeKind::Inner(self.nodes.len() as u32);
        self.build(lights, second, depth + 1, trail | 1 << depth);
    }

    /// Samples a light for a position from a uniform number; returns its number and probability. `None` if no light of
    /// the node it descended to can arrive.
    pub fn draw(&self, position: DVec3, mut choice: f64) -> Option<(usize, f64)> {
        let (mut node, mut probability) = (0, 1.0);
        loop {
            match self.nodes[node].kind {
                NodeKind::Leaf(number) => return Some((number as usize, probability)),
                NodeKind::Inner(second) => {
                    let first_probability = self.first_child_probability(node, second as usize, position)?;
                    let is_first = choice < first_probability;
                    let share = if is_first { first_probability } else { 1.0 - first_probability };
                    choice = if is_first { choice / share } else { (choice - first_probability) / share };
                    probability *= share;
                    node = if is_first { node + 1 } else { second as usize };
                }
            }
        }
    }

    /// The probability, in [0, 1], with which [`Self::draw`] chooses the light with this number for a position
    /// (world).
    pub fn probability(&self, position: DVec3, number: usize) -> f64 {
        let (mut node, mut probability, mut trail) = (0, 1.0, self.trails[number]);
        while let NodeKind::Inner(second) = self.nodes[node].kind {
            let Some(first_probability) = self.first_child_probability(node, second as usize, position)
            else {
                return 0.0;
            };
            let is_first = trail & 1 == 0;
            probability *= if is_first { first_probability } else { 1.0 - first_probability };
            node = if is_first { node + 1 } else { second as usize };
            trail >>= 1;
        }
        probability
    }

    fn first_child_probability(&self, node: usize, second: usize, position: DVec3) -> Option<f64> {
        let [first, second] = [node + 1, second].map(|child| self.nodes[child].bounds.importance(position));
        let sum = first + second;
        (sum > 0.0).then(|| first / sum)
    }
}

/// Splits lights in two non-empty groups at the least total cost (surface area orientation heuristic); returns the size
/// of the first.
fn split_lights(lights: &[LightBounds], numbers: &mut [u32], depth: usize) -> usize {
    let middle_of = |number: u32| {
        let light = &lights[number as usize];
        0.5 * (light.low + light.high)
    };
    let (low, high) = numbers
        .iter()
        .map(|&number| middle_of(number))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let extent = high - low;
    let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    if depth >= MAX_SPLIT_DEPTH || !(extent[axis] > 0.0 && extent[axis].is_finite()) {
        return numbers.len() / 2;
    }
    let slice_of = |number: u32| {
        let share = (middle_of(number)[axis] - low[axis]) / extent[axis];
        ((share * BUCKETS as f64) as usize).min(BUCKETS - 1)
    };
    let mut slices: [Option<NodeBounds>; BUCKETS] = [None; BUCKETS];
    for &number in numbers.iter() {
        let bounds = NodeBounds::from_light(&lights[number as usize]);
        let slice = &mut slices[slice_of(number)];
        *slice = Some(slice.map_or(bounds, |sum| sum.union(bounds)));
    }
    // Bounds of the buckets up to each one, from either end.
    let join = |sum: &mut Option<NodeBounds>, slice: &Option<NodeBounds>| {
        *sum = match (*sum, *slice) {
            (Some(sum), Some(slice)) => Some(sum.union(slice)),
            (sum, slice) => sum.or(slice),
        };
        Some(sum.map_or(f64::INFINITY, |bounds| bounds.cost()))
    };
    let below: Vec<f64> = slices.iter().scan(None, join).collect();
    let above: Vec<f64> = slices.iter().rev().scan(None, join).collect();
    let cost_at = |end: usize| below[end - 1] + above[BUCKETS - 1 - end];
    let best = (1..BUCKETS).min_by(|&a, &b| cost_at(a).total_cmp(&cost_at(b))).expect("there are slices");
    // The lights of the first and of the last bucket never end up on the same side.
    numbers.sort_by_key(|&number| slice_of(number) >= best);
    numbers.partition_point(|&number| slice_of(number) < best)
}

impl NodeBounds {
    fn from_light(light: &LightBounds) -> Self {
        let &LightBounds { low, high, normal, both_sides, power } = light;
        Self { low, high, axis: normal, spread: 0.0, both_sides, power }
    }

    fn union(self, other: Self) -> Self {
        let (axis, spread) = joint_cone((self.axis, self.spread), (other.axis, other.spread));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            spread,
            both_sides: self.both_sides || other.both_sides,
            power: self.power + other.power,
        }
    }

    /// Estimate of the power that may arrive at a position, up to a common factor.
    fn importance(&self, position: DVec3) -> f64 {
        let toward = position - 0.5 * (self.low + self.high);
        let radius2 = 0.25 * (self.high - self.low).length_squared();
        let d2 = toward.length_squared();
        if d2 <= radius2 {
            // The position lies within the bounds: any light may be near and face it.
            return self.power / radius2;
        }
        let along = self.axis.dot(toward) / d2.sqrt();
        let along = if self.both_sides { along.abs() } else { along };
        let angular_radius = (radius2 / d2).sqrt().asin();
        let min_angle = along.clamp(-1.0, 1.0).acos() - self.spread - angular_radius;
        if min_angle >= FRAC_PI_2 { 0.0 } else { self.power * min_angle.max(0.0).cos() / d2 }
    }

    /// Cost of a node: power by size and by the share of directions it lights.
    fn cost(&self) -> f64 {
        let size = self.high - self.low;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        // Integral of the cosine beyond the cone's rim over all directions.
        let spread = if self.both_sides { PI } else { self.spread };
        let end = (spread + FRAC_PI_2).min(PI);
        let lit = 2.0 * PI * (1.0 - spread.cos())
            + FRAC_PI_2
                * (2.0 * end * spread.sin() - (spread - 2.0 * end).cos() - 2.0 * spread * spread.sin()
                    + spread.cos());
        // Bounds that are flat along two axes still distinguish near from far by their length.
        self.power * (area + size.length_squared()) * lit
    }
}

/// The narrowest cone that contains two cones, by axis and half angle.
fn joint_cone((a, spread_a): (DVec3, f64), (b, spread_b): (DVec3, f64)) -> (DVec3, f64) {
    let between = a.angle_between(b);
    if (between + spread_b).min(PI) <= spread_a {
        return (a, spread_a);
    }
    if (between + spread_a).min(PI) <= spread_b {
        return (b, spread_b);
    }
    let spread = 0.5 * (spread_a + between + spread_b);
    let across = a.cross(b);
    if spread >= PI || across == DVec3::ZERO {
        return (a, PI);
    }
    let axis = glam::DQuat::from_axis_angle(across.normalize(), spread - spread_a) * a;
    (axis.normalize(), spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random number in [0, 1) (splitmix64).
    fn random(seed: u64) -> f64 {
        let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 11) as f64 / (1u64 << 53) as f64
    }

    fn place(seed: u64) -> DVec3 {
        DVec3::new(random(seed), random(seed + 1), random(seed + 2))
    }

    fn lights(count: u64) -> Vec<LightBounds> {
        let light = |k: u64| {
            let low = place(10 * k + 1) * 10.0;
            let normal = (place(10 * k + 4) - 0.5).normalize();
            let power = 0.1 + random(10 * k + 8);
            LightBounds {
                low,
                high: low + place(10 * k + 7) * 0.2,
                normal,
                both_sides: k.is_multiple_of(3),
                power,
            }
        };
        (0..count).map(light).collect()
    }

    /// Light sent by a light's centre.
    fn sends(light: &LightBounds, position: DVec3) -> f64 {
        let toward = position - 0.5 * (light.low + light.high);
        let facing = light.normal.dot(toward.normalize());
        let facing = if light.both_sides { facing.abs() } else { facing.max(0.0) };
        light.power * facing / toward.length_squared()
    }

    #[test]
    fn probabilities_are_those_of_draws() {
        let lights = lights(57);
        let tree = LightTree::new(&lights);
        for eye in 0..40 {
            let position = place(1000 + 5 * eye) * 14.0 - 2.0;
            let all: Vec<f64> = (0..lights.len()).map(|k| tree.probability(position, k)).collect();
            for (light, probability) in lights.iter().zip(&all) {
                assert!(*probability > 0.0 || sends(light, position) == 0.0, "{light:?} is never sampled");
            }
            // The interval of choices that lead to a light is as wide as its probability.
            const STEPS: usize = 20_000;
            let mut counts = vec![0; lights.len()];
            for k in 0..STEPS {
                // A node with a nonzero estimate may have children whose estimates are 0.
                let Some((number, probability)) = tree.draw(position, (k as f64 + 0.5) / STEPS as f64) else {
                    continue;
                };
                assert!((probability - all[number]).abs() < 1e-12);
                counts[number] += 1;
            }
            for (count, probability) in counts.into_iter().zip(all) {
                assert!((f64::from(count) / STEPS as f64 - probability).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn what_is_far_or_turned_away_is_drawn_less() {
        let lights = lights(3000);
        let tree = LightTree::new(&lights);
        let power: f64 = lights.iter().map(|light| light.power).sum();
        // Second moment of sent/probability over the squared mean: 1 for a noise-free estimator.
        let (mut by_tree, mut by_power) = (0.0, 0.0);
        for eye in 0..20 {
            let position = place(90_000 + 5 * eye) * 10.0;
            let sent: Vec<f64> = lights.iter().map(|light| sends(light, position)).collect();
            let mean: f64 = sent.iter().sum();
            for (number, (light, sent)) in lights.iter().zip(&sent).enumerate() {
                if *sent > 0.0 {
                    by_tree += sent * sent / tree.probability(position, number) / (mean * mean);
                    by_power += sent * sent / (light.power / power) / (mean * mean);
                }
            }
        }
        assert!(by_tree * 4.0 < by_power, "{by_tree} for {by_power}");
    }

    #[test]
    fn lights_in_one_place_or_far_apart_have_trails_that_lead_to_them() {
        let at = |x: f64| LightBounds {
            low: DVec3::splat(x),
            high: DVec3::splat(x),
            normal: DVec3::Z,
            both_sides: true,
            power: 1.0,
        };
        // Each twice as far away as the one before: the worst case for buckets.
        let far: Vec<LightBounds> = (0..200).map(|k| at(2f64.powi(k))).collect();
        for lights in [vec![at(1.0); 100], far, vec![at(0.0)]] {
            let tree = LightTree::new(&lights);
            let position = DVec3::new(0.3, -4.0, 9.0);
            let all = (0..lights.len()).map(|k| tree.probability(position, k));
            assert!((all.sum::<f64>() - 1.0).abs() < 1e-9);
        }
        assert!(LightTree::new(&[]).nodes.is_empty());
    }
}
