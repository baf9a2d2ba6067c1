//! Joins the nodes of a level to those of a coarser one: each with its strongest neighbour, and the pairs once more.

use crate::Graph;
use crate::multigrid::level::Level;

/// The aggregate of a node without links: it is solved on its own level.
pub(crate) const NO_AGGREGATE: u32 = u32::MAX;

/// Nodes are only paired along links of at least this share of their strongest one (Notay 2010, section 3.1).
const STRONG_SHARE: f32 = 0.25;

/// The aggregate of each node, and the coarser level.
pub(crate) fn aggregate(level: &Level) -> (Vec<u32>, Level) {
    let (first, pairs) = pair(level);
    let (second, quads) = pair(&pairs);
    let joined = |&pair: &u32| if pair == NO_AGGREGATE { NO_AGGREGATE } else { second[pair as usize] };
    (first.iter().map(joined).collect(), quads)
}

/// Pairs the nodes of a level, in the order of their numbers. A node whose strong neighbours are all taken joins the
/// strongest of them.
fn pair(level: &Level) -> (Vec<u32>, Level) {
    let graph = &level.graph;
    let mut aggregates = vec![NO_AGGREGATE; graph.nodes()];
    let mut count = 0u32;
    for node in 0..graph.nodes() {
        if aggregates[node] != NO_AGGREGATE {
            continue;
        }
        let Some((strongest, greatest)) = strongest(graph.neighbours_of(node)) else { continue };
        let free = graph.neighbours_of(node).filter(|(neighbour, conductance)| {
            aggregates[*neighbour] == NO_AGGREGATE && *conductance >= STRONG_SHARE * greatest
        });
        match self::strongest(free) {
            Some((partner, _)) => {
                (aggregates[node], aggregates[partner]) = (count, count);
                count += 1;
            }
            None if aggregates[strongest] != NO_AGGREGATE => aggregates[node] = aggregates[strongest],
            None => {
                aggregates[node] = count;
                count += 1;
            }
        }
    }
    let coarser = coarsen(level, &aggregates, count as usize);
    (aggregates, coarser)
}

/// The neighbour of the greatest conductance, the first of equal ones.
fn strongest(neighbours: impl Iterator<Item = (usize, f32)>) -> Option<(usize, f32)> {
    neighbours.reduce(|best, other| if other.1 > best.1 { other } else { best })
}

/// The level of `count` aggregates: sums of everything (the Galerkin product of piecewise constant prolongation).
fn coarsen(level: &Level, aggregates: &[u32], count: usize) -> Level {
    let (mut sinks, mut masses) = (vec![0.0; count], vec![0.0; count]);
    let mut starts = vec![0u32; count + 1];
    for (node, &aggregate) in aggregates.iter().enumerate().filter(|(_, own)| **own != NO_AGGREGATE) {
        sinks[aggregate as usize] += level.sinks[node];
        masses[aggregate as usize] += level.masses[node];
        let outside = level.graph.neighbours_of(node).filter(|(other, _)| aggregates[*other] != aggregate);
        starts[aggregate as usize + 1] += outside.count() as u32;
    }
    for aggregate in 0..count {
        starts[aggregate + 1] += starts[aggregate];
    }
    let mut next = starts.clone();
    let mut rows = vec![(0, 0.0); starts[count] as usize];
    for (node, &aggregate) in aggregates.iter().enumerate().filter(|(_, own)| **own != NO_AGGREGATE) {
        for (neighbour, conductance) in level.graph.neighbours_of(node) {
            let other = aggregates[neighbour];
            if other != aggregate {
                let place = &mut next[aggregate as usize];
                rows[*place as usize] = (other, conductance);
                *place += 1;
            }
        }
    }
    Level { graph: Graph::from_rows(&starts, &mut rows), sinks, masses, aggregates: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strong_links_are_joined_and_sums_are_kept() {
        let links =
            [(0, 1, 1.0), (1, 2, 0.01), (2, 3, 1.0), (3, 4, 0.02), (4, 5, 1.0), (5, 6, 0.9), (6, 7, 1.0)];
        let graph = Graph::new(9, &links);
        let level = Level { graph, sinks: vec![1.0; 9], masses: vec![1.0; 9], aggregates: Vec::new() };
        let (aggregates, coarser) = aggregate(&level);
        assert_eq!(aggregates[0], aggregates[1]);
        assert_eq!(aggregates[4], aggregates[7]);
        assert_eq!(aggregates[8], NO_AGGREGATE);
        assert!(coarser.graph.nodes() < 4);
        assert_eq!(coarser.masses.iter().sum::<f64>(), 8.0);
        assert_eq!(coarser.sinks.iter().sum::<f64>(), 8.0);
    }
}
