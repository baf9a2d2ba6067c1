//! Which nodes are reached from one node by steps of limited dissimilarity: contiguous selection.

use crate::Graph;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How unlike a node is the starting node, ≥ 0; NaN counts as infinite.
pub trait Dissimilarity {
    /// The dissimilarity of a node.
    fn of(&self, node: usize) -> f32;
}

impl<F: Fn(usize) -> f32> Dissimilarity for F {
    fn of(&self, node: usize) -> f32 {
        self(node)
    }
}

/// The least tolerance at which each node is selected when `start` is clicked: the minimum over all paths from it of
/// the greatest dissimilarity on the path (a minimax path, by Dijkstra's algorithm). Infinite where no path leads, or
/// if `start` does not exist. A selection of tolerance τ is then the nodes with a value ≤ τ, whatever τ is.
pub fn tolerances_from(graph: &Graph, start: usize, dissimilarity: impl Dissimilarity) -> Vec<f32> {
    let mut tolerances = vec![f32::INFINITY; graph.nodes()];
    if start >= graph.nodes() {
        return tolerances;
    }
    let at = |node: usize| {
        let value = dissimilarity.of(node);
        // Positive floats ascend as their bits do.
        if value >= 0.0 {
            value
        } else if value < 0.0 {
            0.0
        } else {
            f32::INFINITY
        }
    };
    let mut frontier = BinaryHeap::from([(Reverse(0u32), start as u32)]);
    tolerances[start] = 0.0;
    while let Some((Reverse(bits), node)) = frontier.pop() {
        let reached = f32::from_bits(bits);
        if reached > tolerances[node as usize] {
            continue;
        }
        for (neighbour, _) in graph.neighbours_of(node as usize) {
            let tolerance = reached.max(at(neighbour));
            if tolerance < tolerances[neighbour] {
                tolerances[neighbour] = tolerance;
                frontier.push((Reverse(tolerance.to_bits()), neighbour as u32));
            }
        }
    }
    tolerances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_counts_its_worst_step() {
        let graph = Graph::new(6, &[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (0, 4, 1.0), (4, 3, 1.0)]);
        let values = [0.0, 0.5, 0.1, 0.2, f32::NAN, 0.0];
        let tolerances = tolerances_from(&graph, 0, |node| values[node]);
        assert_eq!(tolerances, [0.0, 0.5, 0.5, 0.5, f32::INFINITY, f32::INFINITY]);
        assert!(tolerances_from(&graph, 9, |_| 0.0).iter().all(|tolerance| tolerance.is_infinite()));
    }
}
